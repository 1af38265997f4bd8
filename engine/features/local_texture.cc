// SPDX-License-Identifier: Apache-2.0
#include "engine/features/local_texture.h"

#include <algorithm>
#include <cmath>

#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr double kLengths = 5.0;  // of correlation: what is farther away counts for nothing

}  // namespace

LocalTexture::LocalTexture(const GroundMap& ground, const LandmarkMap& landmarks,
                           const Eigen::Vector2d& around, const LocalTextureOptions& options,
                           const PausePoint& pause)
    : options_(options) {
  constexpr const char* kOwner = "local texture";
  check_positive(kOwner, "block", options.block);
  check_positive(kOwner, "length", options.length);
  check_positive(kOwner, "prior", options.prior);
  check_positive(kOwner, "reach", options.reach);
  const Grid<CellState>& cells = ground.cells();
  const GridFrame fine = intersection(
      cells.frame, frame_around(cells.frame.cell(around.x(), around.y()),
                                std::min(options.reach, kFarthest), cells.frame.resolution));
  if (fine.size() == 0) return;
  const int side = std::max(1, static_cast<int>(std::lround(options.block / fine.resolution)));
  blocks_ = Grid<Seen>(frame_of_blocks(fine, side), {});

  double wall = 0.0;
  for (int index = 0; index < fine.size(); ++index) {
    if (index % 1024 == 0) pause();
    const Cell c = fine.at(index);
    if (cells[c] != CellState::kOccupied) continue;
    const auto is_free = [&](int di, int dj) {
      return ground.state({c.i + di, c.j + dj}) == CellState::kFree;
    };
    if (!is_free(1, 0) && !is_free(-1, 0) && !is_free(0, 1) && !is_free(0, -1)) continue;
    blocks_[{floor_divide(c.i, side), floor_divide(c.j, side)}].wall += fine.resolution;
    wall += fine.resolution;
  }
  double count = 0.0;
  std::size_t looked_at = 0;
  for (const Landmark& l : landmarks.landmarks) {
    if (++looked_at % 256 == 0) pause();
    const Eigen::Vector2d p = l.position.head<2>();
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest) continue;
    if (!blocks_.frame.contains(block_of(p))) continue;
    blocks_[block_of(p)].landmarks += l.multiplicity;
    count += l.multiplicity;
  }
  if (count > 0.0) {
    for (Seen& b : blocks_.data) b.landmarks *= wall / count;
  }
}

double LocalTexture::relative(const Eigen::Vector2d& p) const {
  const GridFrame& frame = blocks_.frame;
  const Cell at = block_of(p);
  const int reach = static_cast<int>(std::ceil(kLengths * options_.length / frame.resolution));
  double wall = options_.prior, landmarks = options_.prior;
  for (int j = std::max(frame.j0, at.j - reach);
       j <= std::min(frame.j0 + frame.height - 1, at.j + reach); ++j) {
    for (int i = std::max(frame.i0, at.i - reach);
         i <= std::min(frame.i0 + frame.width - 1, at.i + reach); ++i) {
      const Seen& b = blocks_[{i, j}];
      if (b.wall == 0.0 && b.landmarks == 0.0) continue;
      const double distance = (frame.center({i, j}) - p).norm();
      const double w = std::exp(-distance / options_.length);
      wall += w * b.wall;
      landmarks += w * b.landmarks;
    }
  }
  return std::min(1.0, landmarks / wall);
}

}  // namespace prospect
