// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_robot_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <variant>

#include "adapters/formats/files/input_error.h"
#include "adapters/robots/gazebo/number_stream.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "models/formatted.h"

namespace prospect {
namespace {

[[noreturn]] void refuse_robot(const std::string& what) {
  throw std::invalid_argument("gazebo robot: " + what);
}

/// x y z roll pitch yaw of a camera, whose frame in SDF is x ahead, y left, z up.
std::string sensor_pose(const Eigen::Isometry3d& T_BC) {
  Eigen::Matrix3d R_CS;
  R_CS << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Eigen::Matrix3d R = T_BC.linear() * R_CS;
  const Eigen::Vector3d p = T_BC.translation();
  std::ostringstream out = number_stream();
  const std::array<double, 6> numbers_of_pose = {p.x(),
                                                 p.y(),
                                                 p.z(),
                                                 std::atan2(R(2, 1), R(2, 2)),
                                                 -std::asin(std::clamp(R(2, 0), -1.0, 1.0)),
                                                 std::atan2(R(1, 0), R(0, 0))};
  // Without the sign of a zero.
  for (std::size_t n = 0; n < 6; ++n) out << (n == 0 ? "" : " ") << numbers_of_pose[n] + 0.0;
  return out.str();
}

std::string body_geometry(const RobotShape& shape) {
  std::ostringstream out = number_stream();
  const auto cylinder = [&](const Eigen::Vector3d& center, double radius, double height) {
    out << "<pose>" << center.x() << ' ' << center.y() << ' ' << center.z()
        << " 0 0 0</pose><geometry><cylinder><radius>" << radius << "</radius><length>" << height
        << "</length></cylinder></geometry>";
  };
  if (const auto* const c = std::get_if<CylinderShape>(&shape)) {
    cylinder(c->center, c->radius, c->height);
  } else if (const auto* const b = std::get_if<BoxShape>(&shape)) {
    out << "<pose>" << b->center.x() << ' ' << b->center.y() << ' ' << b->center.z()
        << " 0 0 0</pose><geometry><box><size>" << b->size.x() << ' ' << b->size.y() << ' '
        << b->size.z() << "</size></box></geometry>";
  } else {
    refuse_robot("a body that is neither a cylinder nor a box; expected one of them");
  }
  return out.str();
}

std::string inertial(double height, double mass, double x, double y, double z) {
  std::ostringstream out = number_stream();
  out << "<inertial><pose>0 0 " << height << " 0 0 0</pose><mass>" << mass
      << "</mass><inertia><ixx>" << x << "</ixx><iyy>" << y << "</iyy><izz>" << z
      << "</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>";
  return out.str();
}

}  // namespace

std::string gazebo_robot_model(const RobotDescription& robot, const GazeboRobotOptions& options,
                               const Pose& start) {
  const GazeboOptions& names = options.names;
  check(names);
  const auto positive = [](const char* what, double value) {
    if (!(std::isfinite(value) && value > 0.0)) {
      refuse_robot(std::string(what) + " is " + std::to_string(value) + "; expected a number > 0");
    }
  };
  positive("image_rate", options.image_rate);
  positive("depth_rate", options.depth_rate);
  positive("depth_width", names.depth_width);
  if (!start.position.allFinite() || !std::isfinite(start.yaw)) {
    refuse_robot("a start that is not finite");
  }
  validate(robot.stereo);
  const PinholeCamera& left = robot.stereo.left;
  if (std::abs(left.fx - left.fy) > 1e-3 * left.fx) {
    refuse_robot("robot.stereo.fx is " + std::to_string(left.fx) + ", fy " +
                 std::to_string(left.fy) + "; expected the same, as pixels of Gazebo are square");
  }
  const double r = names.wheel_radius, half = 0.5 * names.wheel_separation;
  std::ostringstream out = number_stream();
  out << "<model name=\"" << names.model << "\">\n<pose>" << start.position.x() << ' '
      << start.position.y() << ' ' << start.position.z() + 0.0 << " 0 0 " << start.yaw
      << "</pose>\n"
         // Of bodies that it puts to sleep Gazebo tells nothing, wheels at rest among them.
         "<allow_auto_disable>0</allow_auto_disable>\n<link name=\""
      << names.link << "\">\n"
      << inertial(1.25 * r, 8.0, 0.08, 0.08, 0.12) << "\n<collision name=\"body\">"
      << body_geometry(robot.shape) << "</collision>\n";
  const double caster = 0.5 * r;
  for (const int sign : {1, -1}) {
    out << "<collision name=\"caster_" << (sign > 0 ? "front" : "back") << "\"><pose>"
        << sign * 0.8 * half << " 0 " << caster << " 0 0 0</pose><geometry><sphere><radius>"
        << caster
        << "</radius></sphere></geometry><surface><friction><ode><mu>0</mu><mu2>0</mu2></ode>"
           "</friction></surface></collision>\n";
  }
  const auto camera = [&](double fov, double width, double height, double near, double far) {
    std::ostringstream text = number_stream();
    text << "<horizontal_fov>" << fov << "</horizontal_fov><image><width>" << width
         << "</width><height>" << height << "</height><format>R8G8B8</format></image><clip><near>"
         << near << "</near><far>" << far << "</far></clip>";
    return text.str();
  };
  const std::string image =
      camera(2.0 * std::atan(0.5 * left.width / left.fx), left.width, left.height, 0.05, 60.0);
  out << "<sensor name=\"" << names.stereo << "\" type=\"multicamera\"><always_on>1</always_on>"
      << "<update_rate>" << options.image_rate << "</update_rate><pose>"
      << sensor_pose(robot.stereo_mount.T_BC) << "</pose>\n<camera name=\"left\"><pose>0 0 0 0 0 0"
      << "</pose>" << image << "</camera>\n<camera name=\"right\"><pose>0 "
      << -robot.stereo.baseline << " 0 0 0 0</pose>" << image << "</camera></sensor>\n";
  const std::vector<std::string> depths = gazebo_depth_names(with_sensors_of(names, robot));
  const std::map<int, PinholeCamera> seen = gazebo_depth_cameras(robot, names);
  for (std::size_t n = 0; n < depths.size(); ++n) {
    const DepthSensor sensor = robot.depth_sensors()[n];
    const PinholeCamera& image_of = seen.at(static_cast<int>(n));
    out << "<sensor name=\"" << depths[n] << "\" type=\"depth\"><always_on>1</always_on>"
        << "<update_rate>" << options.depth_rate << "</update_rate><pose>"
        << sensor_pose(sensor.mount.T_BC) << "</pose><camera name=\"depth\">"
        << camera(sensor.footprint.horizontal_fov, image_of.width, image_of.height, 0.05,
                  names.depth_range.max + 1.0)
        << "</camera></sensor>\n";
  }
  if (!names.imu.empty()) {
    out << "<sensor name=\"" << names.imu << "\" type=\"imu\"><always_on>1</always_on>"
        << "<update_rate>100</update_rate></sensor>\n";
  }
  out << "</link>\n";
  for (const int sign : {1, -1}) {
    const std::string& wheel = sign > 0 ? names.left_wheel : names.right_wheel;
    out << "<link name=\"" << wheel << "\"><pose>0 " << sign * half << ' ' << r
        << " -1.570796327 0 0</pose>" << inertial(0.0, 0.4, 0.0008, 0.0008, 0.0013)
        << "<collision name=\"tyre\"><geometry><cylinder><radius>" << r
        << "</radius><length>0.03</length></cylinder></geometry><surface><friction><ode><mu>1</mu>"
           "<mu2>1</mu2></ode></friction></surface></collision></link>\n<joint name=\""
        << wheel << "_joint\" type=\"revolute\"><parent>" << names.link << "</parent><child>"
        << wheel << "</child><axis><xyz>0 0 1</xyz></axis></joint>\n";
  }
  out << "<plugin name=\"drive\" filename=\"libDiffDrivePlugin.so\"><left_joint>"
      << names.left_wheel << "_joint</left_joint><right_joint>" << names.right_wheel
      << "_joint</right_joint><torque>5</torque></plugin>\n</model>\n";
  return out.str();
}

GazeboOptions with_sensors_of(GazeboOptions options, const RobotDescription& robot) {
  options.depth_sensors = static_cast<int>(robot.depth_sensors().size());
  return options;
}

std::map<int, PinholeCamera> gazebo_depth_cameras(const RobotDescription& robot,
                                                  const GazeboOptions& options) {
  std::map<int, PinholeCamera> cameras;
  if (options.depth.empty()) return cameras;
  for (const DepthSensor& sensor : robot.depth_sensors()) {
    const auto number = static_cast<int>(cameras.size());
    const RgbdFootprint& seen = sensor.footprint;
    if (!is_rendered(seen)) {
      const std::string name =
          number == 0 ? "robot.depth" : formatted("robot.more_depth[%d]", number - 1);
      fail(name, formatted("%g x %g degrees; expected a camera of 1 to 170 degrees, as Gazebo "
                           "renders images",
                           seen.horizontal_fov * 180.0 / M_PI, seen.vertical_fov * 180.0 / M_PI));
    }
    const double high = std::tan(0.5 * seen.vertical_fov) / std::tan(0.5 * seen.horizontal_fov);
    const int width = options.depth_width;
    PinholeCamera camera =
        depth_camera(seen, width, std::max(1, static_cast<int>(std::lround(width * high))));
    camera.fy = camera.fx;
    cameras[number] = camera;
  }
  return cameras;
}

RobotDescription gazebo_robot(RobotDescription robot) {
  PinholeCamera& left = robot.stereo.left;
  left.cx = 0.5 * (left.width - 1.0);
  left.cy = 0.5 * (left.height - 1.0);
  return robot;
}

}  // namespace prospect
