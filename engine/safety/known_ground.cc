// SPDX-License-Identifier: Apache-2.0
#include "engine/safety/known_ground.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>

#include "engine/maps/grid.h"
#include "models/formatted.h"

namespace prospect {
namespace {

constexpr double kAbout = 2.0;    // [m] beyond the body
constexpr int kMostAcross = 24;   // samples along the diameter of the body
constexpr int kMostAround = 100;  // and of the square around it

/// Whether a map knows anything at a point of the ground, at the body's heights.
class Known {
 public:
  Known(const Belief& belief, const RobotShape& shape, bool planar)
      : voxels_(*belief.voxels),
        ground_(*belief.ground),
        height_(vertical_extent(shape)),
        planar_(planar) {}

  double resolution() const { return ground_.frame().resolution; }
  bool operator()(double x, double y, double z) const {
    const Cell c = ground_.frame().cell(x, y);
    if (planar_) {
      return ground_.explored(c) && any_known(c, voxels_.k0(), voxels_.k0() + voxels_.depth() - 1);
    }
    return any_known(c, voxels_.voxel({x, y, z + height_.z_min}).z(),
                     voxels_.voxel({x, y, z + height_.z_max}).z());
  }

 private:
  bool any_known(Cell c, int low, int high) const {
    for (int k = std::max(low, voxels_.k0());
         k <= std::min(high, voxels_.k0() + voxels_.depth() - 1); ++k) {
      if (voxels_.state(c.i, c.j, k) != CellState::kUnknown) return true;
    }
    return false;
  }

  const VoxelGrid& voxels_;
  const GroundMap& ground_;
  VerticalExtent height_;
  bool planar_;
};

bool knows_anything(const Known& known, const Pose& at, double reach) {
  const double step = std::max(known.resolution(), 2.0 * reach / kMostAround);
  const int most = static_cast<int>(std::ceil(reach / step));
  // From the middle outward: it is known there, as a rule.
  for (int ring = 0; ring <= most; ++ring) {
    for (int j = -ring; j <= ring; ++j) {
      const int along = std::abs(j) == ring ? 1 : std::max(1, 2 * ring);
      for (int i = -ring; i <= ring; i += along) {
        if (known(at.position.x() + i * step, at.position.y() + j * step, at.position.z())) {
          return true;
        }
      }
    }
  }
  return false;
}

bool knows_ground(const Belief& belief, const RobotShape& shape, bool planar,
                  std::span<const Pose> poses) {
  const Known known(belief, shape, planar);
  const Pose& start = poses.front();
  if (!knows_anything(known, start, circumscribed_radius(shape) + kAbout)) return false;
  const double radius = inscribed_radius(shape);
  const double step = std::max(known.resolution(), 2.0 * radius / kMostAcross);
  const int most = static_cast<int>(std::ceil(radius / step));
  struct Count {
    int all = 0, known = 0;
    bool most() const { return 2 * known >= all; }
  };
  Count covered, entered;
  for (const Pose& pose : poses) {
    const Cell middle{static_cast<int>(std::floor(pose.position.x() / step)),
                      static_cast<int>(std::floor(pose.position.y() / step))};
    for (int j = middle.j - most; j <= middle.j + most; ++j) {
      for (int i = middle.i - most; i <= middle.i + most; ++i) {
        const Eigen::Vector2d p((i + 0.5) * step, (j + 0.5) * step);
        if ((p - pose.position.head<2>()).norm() > radius) continue;
        const bool is_known = known(p.x(), p.y(), pose.position.z());
        ++covered.all;
        covered.known += is_known;
        if ((p - start.position.head<2>()).norm() <= radius) continue;
        ++entered.all;
        entered.known += is_known;
      }
    }
  }
  return covered.most() || entered.most();
}

}  // namespace

std::string unknown_ground(const Belief& belief, const RobotShape& shape, bool planar,
                           std::span<const Pose> poses) {
  if (!belief.octree) return "the belief lacks the octree that its maps are of";
  const double voxels = belief.voxels->resolution();
  for (const double other : {belief.ground->frame().resolution, belief.octree->getResolution()}) {
    if (std::abs(other - voxels) <= 1e-9 * voxels) continue;
    return formatted("the maps are of different resolutions, %.4g and %.4g m: not of one place",
                     voxels, other);
  }
  if (knows_ground(belief, shape, planar, poses)) return "";
  return "the map does not know the ground of the motion: it is empty, or of elsewhere";
}

}  // namespace prospect
