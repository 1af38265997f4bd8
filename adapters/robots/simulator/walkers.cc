// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/walkers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/robots/simulator/hashed_draws.h"

namespace prospect {
namespace {

constexpr double kWalkingSpeed = 1.2;  // [m/s]

Eigen::AlignedBox3f box(float x, float left, float right, float low, float high) {
  return {Eigen::Vector3f(-x, left, low), Eigen::Vector3f(x, right, high)};
}

/// Where a ray enters a box; infinite: it does not.
double entry(const Eigen::AlignedBox3f& box, const Eigen::Vector3d& from,
             const Eigen::Vector3d& along) {
  double in = 0.0, out = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    const double low = box.min()[a], high = box.max()[a];
    if (along[a] == 0.0) {
      if (from[a] < low || from[a] > high) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double s = (low - from[a]) / along[a], t = (high - from[a]) / along[a];
    in = std::max(in, std::min(s, t));
    out = std::min(out, std::max(s, t));
  }
  return in <= out ? in : std::numeric_limits<double>::infinity();
}

}  // namespace

std::span<const Eigen::AlignedBox3f> person_boxes() {
  static const std::array<Eigen::AlignedBox3f, 6> kBoxes = {
      box(0.09f, 0.02f, 0.18f, 0.0f, 0.85f), box(0.09f, -0.18f, -0.02f, 0.0f, 0.85f),  // legs
      box(0.12f, -0.2f, 0.2f, 0.85f, 1.5f),                                            // trunk
      box(0.05f, 0.21f, 0.3f, 0.8f, 1.45f),  box(0.05f, -0.3f, -0.21f, 0.8f, 1.45f),   // arms
      box(0.1f, -0.08f, 0.08f, 1.55f, 1.8f)};                                          // head
  return kBoxes;
}

double distance_to_walkers(std::span<const Walker> walkers, const Eigen::Vector3d& from,
                           const Eigen::Vector3d& along) {
  double nearest = std::numeric_limits<double>::infinity();
  const Eigen::Vector2d level = along.head<2>();
  for (const Walker& walker : walkers) {
    // Most rays pass most people by.
    const Eigen::Vector2d to = walker.at - from.head<2>();
    const double aside = level.x() * to.y() - level.y() * to.x();
    if (aside * aside > kWalkerWidest * kWalkerWidest * level.squaredNorm()) continue;
    if (level.dot(to) < 0.0 && to.norm() > kWalkerWidest) continue;
    const Eigen::Rotation2Dd R(-walker.heading);
    Eigen::Vector3d from_P = from, along_P = along;
    from_P.head<2>() = -(R * to);
    along_P.head<2>() = R * level;
    for (const Eigen::AlignedBox3f& part : person_boxes()) {
      nearest = std::min(nearest, entry(part, from_P, along_P));
    }
  }
  return nearest;
}

Walkers::Walkers(const World& world, const WalkersOptions& options, double density,
                 const Pose& start, std::uint64_t seed)
    : keep_(options.keep), random_(seed) {
  BodySlice body;
  body.z_min = 0.05;
  body.z_max = kWalkerTallest;
  body.standing_clearance = 0.3;
  // Where the ceiling is low, what reaches the robot's height has to do.
  const double top = (world.voxels.k0() + world.voxels.depth()) * world.voxels.resolution();
  body.z_max = std::min(body.z_max, 0.8 * top);
  floor_ = standing_columns(world.voxels, body);
  for (int n = 0; n < floor_.frame.size(); ++n) {
    if (floor_.data[static_cast<std::size_t>(n)] != 0) places_.push_back(floor_.frame.at(n));
  }
  const double r = floor_.frame.resolution;
  const auto count =
      options.count +
      static_cast<int>(std::lround(density * static_cast<double>(places_.size()) * r * r / 100.0));
  for (int n = 0; n < count && !places_.empty(); ++n) {
    Walker walker;
    for (int tries = 0; tries < 100; ++tries) {
      walker.at = any_place();
      if ((walker.at - start.position.head<2>()).norm() >= 2.0) break;
    }
    Way way;
    choose(walker, way);
    ways_.push_back(way);
    walkers_.push_back(walker);
  }
}

bool Walkers::walkable(const Eigen::Vector2d& place) const {
  return floor_.get(floor_.frame.cell(place.x(), place.y()), 0) != 0;
}

Eigen::Vector2d Walkers::any_place() {
  return floor_.frame.center(places_[static_cast<std::size_t>(random_() % places_.size())]);
}

bool Walkers::straight(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const double step = 0.25 * floor_.frame.resolution;
  const int count = static_cast<int>(std::ceil((to - from).norm() / step));
  for (int n = 1; n <= count; ++n) {
    if (!walkable(from + (to - from) * n / count)) return false;
  }
  return true;
}

void Walkers::choose(const Walker& walker, Way& way) {
  way.target = walker.at;
  way.waited = 0.0;
  way.rest = 0.5 + 2.5 * unit_interval(random_());
  for (int tries = 0; tries < 100; ++tries) {
    const Eigen::Vector2d place = any_place();
    const double length = (place - walker.at).norm();
    if (length < 1.0 || length > 8.0 || !straight(walker.at, place)) continue;
    way.target = place;
    break;
  }
}

void Walkers::step(Walker& walker, Way& way, double dt, const Eigen::Vector2d& robot,
                   const Touches& touches) {
  constexpr double kPatience = 2.0;  // [s]
  if (way.rest > 0.0) {
    way.rest -= dt;
    return;
  }
  const Eigen::Vector2d ahead = way.target - walker.at;
  const double left = ahead.norm();
  if (left < 1e-9) return choose(walker, way);
  const Eigen::Vector2d next = walker.at + ahead / left * std::min(left, kWalkingSpeed * dt);
  const double distance = (next - robot).norm();
  const bool nearer = distance < (walker.at - robot).norm();
  const bool keeps = nearer && distance < keep_;
  const bool bumps = nearer && !keeps && touches && touches(next);
  bumps_ += bumps && !way.bumped;
  way.bumped = bumps || (way.bumped && distance < 2.0 * keep_);
  if (bumps || keeps) {
    way.waited += dt;
    if (way.waited > kPatience) choose(walker, way);
    return;
  }
  walker.heading = std::atan2(ahead.y(), ahead.x());
  walker.at = next;
}

void Walkers::advance(double stamp, const Pose& robot, const Touches& touches) {
  constexpr double kStep = 0.05;  // [s]
  while (stamp_ < stamp) {
    const double dt = std::min(kStep, stamp - stamp_);
    for (std::size_t n = 0; n < walkers_.size(); ++n) {
      step(walkers_[n], ways_[n], dt, robot.position.head<2>(), touches);
    }
    stamp_ = stamp - stamp_ > kStep ? stamp_ + kStep : stamp;
  }
}

}  // namespace prospect
