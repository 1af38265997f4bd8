// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "adapters/formats/worlds/textured_mesh.h"
#include "adapters/robots/simulator/scene_renderer.h"
#include "adapters/robots/simulator/walkers.h"

namespace prospect {

/// What cameras see of a person: person_boxes() in checked cloth.
TexturedMesh person_mesh(std::uint64_t seed);

/// Somebody in a world.
struct Person {
  Eigen::Isometry3d T_WP;
  std::shared_ptr<const SceneRenderer> body;
};

/// What cameras see of walkers. Thread-safety: one thread.
class People {
 public:
  explicit People(std::uint64_t seed) : seed_(seed) {}
  /// As they are now. Throws NotBuiltIn without a renderer.
  std::span<const Person> of(std::span<const Walker> walkers);

 private:
  std::uint64_t seed_;
  std::vector<std::shared_ptr<const SceneRenderer>> bodies_;
  std::vector<Person> people_;
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
