// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/world.h"

#include <cmath>
#include <limits>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/formats/worlds/sloped_floor.h"
#include "models/mixed_bits.h"

namespace prospect {
namespace {

double patchy_density(const Eigen::Vector3d& p, std::uint64_t seed) {
  constexpr double kLattice = 3.0;  // [m]
  const Eigen::Vector3i cell = (p / kLattice).array().floor().cast<int>();
  double nearest = std::numeric_limits<double>::infinity();
  std::uint64_t patch = 0;
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dz = -1; dz <= 1; ++dz) {
        const Eigen::Vector3i c = cell + Eigen::Vector3i(dx, dy, dz);
        std::uint64_t h = mixed_bits(seed);
        for (int a = 0; a < 3; ++a) {
          h = mixed_bits(h ^ static_cast<std::uint64_t>(static_cast<std::uint32_t>(c[a])));
        }
        const std::uint64_t x = mixed_bits(h + 1), y = mixed_bits(h + 2), z = mixed_bits(h + 3);
        const Eigen::Vector3d point =
            kLattice * (c.cast<double>() +
                        Eigen::Vector3d(unit_interval(x), unit_interval(y), unit_interval(z)));
        const double distance = (point - p).squaredNorm();
        if (distance < nearest) {
          nearest = distance;
          patch = h;
        }
      }
    }
  }
  const double u = unit_interval(mixed_bits(patch + 4));
  return u < 0.5 ? 40.0 : u < 0.8 ? 2.0 : 0.0;
}

}  // namespace

double texture_density(const World& world, int i, int j, int k, std::uint64_t seed) {
  if (!world.texture_class.empty()) {
    if (!world.voxels.contains(i, j, k)) return 0.0;
    const std::size_t index = world.texture_class[world.voxels.index(i, j, k)];
    return index < world.texture_density.size() ? world.texture_density[index] : 0.0;
  }
  const double r = world.voxels.resolution();
  return patchy_density(Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5) * r, seed);
}

WorldFacts describe(const World& world, const BodySlice& slice) {
  if (!world.slopes.empty()) return describe(flattened(world, slice.step), slice);
  WorldFacts facts;
  const GridFrame& frame = world.voxels.frame();
  facts.resolution = frame.resolution;
  facts.width = frame.width * frame.resolution;
  facts.length = frame.height * frame.resolution;
  const double cell_area = frame.resolution * frame.resolution;
  for (const std::uint8_t free : free_columns(world.voxels, slice).data) {
    facts.free_area += free * cell_area;
  }
  const Grid<std::uint8_t> standing =
      connected_component(standing_columns(world.voxels, slice),
                          frame.cell(world.start.position.x(), world.start.position.y()));
  for (const std::uint8_t stand : standing.data) facts.standing_area += stand * cell_area;
  return facts;
}

}  // namespace prospect
