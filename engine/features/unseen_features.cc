// SPDX-License-Identifier: Apache-2.0
#include "engine/features/unseen_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "models/parameter_check.h"

namespace prospect {

std::vector<Landmark> unseen_features(const GroundMap& ground, const Pose& pose,
                                      const UnseenFeatureOptions& options,
                                      const LocalTexture* texture, const PausePoint& pause) {
  constexpr const char* kOwner = "unseen features";
  check_not_negative(kOwner, "density", options.density);
  check_positive(kOwner, "block", options.block);
  check_positive(kOwner, "range", options.range);
  check_not_negative(kOwner, "image_cell", options.image_cell);
  std::vector<Landmark> features;
  if (options.density == 0.0 || options.max_blocks <= 0) return features;
  const double r = ground.frame().resolution;
  const int cells = std::max(1, static_cast<int>(std::lround(options.block / r)));
  const double side = cells * r;
  const Eigen::Vector2d here = pose.position.head<2>();
  const int i0 = static_cast<int>(std::floor(here.x() / side));
  const int j0 = static_cast<int>(std::floor(here.y() / side));
  struct Block {
    Landmark landmark;
    double distance, azimuth;
  };
  std::vector<Block> blocks;
  const auto look_at = [&](int i, int j) {
    const Eigen::Vector2d middle((i + 0.5) * side, (j + 0.5) * side);
    if ((middle - here).norm() > options.range + side) return;
    pause();
    int unknown = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int a = i * cells; a < (i + 1) * cells; ++a) {
      for (int b = j * cells; b < (j + 1) * cells; ++b) {
        if (ground.state({a, b}) != CellState::kUnknown) continue;
        ++unknown;
        sum += ground.frame().center({a, b});
      }
    }
    if (unknown == 0) return;
    const Eigen::Vector2d centroid = sum / unknown;
    const Eigen::Vector2d to = centroid - here;
    if (to.norm() > options.range) return;
    Landmark l;
    l.id =
        std::uint64_t{1} << 63 | (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 31 ^
                                  static_cast<std::uint32_t>(j));
    l.position << centroid, options.height;
    l.covariance = Eigen::Matrix3d::Identity() * side * side / 12.0;
    l.creation_direction << -to.normalized(), 0.0;
    if (!(to.norm() > 0.0)) l.creation_direction = Eigen::Vector3d::UnitX();
    l.creation_range = std::max(to.norm(), r);
    l.survival = 1.0;
    const double relative = texture != nullptr ? texture->relative(centroid) : 1.0;
    l.multiplicity = options.density * unknown * r * r * relative;
    l.per_cell = options.density * relative * options.image_cell * options.image_cell;
    blocks.push_back({l, to.norm(), std::atan2(to.y(), to.x())});
  };
  // Ring by ring, until the nearest are there: the range may be far larger than the map.
  const double rings = std::ceil(options.range / side) + 1.0;
  for (int ring = 0; ring <= rings; ++ring) {
    for (int d = -ring; d <= ring; ++d) {
      const int step = std::abs(d) == ring ? 1 : 2 * ring;
      for (int e = -ring; e <= ring; e += step) look_at(i0 + d, j0 + e);
    }
    const double farther = ring * side * (1.0 - 1e-9);  // all blocks beyond are
    const auto nearer = std::count_if(blocks.begin(), blocks.end(),
                                      [&](const Block& b) { return b.distance < farther; });
    if (nearer >= options.max_blocks) break;
  }
  const auto by = [](auto member) {
    return [member](const Block& a, const Block& b) {
      return a.*member != b.*member ? a.*member < b.*member : a.landmark.id < b.landmark.id;
    };
  };
  std::sort(blocks.begin(), blocks.end(), by(&Block::distance));
  if (blocks.size() > static_cast<std::size_t>(options.max_blocks)) {
    blocks.resize(static_cast<std::size_t>(options.max_blocks));
  }
  std::sort(blocks.begin(), blocks.end(), by(&Block::azimuth));
  for (const Block& b : blocks) features.push_back(b.landmark);
  return features;
}

}  // namespace prospect
