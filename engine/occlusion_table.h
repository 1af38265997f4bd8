#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/voxel_grid.h"

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
};

/// P_unoccluded of many points, as a smooth function of the sensor's position.
///
///   P_i(c) = sum over nodes n of w_n(c) V_in,   V_in = [ray n -> point i meets no occupied voxel]
///            * exp(-lambda * length of that ray inside unknown space)
///
/// with w the C1 tensor-product quadratic B-spline of the lattice (a partition of unity, >= 0), so
/// 0 <= P_i <= 1 and its gradient is exact and continuous. The rays are exact voxel traversals,
/// cast once for all candidates and stages; evaluating is one weighted sum of table rows, the same
/// weights for all points, hence vectorised over the points. The last `trim` metres before a point
/// are left out (the point lies on an occupied voxel).
///
/// Rows of nodes whose rays cross no changed tile are taken over from `previous`.
/// Outside the lattice the position is clamped onto it (zero gradient along the clamped axis).
/// Thread-safety: immutable after construction.
/// Source: formulation, section 3 (hard ray cast, smoothed) and section 4 (attenuation).
class OcclusionTable {
 public:
  struct Options {
    double trim = 0.15;        ///< [m]; 1.5 voxels
    double attenuation = 0.5;  ///< lambda [1/m] through unknown space
    double max_range = 8.0;    ///< [m]; farther pairs are stored as 0
  };

  OcclusionTable(const SensorLattice& lattice, std::vector<Eigen::Vector3d> points,
                 const VoxelGrid& voxels, const Options& options);

  int num_points() const { return static_cast<int>(points_.size()); }
  const SensorLattice& lattice() const { return lattice_; }

  /// Writes num_points() probabilities, and, unless null, their derivatives with respect to the
  /// sensor's position [1/m]; d_z is zero for a lattice with nz = 1.
  void evaluate(const Eigen::Vector3d& sensor, double* probability, double* d_x = nullptr,
                double* d_y = nullptr, double* d_z = nullptr) const;

 private:
  SensorLattice lattice_;
  std::vector<Eigen::Vector3d> points_;
  int stride_ = 0;            // floats per node row, padded
  std::vector<float> table_;  // node-major
};

}  // namespace prospect
