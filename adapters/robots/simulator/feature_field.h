// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "adapters/formats/worlds/world.h"

namespace prospect {

/// A point of a true surface that a corner detector would find.
struct Feature {
  Eigen::Vector3d position;  ///< [m], true world; on a face of an occupied voxel
  Eigen::Vector3d normal;    ///< unit, out of the surface
};

/// The true features of a world. A feature's index is its identity. Immutable after construction;
/// concurrent reads are safe. Deterministic in what it was made of.
class FeatureField {
 public:
  /// On every face between an occupied and a free voxel, a Poisson number of points of mean
  /// density x r^2, uniform over the face.
  /// density(i, j, k): features per m^2 on the faces of occupied voxel (i, j, k); not negative.
  FeatureField(const World& world, const std::function<double(int, int, int)>& density,
               std::uint64_t seed);
  /// These, somewhere in the world.
  FeatureField(const World& world, const std::vector<Feature>& features);

  const std::vector<Feature>& features() const { return features_; }

  /// Calls visit(index) for every feature whose ground position lies within `range` [m] of (x, y),
  /// and for some beyond; the order is fixed.
  template <typename Visitor>
  void near(double x, double y, double range, const Visitor& visit) const {
    const Cell low = bins_.cell(x - range, y - range);
    const Cell high = bins_.cell(x + range, y + range);
    for (int j = std::max(low.j, bins_.j0); j <= std::min(high.j, bins_.j0 + bins_.height - 1);
         ++j) {
      for (int i = std::max(low.i, bins_.i0); i <= std::min(high.i, bins_.i0 + bins_.width - 1);
           ++i) {
        const auto b = static_cast<std::size_t>(bins_.index({i, j}));
        for (std::uint32_t n = first_[b]; n < first_[b + 1]; ++n) visit(n);
      }
    }
  }

 private:
  void put(const World& world, const std::vector<Feature>& found);

  GridFrame bins_;  // squares of 1 m, each holding a run of features
  std::vector<std::uint32_t> first_;
  std::vector<Feature> features_;
};

/// The features that a simulation of this seed has: of the world's own texture, or of a patchy one
/// drawn from the seed.
FeatureField simulated_features(const World& world, std::uint64_t seed);

}  // namespace prospect
