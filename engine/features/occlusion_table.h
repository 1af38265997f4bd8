// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/features/occlusion_kernel.h"
#include "engine/maps/voxel_grid.h"

namespace prospect {

/// Lattice of sensor positions in W: node (a, b, c) = origin + spacing * (a, b, c), world-aligned
/// (origin is a multiple of spacing), so that nodes of consecutive tables coincide.
struct SensorLattice {
  Eigen::Vector3d origin =
      Eigen::Vector3d::Zero();  ///< [m]; for a planar base, z is the sensor's height
  double spacing = 0.2;         ///< [m]
  int nx = 0, ny = 0, nz = 1;   ///< nz = 1: the sensor's height is fixed

  /// Nodes that cover all sensor positions within `reach` [m] of `center` with the margin that the
  /// interpolation needs. nz > 1 only with vertical = true.
  static SensorLattice around(const Eigen::Vector3d& center, double reach, double spacing,
                              bool vertical = false);
  /// The same where a table of it holds at most kMostEntries, nodes times points. A larger one is
  /// without what lies so much farther than `range` [m] from all of `points` that a table of that
  /// max_range is zero there: it follows what there is to see, however far the sensor could get,
  /// and probabilities are the same, to rounding. If that is still too much, the spacing is doubled
  /// until it is not.
  static SensorLattice around(const Eigen::Vector3d& center, double reach, double spacing,
                              bool vertical, const std::vector<Eigen::Vector3d>& points,
                              double range);
  static constexpr double kMostEntries = 5e7;
};

/// P_unoccluded of many points, as a smooth function of the sensor's position.
///
///   P_i(c) = sum over nodes n of w_n(c) V_in,   V_in = [ray n -> point i meets no occupied voxel]
///            * exp(-lambda * length of that ray inside unknown space)
///
/// with w the C1 tensor-product quadratic B-spline of the lattice (a partition of unity, >= 0), so
/// 0 <= P_i <= 1 and its gradient is exact and continuous. The rays are exact voxel traversals,
/// cast once for all candidates and stages; evaluating is one weighted sum of table rows, the same
/// weights for all points, hence vectorised over the points (OcclusionKernel; the value has the
/// same bits with and without derivatives). The last `trim` metres before a point are left out (the
/// point lies on an occupied voxel).
///
/// A node's rays are cast when a position near it is first asked for: the candidates of a planning
/// step come near three nodes in ten. What is written then is what would have been written at any
/// other time, so that nothing but the time of an evaluation depends on it. Memory is taken by rows
/// that were cast, and 2 bytes a node.
///
/// A node inside an occupied voxel has no view of its own; it takes the mean row of its neighbours
/// (at most 8, or 26 with nz > 1) that are not inside one, so that a sensor beside a wall is not
/// dimmed by the wall's inside; without such a neighbour its row is 0 (our choice).
///
/// Nearer to the lattice's edge than half a spacing, and beyond it, the position is clamped (zero
/// gradient along the clamped axis). A non-finite position gives NaN everywhere.
/// Smoothness in the sensor's position: C1 (C0 where the clamp sets in).
/// Thread-safety: const; may be evaluated concurrently (of two threads that need the same row
/// first, one waits for the other). Evaluating does not allocate. Source: formulation, section 3
/// (hard ray cast, smoothed) and section 4 (attenuation).
class OcclusionTable {
 public:
  using Clock = std::chrono::steady_clock;

  struct Options {
    double trim = 0.15;        ///< [m]; 1.5 voxels
    double attenuation = 0.5;  ///< lambda [1/m] through unknown space
    double max_range = 8.0;    ///< [m]; farther pairs are stored as 0
    friend bool operator==(const Options&, const Options&) = default;
  };

  /// Nodes that a table may have.
  static constexpr int kMostNodes = 100'000'000;

  /// All rays are cast at once; `voxels` need not outlive the call. Throws std::invalid_argument
  /// for a lattice of fewer than 3 nodes along x or y (along z: 1, or at least 3) or more than
  /// kMostNodes in all, a spacing that is not positive, or non-finite points.
  OcclusionTable(const SensorLattice& lattice, std::vector<Eigen::Vector3d> points,
                 const VoxelGrid& voxels, const Options& options);

  /// The same, but rays are cast when they are needed, in `voxels`, which the table keeps, and
  /// which lets it serve as `previous` of the next one: the value of a (node, point) pair that
  /// `previous` was asked for (same spacing, options and exact position) is taken over unless a
  /// voxel differs between the two snapshots near the ray (in the tiles of 8 x 8 columns that the
  /// bounding rectangles of its quarters touch). The result is the same, bit for bit, as without
  /// `previous`. `voxels` must not be null; `previous` may be, and need not outlive the call. What
  /// is taken over at `until` is all that is: the rows nearest to the lattice's middle come first.
  OcclusionTable(const SensorLattice& lattice, std::vector<Eigen::Vector3d> points,
                 std::shared_ptr<const VoxelGrid> voxels, const Options& options,
                 const OcclusionTable* previous,
                 Clock::time_point until = Clock::time_point::max());

  int num_points() const { return static_cast<int>(points_.size()); }
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  const SensorLattice& lattice() const { return lattice_; }

  /// Writes num_points() probabilities, and, unless null, their derivatives with respect to the
  /// sensor's position [1/m]; d_z is zero for a lattice with nz = 1. d_x and d_y come together
  /// (both null or neither); d_z may be null on its own. No output may overlap another.
  void evaluate(const Eigen::Vector3d& sensor, double* probability, double* d_x = nullptr,
                double* d_y = nullptr, double* d_z = nullptr) const;
  /// The probabilities in single precision, to 1e-6: for comparing candidates.
  void score(const Eigen::Vector3d& sensor, float* probability) const;

  /// Casts what has not been cast yet: for who measures evaluations.
  void cast_all() const;
  /// Number of rays that were cast (not taken over) so far.
  std::int64_t rays_cast() const { return rays_cast_; }

 private:
  /// Calls add(plane, is_first) for each plane of the spline at a finite position.
  template <class Add>
  void for_planes(const Eigen::Vector3d& sensor, const Add& add) const;
  /// What is known of a node's row.
  enum class Row : std::uint8_t {
    kEmpty,    // nothing
    kPartial,  // NaN is what has not been cast
    kBusy,     // a thread is at it
    kReady
  };
  /// Checks the input and takes over what it can.
  void prepare(const VoxelGrid& voxels, const OcclusionTable* previous, Clock::time_point until);
  void take_over(const VoxelGrid& voxels, const OcclusionTable& previous, Clock::time_point until);
  /// The row of a node, complete.
  const float* complete_row(int a, int b, int c) const {
    if (rows_[node(a, b, c)].load(std::memory_order_acquire) != Row::kReady) complete(a, b, c);
    return table_.get() + row(a, b, c);
  }
  void complete(int a, int b, int c) const;
  void cast_rays(int a, int b, int c, bool partial) const;
  void mean_of_neighbours(int a, int b, int c) const;
  /// Along an axis. From the node's address in the world where the lattice is aligned, so that a
  /// node has the same position to the last bit in every table.
  double coordinate(int axis, int n) const;
  Eigen::Vector3d node_position(int a, int b, int c) const {
    return {coordinates_[0][static_cast<std::size_t>(a)],
            coordinates_[1][static_cast<std::size_t>(b)],
            coordinates_[2][static_cast<std::size_t>(c)]};
  }
  /// Whether the node lies inside an occupied voxel.
  bool in_wall(int a, int b, int c, const VoxelGrid& voxels) const {
    const Eigen::Vector3i v = voxels.voxel(node_position(a, b, c));
    return voxels.state(v.x(), v.y(), v.z()) == CellState::kOccupied;
  }
  std::size_t node(int a, int b, int c) const {
    return (static_cast<std::size_t>(c) * static_cast<std::size_t>(lattice_.ny) +
            static_cast<std::size_t>(b)) *
               static_cast<std::size_t>(lattice_.nx) +
           static_cast<std::size_t>(a);
  }
  std::size_t row(int a, int b, int c) const {
    return node(a, b, c) * static_cast<std::size_t>(stride_);
  }

  SensorLattice lattice_;
  std::vector<Eigen::Vector3d> points_;
  Options options_;
  std::shared_ptr<const VoxelGrid> voxels_;         // null: cannot serve as `previous`
  const VoxelGrid* cast_in_ = nullptr;              // while not all rows are ready
  std::vector<int> order_;                          // in which a node's rays are cast
  int stride_ = 0;                                  // floats per node row, padded
  std::array<std::vector<double>, 3> coordinates_;  // of the nodes along x, y and z
  // Written by complete() alone, a row by the thread that has made it kBusy.
  struct Unmap {
    std::size_t bytes;
    void operator()(float* memory) const;
  };
  // Node-major, x fastest. Zeros of the system, which cost nothing where nobody writes; those of
  // calloc() are written, all of them, where it has that much memory left over.
  std::unique_ptr<float[], Unmap> table_;
  std::unique_ptr<std::atomic<Row>[]> rows_;
  mutable std::atomic<std::int64_t> rays_cast_ = 0;
  OcclusionKernel kernel_ = occlusion_kernel(best_instruction_set());
  OcclusionScoreKernel score_kernel_ = occlusion_score_kernel(best_instruction_set());
};

}  // namespace prospect
