// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "adapters/formats/worlds/textured_mesh.h"
#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/scene_renderer.h"
#include "engine/maps/grid.h"
#include "models/types.h"

namespace prospect {

/// What cameras see of a person: legs, trunk, arms and head as boxes in checked cloth, 1.8 m tall,
/// in a frame of its own, x ahead.
TexturedMesh person_mesh(std::uint64_t seed);

/// Somebody who stands or walks in a world.
struct Person {
  Eigen::Isometry3d T_WP;
  std::shared_ptr<const SceneRenderer> body;
};

/// People who walk over the floor of a world that the robot can stand on, at least 0.3 m from all
/// else: each to a place drawn among those that a straight way leads to, at 1.2 m/s, and after a
/// rest of 0.5 to 3 s to the next. Within a metre of the robot nobody goes nearer to it: who would,
/// waits, and goes elsewhere after two seconds. They are seen by cameras; nothing runs into them.
///
/// Deterministic in (world, density, start, seed, sequence of calls). Thread-safety: one thread.
class Walkers {
 public:
  /// density: people on 100 m^2. None begins within 2 m of `start`.
  Walkers(const World& world, double density, const Pose& start, std::uint64_t seed);

  /// Until `stamp` [s], beside a robot at `robot`.
  void advance(double stamp, const Pose& robot);

  const std::vector<Person>& people() const { return people_; }
  /// Whether they may be there.
  bool walkable(const Eigen::Vector2d& place) const;

 private:
  struct Way {
    Eigen::Vector2d at, target;  // [m]
    double heading = 0.0;
    double rest = 0.0;    // [s] yet
    double waited = 0.0;  // [s] for the robot
  };
  void step(Way& way, double dt, const Eigen::Vector2d& robot);
  void choose(Way& way);
  Eigen::Vector2d any_place();
  bool straight(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  Grid<std::uint8_t> floor_;
  std::vector<Cell> places_;
  std::mt19937_64 random_;
  std::vector<Way> ways_;
  std::vector<Person> people_;
  double stamp_ = 0.0;
};

/// Enters what a camera sees of people that nothing of the scene hides, in images that show it
/// without them; only those nearer than 15 m.
void draw_people(std::span<const Person> people, const SceneRenderer& scene,
                 const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, int threads,
                 std::vector<float>& grey);
void draw_people(std::span<const Person> people, const PinholeCamera& camera,
                 const Eigen::Isometry3d& T_WC, int threads, DepthImage& depth,
                 std::vector<float>& incidence);

}  // namespace prospect
