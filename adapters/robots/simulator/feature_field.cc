// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/feature_field.h"

#include <cmath>
#include <random>

#include "adapters/robots/simulator/noise_stream.h"

namespace prospect {

FeatureField::FeatureField(const World& world, const std::function<double(int, int, int)>& density,
                           std::uint64_t seed) {
  const VoxelGrid& voxels = world.voxels;
  const GridFrame& f = voxels.frame();
  const double r = voxels.resolution();
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Feature> found;
  constexpr int kNormal[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                 {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  for (int j = f.j0; j < f.j0 + f.height; ++j) {
    for (int i = f.i0; i < f.i0 + f.width; ++i) {
      for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) {
        if (voxels.state(i, j, k) != CellState::kOccupied) continue;
        double rate = -1.0;
        for (const auto& n : kNormal) {
          if (voxels.state(i + n[0], j + n[1], k + n[2]) != CellState::kFree) continue;
          if (rate < 0.0) {
            rate = density(i, j, k) * r * r;
            if (!std::isfinite(rate) || rate < 0.0) rate = 0.0;
          }
          if (rate == 0.0) break;
          const int count = std::poisson_distribution<int>(rate)(generator);
          for (int c = 0; c < count; ++c) {
            Feature feature;
            feature.normal = Eigen::Vector3d(n[0], n[1], n[2]);
            const double a = uniform(generator), b = uniform(generator);
            // Coordinates in the voxel: on the face along the normal, uniform across it.
            const int axis = n[0] != 0 ? 0 : (n[1] != 0 ? 1 : 2);
            Eigen::Vector3d q;
            q[axis] = n[axis] > 0 ? 1.0 : 0.0;
            q[(axis + 1) % 3] = a;
            q[(axis + 2) % 3] = b;
            feature.position = (Eigen::Vector3d(i, j, k) + q) * r;
            found.push_back(feature);
          }
        }
      }
    }
  }
  put(world, found);
}

FeatureField::FeatureField(const World& world, const std::vector<Feature>& features) {
  put(world, features);
}

void FeatureField::put(const World& world, const std::vector<Feature>& found) {
  const GridFrame& f = world.voxels.frame();
  const double r = world.voxels.resolution();
  const Cell low = {static_cast<int>(std::floor(f.i0 * r)), static_cast<int>(std::floor(f.j0 * r))};
  const Cell high = {static_cast<int>(std::floor((f.i0 + f.width) * r)),
                     static_cast<int>(std::floor((f.j0 + f.height) * r))};
  bins_ = {1.0, low.i, low.j, high.i - low.i + 1, high.j - low.j + 1};
  const auto bin = [this](const Feature& feature) {
    return static_cast<std::size_t>(
        bins_.index(bins_.cell(feature.position.x(), feature.position.y())));
  };
  first_.assign(static_cast<std::size_t>(bins_.size()) + 1, 0);
  for (const Feature& feature : found) ++first_[bin(feature) + 1];
  for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  features_.resize(found.size());
  for (const Feature& feature : found) features_[next[bin(feature)]++] = feature;
}

FeatureField simulated_features(const World& world, std::uint64_t seed) {
  const std::uint64_t texture = stream_seed(seed, NoiseStream::kTexture);
  return FeatureField(
      world, [&](int i, int j, int k) { return texture_density(world, i, j, k, texture); },
      stream_seed(seed, NoiseStream::kPoints));
}

}  // namespace prospect
