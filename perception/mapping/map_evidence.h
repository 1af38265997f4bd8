// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "engine/maps/planar_move.h"
#include "perception/mapping/evidence_table.h"

namespace prospect {

/// What some scans say of the voxels of a lattice (EvidenceTable), and where in the voxels that
/// were hit the surface lies: the mean of the points that hit it. Memory: 1 kB for 8 x 8 x 8
/// voxels, and 20 bytes for each that was hit.
///
/// Thread-safety: as a value. Deterministic.
class MapEvidence {
 public:
  static constexpr int kEdge = 8;  ///< voxels along an edge of a brick
  static constexpr int kVoxels = kEdge * kEdge * kEdge;
  using State = EvidenceTable::State;
  using Address = std::array<int, 3>;  ///< of a brick: that of its lowest voxel / 8

  struct Hit {
    std::uint16_t voxel = 0, count = 0;
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();  ///< [voxels], of the brick
    float spread = 0.0F;                             ///< variance of their heights [voxels^2]
  };
  struct Brick {
    std::array<State, kVoxels> states{};
    std::vector<Hit> hits{};  ///< by voxel
  };
  /// Number of a voxel in its brick, of coordinates 0 to 7.
  static int voxel(int x, int y, int z) { return (x * kEdge + y) * kEdge + z; }

  Brick& brick(const Address& at) { return bricks_[at]; }
  const std::map<Address, Brick>& bricks() const { return bricks_; }
  /// What is said of the voxel (i, j, k) of the lattice.
  State state(int i, int j, int k) const;
  bool empty() const { return bricks_.empty(); }
  std::size_t bytes() const;

  /// A point that was measured [voxels, of the lattice], in the voxel at (i, j, k).
  void add_hit(const Eigen::Vector3d& point, int i, int j, int k);

  /// The same on another lattice, in which it lies moved. A voxel that is no surface is what the
  /// one says that holds its middle; a surface is in the voxel where its points are. So walls keep
  /// their thickness. Not moved: the same, to the bit. r: edge of a voxel of both [m].
  MapEvidence moved(const PlanarMove& move, double r, const EvidenceTable& table) const;
  /// The bricks that reach into the square within `reach` of a place in the plane [m].
  MapEvidence around(const Eigen::Vector2d& place, double reach, double r) const;
  /// First this, then `later`, on the same lattice.
  void append(const MapEvidence& later, EvidenceTable& table);
  /// Where surfaces are [m, on the lattice].
  std::vector<Eigen::Vector3d> surface(double r, const EvidenceTable& table) const;

 private:
  std::map<Address, Brick> bricks_;
};

}  // namespace prospect
