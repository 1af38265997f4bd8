// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/maps/grid.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/voxel_grid.h"
#include "engine/support/resumable.h"
#include "engine/task/zone_map.h"
#include "models/robot_shape.h"

namespace prospect {

/// Signed distance from a point to the obstacles around the robot, as a smooth function of
/// position.
///
/// Obstacles O are boxes of voxels:
///   planar (vertical = false):  a voxel counts if it overlaps the height slice [slice.z_min,
///       slice.z_max] in W. The probe is the vertical segment of that slice at (x, y), so distances
///       are horizontal, and z is ignored. Voxels outside the slice (floor, ceiling) never count.
///   3-D (vertical = true):  every voxel counts, and the probe is the point (x, y, z).
/// With Obstacles::kOccupiedAndUnknown, unknown space counts as well: in the planar case the
/// columns whose ground cell is unknown, in the 3-D case unknown voxels (also those beyond the
/// voxel grid).
///
/// Nodes are the centres of the voxels within `reach` of the centre. A node n outside O holds
///   f_n = min(distance(n, O), cutoff) >= 0,   inside O   f_n = -min(distance(n, complement of O),
///   cutoff).
/// Each of these distances was measured by FCL, probe against voxel box. Nodes and voxels lie on
/// one lattice, so a distance depends only on the integer offset between them: FCL measures every
/// offset within the cutoff once, and an exact integer distance transform says which offset is a
/// node's. With zones, f_n is at most the signed distance of the node to their forbidden parts.
///
/// Between nodes:  d(p) = sum_n w_n(p) c_n,   w the tensor-product quadratic B-spline (C1, >= 0,
/// sums to one), with coefficients
///   c_n = f_n - 1/8 sum over axes of max(0, second difference of f at n) - margin.
/// A B-spline of plain samples averages: it understates d on ridges (between two walls) and
/// overstates it where d is convex (round a corner, by about h^2 / 8R at distance R). The
/// correction makes the convex part third-order accurate and leaves the safe side as it is. What
/// overstatement remains is measured in docs/results/obstacles.md; the Certificate does not rely on
/// this field.
///
/// Beyond the window d continues with the value at the border, less sqrt(s^2 + h^2) - h with s the
/// distance to it: distance being 1-Lipschitz, that is a lower bound up to the smoothing h.
///
/// Beyond what is known, by more than the cutoff, f is the same everywhere. Nodes there are not
/// stored; a window may be far larger than the map.
///
/// The lattice is world-aligned, so nodes of consecutive fields coincide, and a node's value
/// depends only on the voxels within the cutoff: it is bit for bit the same in every window. The
/// transform is so cheap (docs/results/performance.md) that all nodes are computed anew each time,
/// which also sees voxels that change without changing their ground cell's state; `previous` lends
/// FCL's measurements.
///
/// Thread-safety: immutable after construction. Smoothness: C1 in position. Never non-finite for a
/// finite position.
/// Source: formulation, section 5; kernel, correction and continuation are our choice.
class ClearanceField {
 public:
  enum class Obstacles { kOccupied, kOccupiedAndUnknown };

  struct Options {
    /// Half width of the window in x and y [m]. More than 10^8 voxels count as 10^8.
    double reach = 4.6;
    /// Distances are exact up to here and saturate beyond [m]; 1 to kMostVoxels voxels. Must exceed
    /// the body's largest bounding radius by the clearance that terms ask for.
    double cutoff = 0.8;
    double margin = 0.0;  ///< subtracted from every distance [m]
    Obstacles obstacles = Obstacles::kOccupied;
    bool vertical = false;              ///< true: 3-D lattice
    VerticalExtent slice = {0.1, 0.5};  ///< [m] in W; planar only. The body's extent + fixed_z.
    double vertical_reach = 1.5;        ///< half height of the window [m]; 3-D only
    std::shared_ptr<const ZoneMap> zones{};  ///< forbidden parts count, too; null: none
  };

  /// Voxels of the largest cutoff, of a planar base and of one that moves in 3-D.
  static constexpr int kMostVoxels = 400, kMostVoxelsInSpace = 100;
  /// Whether distances up to `cutoff` [m] can be told in voxels of `resolution` [m].
  static bool reaches(double cutoff, double resolution, bool vertical) {
    constexpr double kRounding = 1e-9;
    const int most = vertical ? kMostVoxelsInSpace : kMostVoxels;
    return cutoff >= resolution && cutoff <= most * resolution * (1.0 + kRounding);
  }
  /// Nodes that are stored at most: a window that takes more is made smaller, about its centre.
  static constexpr int kMostNodes = 20'000'000;

  /// Window around `center` (W, [m]). `ground` has the resolution of `voxels`. `previous` may be
  /// null or any field; it is used only where its options and resolution are the same, and not
  /// kept. Throws std::invalid_argument for a non-finite centre or options out of range.
  ClearanceField(const Eigen::Vector3d& center, const VoxelGrid& voxels, const GroundMap& ground,
                 const Options& options, const ClearanceField* previous = nullptr,
                 const PausePoint& pause = {});

  /// d(p) [m] at p in W, and, unless null, its gradient [-] (z: 0 in the planar case).
  double distance(const Eigen::Vector3d& p, Eigen::Vector3d* gradient = nullptr) const {
    return gradient != nullptr ? interpolate<true>(p, gradient) : interpolate<false>(p, nullptr);
  }

  /// The exact value f at the node of voxel (i, j, k) (k ignored in the planar case); requires
  /// contains(i, j, k), which says whether it is stored.
  double node(int i, int j, int k = 0) const { return values_[index(i, j, k)]; }
  bool contains(int i, int j, int k = 0) const {
    return nodes_.contains({i, j}) && (depth_ == 1 || (k >= k0_ && k < k0_ + depth_));
  }
  /// Voxel columns whose nodes are stored.
  const GridFrame& frame() const { return nodes_; }
  int k0() const { return k0_; }
  int depth() const { return depth_; }  ///< layers of nodes; 1 in the planar case
  double resolution() const { return nodes_.resolution; }
  const Options& options() const { return options_; }

 private:
  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(nodes_.index({i, j})) * static_cast<std::size_t>(depth_) +
           static_cast<std::size_t>(depth_ == 1 ? 0 : k - k0_);
  }
  template <bool kGradient>
  double interpolate(const Eigen::Vector3d& p, Eigen::Vector3d* gradient) const;
  /// The part of the window beyond which f is the same everywhere.
  GridFrame stored_part(const VoxelGrid& voxels, const GroundMap& ground) const;
  void gather(const VoxelGrid& voxels, const GroundMap& ground, const PausePoint& pause);
  void measure_offsets(const PausePoint& pause);
  /// Squared gaps are counted in half voxels, in integers of type T.
  template <typename T>
  void transform(const PausePoint& pause);
  void keep_out(const PausePoint& pause);
  void correct(const PausePoint& pause);

  Options options_;
  int halo_ = 0;      // voxels beyond the nodes that can matter: those within the cutoff
  GridFrame window_;  // columns of the window
  GridFrame nodes_;   // columns with stored nodes
  int k0_ = 0;        // lowest layer of nodes
  int depth_ = 1;
  GridFrame cells_;  // nodes_ widened by halo_
  int cells_k0_ = 0;
  int cells_depth_ = 1;
  std::vector<std::uint8_t> solid_;      // 1: obstacle; over cells_, a column contiguous
  std::vector<double> offset_distance_;  // FCL distance by squared offset in half voxels
  std::vector<double> values_;           // f
  std::vector<double> coefficients_;     // c
};

}  // namespace prospect
