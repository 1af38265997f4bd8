#include "engine/maps/surface_drift.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/maps/pose_error.h"
#include "engine/maps/present_view.h"

namespace prospect {
namespace {

constexpr double kNeverSeen = -1.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();  // seen, V_c not known

}  // namespace

void SurfaceDrift::update(const Belief& belief, const RobotDescription& robot) {
  ground_ = belief.ground;
  const GroundMap& ground = *ground_;
  const GridFrame& frame = ground.frame();
  position_ = belief.pose.position.head<2>();
  const Eigen::Vector3i planar(0, 1, 3);
  bounded_ = is_pose_covariance(belief.covariance);
  covariance_.setZero();
  if (bounded_) covariance_ = belief.covariance(planar, planar);
  const std::optional<GridFrame> both =
      updates_ == 0 ? std::nullopt : frame_of_both(frame, map_frame_);
  map_frame_ = both.value_or(frame);
  if (!both) {
    variance_seen_ = Grid<double>(GridFrame{frame.resolution, 0, 0, 0, 0}, kNeverSeen);
    in_view_ = Grid<std::uint32_t>(variance_seen_.frame, 0);
  }

  ++updates_;
  for (const DepthSensor& sensor : robot.depth_sensors()) {
    visit_ground_in_view(ground, belief.pose, sensor, [this](Cell c) {
      if (!variance_seen_.frame.contains(c)) cover(c);
      variance_seen_[c] = bounded_ ? variance(c) : kInfinity;
      in_view_[c] = updates_;
    });
  }
}

// By what was seen, not by the map: that may be far larger.
void SurfaceDrift::cover(Cell c) {
  constexpr int kMargin = 64;
  const GridFrame& old = variance_seen_.frame;
  const GridFrame room = intersection(
      map_frame_, {old.resolution, c.i - kMargin, c.j - kMargin, 2 * kMargin + 1, 2 * kMargin + 1});
  const GridFrame wider = old.width > 0 ? frame_around_both(old, room) : room;
  variance_seen_.widen(wider, kNeverSeen);
  in_view_.widen(wider, 0);
}

double SurfaceDrift::variance(Cell c) const {
  const Eigen::Vector2d lever = variance_seen_.frame.center(c) - position_;
  const Eigen::Vector2d turned(-lever.y(), lever.x());
  return std::max(0.0, 0.5 * covariance_.topLeftCorner<2, 2>().trace() +
                           turned.dot(covariance_.topRightCorner<2, 1>()) +
                           0.5 * lever.squaredNorm() * covariance_(2, 2));
}

double SurfaceDrift::sigma(Cell c) const {
  if (updates_ == 0 || in_view_.get(c, 0) == updates_) return 0.0;
  if (!bounded_) return kInfinity;
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
