#include "engine/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prospect {

VoxelGrid::VoxelGrid(const GridFrame& frame, double z_min, double z_max) : frame_(frame) {
  k0_ = static_cast<int>(std::floor(z_min / frame.resolution));
  depth_ = std::max(1, static_cast<int>(std::ceil(z_max / frame.resolution)) - k0_);
  data_.assign(static_cast<std::size_t>(frame.size()) * static_cast<std::size_t>(depth_),
               CellState::kUnknown);
}

void VoxelGrid::set(int i, int j, int k, CellState state) {
  if (k < k0_ || k >= k0_ + depth_) return;
  if (!frame_.contains({i, j})) {
    if (state == CellState::kUnknown) return;
    constexpr int kMargin = 128;
    const GridFrame old = frame_;
    GridFrame wide = old;
    wide.i0 = i < old.i0 ? i - kMargin : old.i0;
    wide.j0 = j < old.j0 ? j - kMargin : old.j0;
    wide.width = (i >= old.i0 + old.width ? i + kMargin : old.i0 + old.width) - wide.i0;
    wide.height = (j >= old.j0 + old.height ? j + kMargin : old.j0 + old.height) - wide.j0;
    std::vector<CellState> data(
        static_cast<std::size_t>(wide.size()) * static_cast<std::size_t>(depth_),
        CellState::kUnknown);
    const std::size_t row = static_cast<std::size_t>(old.width) * static_cast<std::size_t>(depth_);
    for (int y = 0; y < old.height; ++y) {
      std::copy_n(
          data_.begin() + static_cast<std::ptrdiff_t>(row) * y, row,
          data.begin() + static_cast<std::ptrdiff_t>(wide.index({old.i0, old.j0 + y})) * depth_);
    }
    frame_ = wide;
    data_ = std::move(data);
  }
  data_[index(i, j, k)] = state;
}

VoxelGrid::Ray VoxelGrid::cast(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                               double trim) const {
  Ray ray;
  const Eigen::Vector3d span = to - from;
  const double distance = span.norm();
  const double end = distance - trim;
  if (!(end > 0.0) || !std::isfinite(distance)) return ray;
  const Eigen::Vector3d direction = span / distance;
  const double r = frame_.resolution;
  Eigen::Vector3i v = voxel(from);
  Eigen::Vector3i step;
  Eigen::Vector3d next, delta;  // ray parameter [m] at the next voxel face, and between faces
  for (int a = 0; a < 3; ++a) {
    if (direction[a] > 0.0) {
      step[a] = 1;
      next[a] = ((v[a] + 1) * r - from[a]) / direction[a];
      delta[a] = r / direction[a];
    } else if (direction[a] < 0.0) {
      step[a] = -1;
      next[a] = (v[a] * r - from[a]) / direction[a];
      delta[a] = -r / direction[a];
    } else {
      step[a] = 0;
      next[a] = delta[a] = std::numeric_limits<double>::infinity();
    }
  }
  double t = 0.0;
  bool first = true;
  while (true) {
    int axis = next[0] < next[1] ? 0 : 1;
    if (next[2] < next[axis]) axis = 2;
    const double leave = std::min(next[axis], end);
    if (!first) {
      const CellState s = state(v[0], v[1], v[2]);
      if (s == CellState::kOccupied) {
        ray.blocked = true;
        ray.length = t;
        return ray;
      }
      if (s == CellState::kUnknown) ray.unknown_length += leave - t;
    }
    first = false;
    if (next[axis] >= end) break;
    t = next[axis];
    v[axis] += step[axis];
    next[axis] += delta[axis];
  }
  ray.length = end;
  return ray;
}

}  // namespace prospect
