// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "engine/maps/grid.h"
#include "models/types.h"

namespace prospect {

class Knobs;

/// People who walk about in a simulation.
struct WalkersOptions {
  int count = 0;
  double keep = 1.0;  ///< [m] to the robot's middle: who is as near goes no nearer to it
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, WalkersOptions& options);

/// Somebody who stands or walks: B of a person is on the floor, x ahead.
struct Walker {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< in W [m]
  double heading = 0.0;                          ///< [rad]
};

/// About the middle of a person [m]: what runs into the robot, and it into them. Their legs.
inline constexpr double kWalkerRadius = 0.2;
/// [m] of a person, from the middle to the side.
inline constexpr double kWalkerWidest = 0.35, kWalkerTallest = 1.85;

/// Legs, trunk, arms and head of a person 1.8 m tall, in its own frame [m].
std::span<const Eigen::AlignedBox3f> person_boxes();

/// [m] along a ray from `from` with the unit direction `along` until it meets one of them, in W;
/// infinite: it meets none.
double distance_to_walkers(std::span<const Walker> walkers, const Eigen::Vector3d& from,
                           const Eigen::Vector3d& along);

/// People who walk over the floor of a world that the robot can stand on, at least 0.3 m from all
/// else: each to a place drawn among those that a straight way leads to, at 1.2 m/s, and after a
/// rest of 0.5 to 3 s to the next. Who is within `keep` of the robot and would get nearer to it, or
/// would run into it, waits, and goes elsewhere after two seconds.
///
/// Deterministic in (world, count, keep, start, seed, sequence of calls). Thread-safety: one
/// thread.
class Walkers {
 public:
  /// density: people on 100 m^2 besides. None begins within 2 m of `start`.
  Walkers(const World& world, const WalkersOptions& options, double density, const Pose& start,
          std::uint64_t seed);

  /// Whether somebody at a place in W touches the robot; empty: nobody ever does.
  using Touches = std::function<bool(const Eigen::Vector2d&)>;
  /// Until `stamp` [s], beside a robot at `robot`.
  void advance(double stamp, const Pose& robot, const Touches& touches = {});

  std::span<const Walker> walkers() const { return walkers_; }
  /// How often one has walked into the robot.
  int bumps() const { return bumps_; }
  /// Whether they may be there.
  bool walkable(const Eigen::Vector2d& place) const;

 private:
  struct Way {
    Eigen::Vector2d target;  // [m]
    double rest = 0.0;       // [s] yet
    double waited = 0.0;     // [s] for the robot
    bool bumped = false;     // into it, and not away since
  };
  void step(Walker& walker, Way& way, double dt, const Eigen::Vector2d& robot,
            const Touches& touches);
  void choose(const Walker& walker, Way& way);
  Eigen::Vector2d any_place();
  bool straight(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  double keep_;  // [m]
  Grid<std::uint8_t> floor_;
  std::vector<Cell> places_;
  std::mt19937_64 random_;
  std::vector<Walker> walkers_;
  std::vector<Way> ways_;  // one each
  double stamp_ = 0.0;
  int bumps_ = 0;
};

}  // namespace prospect
