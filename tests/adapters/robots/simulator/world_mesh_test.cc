// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/world_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <stdexcept>

#include "adapters/formats/worlds/load_world.h"
#include "tests/adapters/box_room.h"

namespace prospect::world_mesh_test {
namespace {

FeatureField field_of(const World& world, std::uint64_t seed = 1) {
  return FeatureField(
      world, [&](int i, int j, int k) { return texture_density(world, i, j, k, seed); }, seed);
}

double area(const TexturedMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += 0.5 * (mesh.vertices[b] - mesh.vertices[a])
                     .cast<double>()
                     .cross((mesh.vertices[c] - mesh.vertices[a]).cast<double>())
                     .norm();
  }
  return sum;
}

/// Faces between free voxels and all others, times their area.
double exposed_area(const World& world) {
  const VoxelGrid& voxels = world.voxels;
  const GridFrame& f = voxels.frame();
  int faces = 0;
  for (int j = f.j0; j < f.j0 + f.height; ++j) {
    for (int i = f.i0; i < f.i0 + f.width; ++i) {
      for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) {
        if (world.solid(i, j, k)) continue;
        faces += world.solid(i + 1, j, k) + world.solid(i - 1, j, k) + world.solid(i, j + 1, k) +
                 world.solid(i, j - 1, k) + world.solid(i, j, k + 1) + world.solid(i, j, k - 1);
      }
    }
  }
  return faces * voxels.resolution() * voxels.resolution();
}

bool same(const TexturedMesh& a, const TexturedMesh& b) {
  if (a.vertices != b.vertices || a.uv != b.uv || a.triangles != b.triangles ||
      a.material != b.material || a.textures.size() != b.textures.size()) {
    return false;
  }
  for (std::size_t n = 0; n < a.textures.size(); ++n) {
    if (a.textures[n].pixels != b.textures[n].pixels) return false;
  }
  return true;
}

TEST(WorldMesh, AnEmptyRoomIsSixRectangles) {
  const World world = test::box_room(3.0, 2.0);
  const TexturedMesh mesh = world_mesh(world, field_of(world));
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(mesh.textures.size(), 6u);
  EXPECT_NEAR(area(mesh), 2 * (3.0 * 2.0 + 3.0 * 2.0 + 2.0 * 2.0), 0.01);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.vertices) box.extend(p);
  EXPECT_LT((box.min() - Eigen::Vector3f(0, 0, 0)).norm(), 1e-4);
  EXPECT_LT((box.max() - Eigen::Vector3f(3, 2, 2)).norm(), 1e-4);
}

TEST(WorldMesh, CoversEveryExposedFaceOnce) {
  const World office = load_world("office_bare");
  EXPECT_NEAR(area(world_mesh(office, field_of(office))), exposed_area(office),
              1e-3 * exposed_area(office));
  // At random, where hardly a face has a neighbour.
  World crumbs = test::box_room(1.5, 1.5, 1.0);
  std::mt19937 generator(3);
  for (int j = 0; j < 15; ++j) {
    for (int i = 0; i < 15; ++i) {
      for (int k = 0; k < 10; ++k) {
        const auto r = generator() % 10;
        crumbs.voxels.set(i, j, k,
                          r < 2   ? CellState::kOccupied
                          : r < 3 ? CellState::kUnknown
                                  : CellState::kFree);
      }
    }
  }
  EXPECT_NEAR(area(world_mesh(crumbs, field_of(crumbs))), exposed_area(crumbs),
              1e-2 * exposed_area(crumbs));
}

TEST(WorldMesh, EachFeatureIsAMarkAtItsPlace) {
  const World world = test::box_room(3.0, 3.0, 2.0, 0.1, 2.0);
  const FeatureField field = field_of(world);
  const TexturedMesh rich = world_mesh(world, field), blank = world_mesh(world, field, {0.0});
  ASSERT_GT(field.features().size(), 30u);
  const auto grey_at = [](const TexturedMesh& mesh, const Eigen::Vector3f& p) {
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
      const auto& [a, b, c] = mesh.triangles[n];
      const Eigen::Vector3f e1 = mesh.vertices[b] - mesh.vertices[a];
      const Eigen::Vector3f e2 = mesh.vertices[c] - mesh.vertices[a];
      const Eigen::Vector3f d = p - mesh.vertices[a];
      if (std::abs(e1.cross(e2).normalized().dot(d)) > 1e-4) continue;
      Eigen::Matrix<float, 3, 2> E;
      E << e1, e2;
      const Eigen::Vector2f w = (E.transpose() * E).inverse() * E.transpose() * d;
      if (w.minCoeff() < 0.0f || w.sum() > 1.0f) continue;
      const Eigen::Vector2f uv =
          mesh.uv[a] + w[0] * (mesh.uv[b] - mesh.uv[a]) + w[1] * (mesh.uv[c] - mesh.uv[a]);
      const Image& texture = mesh.textures[mesh.material[n]];
      return static_cast<int>(texture.at(static_cast<int>(uv.x() * texture.width),
                                         static_cast<int>(uv.y() * texture.height)));
    }
    return -1000;
  };
  int marked = 0;
  for (const Feature& feature : field.features()) {
    // Somewhere about its middle: the inner part may happen to be as grey as the wall.
    int contrast = 0;
    for (int n = 0; n < 343; ++n) {
      Eigen::Vector3d offset = 0.009 * Eigen::Vector3d(n % 7 - 3, n / 7 % 7 - 3, n / 49 - 3);
      offset -= offset.dot(feature.normal) * feature.normal;
      const auto p = (feature.position + offset).cast<float>();
      const int with = grey_at(rich, p), without = grey_at(blank, p);
      if (with >= 0 && without >= 0) contrast = std::max(contrast, std::abs(with - without));
    }
    marked += contrast > 40;
  }
  std::printf("%d of %zu features are marks\n", marked, field.features().size());
  EXPECT_GE(marked, 0.97 * static_cast<double>(field.features().size()));
  // And nothing is painted where there are none.
  int plain = 0;
  for (int n = 0; n < 900; ++n) {
    const Eigen::Vector3d p(0.05 + 0.1 * (n % 30), 0.05 + 0.1 * (n / 30), 0.0);
    const bool far = std::all_of(field.features().begin(), field.features().end(),
                                 [&](const Feature& f) { return (f.position - p).norm() > 0.1; });
    if (!far) continue;
    ++plain;
    // The ground is interpolated between coarser texels where there are no marks at all.
    EXPECT_NEAR(grey_at(rich, p.cast<float>()), grey_at(blank, p.cast<float>()), 1);
  }
  EXPECT_GT(plain, 300);
}

TEST(WorldMesh, QualityScalesContrast) {
  const World world = test::box_room(3.0, 3.0);
  const FeatureField field = field_of(world);
  const auto deviation = [&](double quality) {
    double sum = 0.0, squares = 0.0, count = 0.0;
    const TexturedMesh mesh = world_mesh(world, field, {quality});
    // The first wall: all of one plain grey but for marks.
    for (const std::uint8_t g : mesh.textures[0].pixels) {
      sum += g;
      squares += 1.0 * g * g;
      ++count;
    }
    return std::sqrt(squares / count - sum * sum / (count * count));
  };
  const double rich = deviation(1.0), half = deviation(0.5), blank = deviation(0.0);
  std::printf("standard deviation of a wall: rich %.1f, half %.1f, blank %.1f grey levels\n", rich,
              half, blank);
  EXPECT_GT(rich, 10.0);
  EXPECT_NEAR(half, 0.5 * rich, 0.15 * rich);
  EXPECT_LT(blank, 4.0);
}

TEST(WorldMesh, SameSeedSameBits) {
  const World world = test::box_room(3.0, 3.0);
  const FeatureField field = field_of(world);
  const TexturedMesh mesh = world_mesh(world, field);
  EXPECT_TRUE(same(mesh, world_mesh(world, field)));
  WorldMeshOptions other;
  other.seed = 2;
  EXPECT_FALSE(same(mesh, world_mesh(world, field, other)));
}

TEST(WorldMesh, RefusesWhatMakesNoSense) {
  const World world = test::box_room(1.0, 1.0);
  const FeatureField field = field_of(world);
  EXPECT_THROW(world_mesh(world, field, {1.5}), std::invalid_argument);
  EXPECT_THROW(world_mesh(world, field, {std::numeric_limits<double>::quiet_NaN()}),
               std::invalid_argument);
  EXPECT_THROW(world_mesh(world, field, {1.0, 0.0}), std::invalid_argument);
  World solid = world;
  test::fill(solid, {-1, -1, -1}, {2, 2, 3});
  EXPECT_THROW(world_mesh(solid, field_of(solid)), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::world_mesh_test
