#include "adapters/robots/dds/camera_settings.h"

#include <initializer_list>
#include <utility>

#include "models/camera.h"
#include "models/knobs.h"
#include "models/range_text.h"

namespace prospect {
namespace {

/// "robot.stereo.mount.yaw=90" and the rest of where a camera is.
void tell_mount(const std::string& path, const CameraMount& mount,
                std::vector<std::string>& settings) {
  const Eigen::Vector3d p = mount.T_BC.translation();
  settings.push_back(path + ".position=[" + exact_text(p.x()) + ", " + exact_text(p.y()) + ", " +
                     exact_text(p.z()) + "]");
  const MountAngles turned = angles(mount);
  settings.push_back(path + ".yaw=" + exact_text(turned.yaw / kRadiansPerDegree));
  settings.push_back(path + ".pitch=" + exact_text(turned.pitch / kRadiansPerDegree));
  settings.push_back(path + ".roll=" + exact_text(turned.roll / kRadiansPerDegree));
}

}  // namespace

std::vector<std::string> camera_settings(const DdsCameras& cameras) {
  std::vector<std::string> settings;
  const PinholeCamera& left = cameras.stereo.left;
  for (const auto& [name, value] : std::initializer_list<std::pair<const char*, double>>{
           {"fx", left.fx},
           {"fy", left.fy},
           {"cx", left.cx},
           {"cy", left.cy},
           {"width", left.width},
           {"height", left.height},
           {"baseline", cameras.stereo.baseline}}) {
    settings.push_back(std::string("robot.stereo.") + name + '=' + exact_text(value));
  }
  if (cameras.stereo_mount) tell_mount("robot.stereo.mount", *cameras.stereo_mount, settings);
  if (cameras.depth) {
    settings.push_back("robot.depth.horizontal_fov=" +
                       exact_text(cameras.depth->horizontal_fov() / kRadiansPerDegree));
    settings.push_back("robot.depth.vertical_fov=" +
                       exact_text(cameras.depth->vertical_fov() / kRadiansPerDegree));
  }
  if (cameras.depth_mount) tell_mount("robot.depth.mount", *cameras.depth_mount, settings);
  return settings;
}

}  // namespace prospect
