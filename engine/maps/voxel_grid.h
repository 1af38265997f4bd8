// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/maps/grid.h"

namespace prospect {

/// In voxels: a body that ends exactly on a voxel's face does not overlap that voxel.
inline constexpr double kFaceTolerance = 1e-6;

/// Dense three-state mirror of the octree's finest level, for ray walks: the octree costs a descent
/// a voxel, this an index. Voxels are world-aligned like ground cells: voxel (i, j, k) covers [i r,
/// (i+1) r) x [j r, (j+1) r) x [k r, (k+1) r). Outside the box everything is unknown.
///
/// Value type; a snapshot handed out as shared_ptr<const VoxelGrid> never changes.
/// Thread-safety: concurrent reads are safe.
class VoxelGrid {
 public:
  /// Covers `frame` between the heights z_min and z_max [m], rounded outward to whole voxels.
  VoxelGrid(const GridFrame& frame, double z_min, double z_max);
  /// Covers `frame` and the `depth` layers from k0 on; `data` in the order of data(). Throws
  /// std::invalid_argument if it has another size.
  VoxelGrid(const GridFrame& frame, int k0, int depth, std::vector<CellState> data);

  double resolution() const { return frame_.resolution; }
  const GridFrame& frame() const { return frame_; }
  int k0() const { return k0_; }
  int depth() const { return depth_; }

  bool contains(int i, int j, int k) const {
    return frame_.contains({i, j}) && k >= k0_ && k < k0_ + depth_;
  }
  CellState state(int i, int j, int k) const {
    return contains(i, j, k) ? data_[index(i, j, k)] : CellState::kUnknown;
  }
  /// The voxel that holds a point [m].
  Eigen::Vector3i voxel(const Eigen::Vector3d& p) const {
    return (p / frame_.resolution).array().floor().cast<int>();
  }
  /// Grows in x and y as needed; ignores voxels above and below.
  void set(int i, int j, int k, CellState state);

  /// Index of voxel (i, j, k0()) + n is voxel (i, j, k0() + n): a column is contiguous.
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(frame_.index({i, j})) * static_cast<std::size_t>(depth_)) +
           static_cast<std::size_t>(k - k0_);
  }
  const std::vector<CellState>& data() const { return data_; }

  /// What a ray from `from` to `to` [m, in W] meets, voxel by voxel (exact traversal), leaving out
  /// the last `trim` metres before `to` and the voxel that holds `from`.
  struct Ray {
    bool blocked = false;         ///< an occupied voxel was met
    double unknown_length = 0.0;  ///< [m] of the ray inside unknown voxels, up to the block
    double length = 0.0;          ///< [m] walked, up to the block
  };
  Ray cast(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double trim = 0.0) const;

  /// cast() from one point to many: rays[i] = cast(from, to[i], trim), bit for bit, several rays
  /// abreast and therefore several times faster. Rays of similar length side by side are fastest.
  void cast_many(const Eigen::Vector3d& from, const Eigen::Vector3d* to, int count, double trim,
                 Ray* rays) const;

 private:
  GridFrame frame_;
  int k0_ = 0;
  int depth_ = 0;
  std::vector<CellState> data_;
};

}  // namespace prospect
