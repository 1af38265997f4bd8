// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/surface_drift.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/maps/planar_error.h"
#include "engine/maps/pose_error.h"
#include "engine/maps/present_view.h"

namespace prospect {
namespace {

constexpr double kNeverSeen = -std::numeric_limits<double>::infinity();
constexpr double kNotTold = -1.0;
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

  take_told();
  ++updates_;
  for (const DepthSensor& sensor : robot.depth_sensors()) {
    visit_ground_in_view(ground, belief.pose, sensor, [this](Cell c) {
      if (!variance_seen_.frame.contains(c)) cover(c);
      variance_seen_[c] = bounded_ ? variance(c) : kInfinity;
      in_view_[c] = updates_;
    });
  }
}

void SurfaceDrift::follow(const PlaceMoves& moves) {
  // As it is in the map and the covariance of the last update.
  Grid<double> now(variance_seen_.frame, kNotTold);
  for (int n = 0; n < now.frame.size(); ++n) {
    const Cell c = now.frame.at(n);
    if (variance_seen_[c] == kNeverSeen) continue;
    const double off = sigma(c);
    now[c] = off * off;
  }
  told_ = moved(now, moves, kNotTold);
  constexpr int kTogether = 8;  // cells along an edge that are told alike
  const GridFrame blocks = frame_of_blocks(told_.frame, kTogether);
  for (int n = 0; told_.frame.size() > 0 && n < blocks.size(); ++n) {
    const Cell block = blocks.at(n);
    const double variance = moves.variance(blocks.center(block));
    if (variance < 0.0) continue;
    for (int j = kTogether * block.j; j < kTogether * (block.j + 1); ++j) {
      for (int i = kTogether * block.i; i < kTogether * (block.i + 1); ++i) {
        if (told_.frame.contains({i, j}) && told_[{i, j}] >= 0.0) told_[{i, j}] = variance;
      }
    }
  }
  variance_seen_ = moved(variance_seen_, moves, kNeverSeen);
  in_view_ = moved(in_view_, moves, std::uint32_t{0});
}

/// What was told of places, in terms of the covariance of now.
void SurfaceDrift::take_told() {
  for (int n = 0; n < told_.frame.size(); ++n) {
    const Cell c = told_.frame.at(n);
    if (told_[c] < 0.0 || !variance_seen_.frame.contains(c)) continue;
    variance_seen_[c] = bounded_ && std::isfinite(told_[c]) ? variance(c) - told_[c] : kInfinity;
  }
  told_ = {};
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
  return place_variance(covariance_, variance_seen_.frame.center(c) - position_);
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
