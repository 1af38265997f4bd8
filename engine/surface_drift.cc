#include "engine/surface_drift.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/free_line.h"
#include "models/body_transform.h"

namespace prospect {
namespace {

constexpr double kNeverSeen = -1.0;

bool covers(const GridFrame& wide, const GridFrame& frame) {
  return wide.resolution == frame.resolution && wide.i0 <= frame.i0 && wide.j0 <= frame.j0 &&
         wide.i0 + wide.width >= frame.i0 + frame.width &&
         wide.j0 + wide.height >= frame.j0 + frame.height;
}

}  // namespace

void SurfaceDrift::update(const Belief& belief, const RobotDescription& robot) {
  ground_ = belief.ground;
  const GroundMap& ground = *ground_;
  const GridFrame& frame = ground.frame();
  position_ = belief.pose.position.head<2>();
  const Eigen::Vector3i planar(0, 1, 3);
  covariance_ = belief.covariance(planar, planar);
  if (!covariance_.allFinite()) covariance_.setZero();
  if (!(variance_seen_.frame == frame)) {
    if (variance_seen_.data.empty() || !covers(frame, variance_seen_.frame)) {
      variance_seen_ = Grid<double>(frame, kNeverSeen);
    } else {
      variance_seen_.widen(frame, kNeverSeen);
    }
  }

  const Eigen::Isometry3d T_WC = body_transform(belief.pose) * robot.depth_mount.T_BC;
  const Eigen::Vector3d axis = T_WC.linear().col(2);
  const Eigen::Vector2d eye = T_WC.translation().head<2>();
  const double yaw = std::atan2(axis.y(), axis.x());
  const double pitch = std::asin(std::clamp(-axis.z(), -1.0, 1.0));  // downward
  // Nearer than this the sensor looks over what is low.
  const double lowest = 0.5 * robot.depth.vertical_fov + pitch;
  const double near_low = lowest > 0.0 && lowest < 0.5 * M_PI
                              ? T_WC.translation().z() / std::tan(lowest)
                              : std::numeric_limits<double>::infinity();
  const double range = robot.depth.max_range;
  const int rays = std::max(2, static_cast<int>(std::ceil(robot.depth.horizontal_fov * range /
                                                          (0.5 * frame.resolution))));
  for (int n = 0; n <= rays; ++n) {
    const double azimuth = yaw + robot.depth.horizontal_fov * (static_cast<double>(n) / rays - 0.5);
    const Eigen::Vector2d end = eye + range * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
    visit_line(frame, eye, end, [&](Cell c) {
      const CellState state = ground.state(c);
      if (state == CellState::kUnknown) return false;
      if (state == CellState::kFree) {
        variance_seen_[c] = variance(c);
        return true;
      }
      const bool low = ground.see_through(c);
      const double distance = (frame.center(c) - eye).norm();
      if (distance >= (low ? std::max(near_low, robot.depth.min_range) : robot.depth.min_range)) {
        variance_seen_[c] = variance(c);
      }
      return low;
    });
  }
}

double SurfaceDrift::variance(Cell c) const {
  const Eigen::Vector2d lever = variance_seen_.frame.center(c) - position_;
  const Eigen::Vector2d turned(-lever.y(), lever.x());
  return std::max(0.0, 0.5 * covariance_.topLeftCorner<2, 2>().trace() +
                           turned.dot(covariance_.topRightCorner<2, 1>()) +
                           0.5 * lever.squaredNorm() * covariance_(2, 2));
}

double SurfaceDrift::sigma(Cell c) const {
  const double seen = variance_seen_.get(c, kNeverSeen);
  return seen == kNeverSeen ? 0.0 : std::sqrt(std::abs(variance(c) - seen));
}

double SurfaceDrift::sigma_near(const Eigen::Vector2d& position, double radius) const {
  if (!ground_) return 0.0;
  const GridFrame& frame = variance_seen_.frame;
  const Cell low = frame.cell(position.x() - radius, position.y() - radius);
  const Cell high = frame.cell(position.x() + radius, position.y() + radius);
  double most = 0.0;
  for (int j = low.j; j <= high.j; ++j) {
    for (int i = low.i; i <= high.i; ++i) {
      const Cell c{i, j};
      if (ground_->state(c) != CellState::kOccupied) continue;
      if ((frame.center(c) - position).norm() > radius) continue;
      most = std::max(most, sigma(c));
    }
  }
  return most;
}

}  // namespace prospect
