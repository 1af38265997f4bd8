// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "perception/mapping/evidence_table.h"
#include "perception/mapping/map_evidence.h"

namespace prospect {

/// The walls of an anchor's evidence, on its lattice: places of upright surfaces, each with the
/// direction that it faces in the plane.
///
/// A place is where a voxel was hit (MapEvidence::Hit). Its direction is that in which the hits
/// within kAround of it vary least, if that is upright to within 30 degrees, and they vary along
/// some other at least four times as much, in variance: floors, edges and single points have none,
/// and are left out. Where all was hit in one layer of voxels, as by a lidar that scans one plane,
/// walls are taken to be upright: the direction is that in the plane. Of its two sides a wall faces
/// the one that is known to be free nearer to it (within 0.3 m): so the two sides of a partition
/// are two walls. Where both are as near, it faces either.
///
/// Thread-safety: concurrent reads are safe. Deterministic.
class SubmapSurface {
 public:
  static constexpr double kAround = 0.3;  ///< [m]

  struct Wall {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();      ///< [m]
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< of length 1, to where it faces
    bool either = true;                                ///< it faces the opposite as well
  };

  SubmapSurface() = default;
  /// r: edge of a voxel [m].
  SubmapSurface(const MapEvidence& evidence, double r, const EvidenceTable& table);
  const std::vector<Wall>& walls() const { return walls_; }

 private:
  std::vector<Wall> walls_;
};

/// For each place near the walls of a submap which of them is nearest, in its layer of voxels,
/// among those that face alike: a distance field for each eighth of the circle. And what is known
/// of the place.
class NearestWall {
 public:
  /// reach [m]: of the field.
  NearestWall(const MapEvidence& evidence, const SubmapSurface& surface, double r,
              const EvidenceTable& table, double reach = 0.6);

  enum class Place : std::uint8_t { kUnknown, kFree, kSurface };
  Place place(const Eigen::Vector3d& p) const;
  /// Of those that face as a wall does, to within 37 degrees, that is at p with this normal. Null:
  /// none within reach.
  const SubmapSurface::Wall* nearest(const Eigen::Vector3d& p, const Eigen::Vector2d& normal,
                                     bool either) const;

 private:
  static constexpr int kSectors = 8;
  static int sector(const Eigen::Vector2d& normal);
  bool index(const Eigen::Vector3d& p, std::size_t& at) const;

  double r_ = 0.1;
  int low_[3] = {0, 0, 0}, size_[3] = {0, 0, 0};  // voxels
  std::vector<SubmapSurface::Wall> walls_;
  std::vector<std::int32_t> nearest_[kSectors];  // -1: none; empty: none of this sector
  std::vector<Place> place_;
};

}  // namespace prospect
