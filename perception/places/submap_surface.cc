// SPDX-License-Identifier: Apache-2.0
#include "perception/places/submap_surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace prospect {
namespace {

constexpr int kEdge = MapEvidence::kEdge;

}  // namespace

SubmapSurface::SubmapSurface(const MapEvidence& evidence, double r, const EvidenceTable& table) {
  const std::vector<Eigen::Vector3d> points = evidence.surface(r, table);
  // By cubes of kAround: neighbours are in the 27 about a point's.
  using Cube = std::array<int, 3>;
  const auto cube_of = [](const Eigen::Vector3d& p) {
    return Cube{static_cast<int>(std::floor(p.x() / kAround)),
                static_cast<int>(std::floor(p.y() / kAround)),
                static_cast<int>(std::floor(p.z() / kAround))};
  };
  std::map<Cube, std::vector<int>> cubes;
  for (std::size_t n = 0; n < points.size(); ++n) {
    cubes[cube_of(points[n])].push_back(static_cast<int>(n));
  }
  constexpr int kLeast = 6;
  constexpr double kUpright = 0.5, kFlat = 0.25;
  for (const auto& [cube, own] : cubes) {
    std::vector<int> near;
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          const auto found = cubes.find({cube[0] + x, cube[1] + y, cube[2] + z});
          if (found == cubes.end()) continue;
          near.insert(near.end(), found->second.begin(), found->second.end());
        }
      }
    }
    for (const int n : own) {
      const Eigen::Vector3d& p = points[static_cast<std::size_t>(n)];
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
      int count = 0;
      for (const int m : near) {
        const Eigen::Vector3d d = points[static_cast<std::size_t>(m)] - p;
        if (d.squaredNorm() > kAround * kAround) continue;
        mean += d;
        square += d * d.transpose();
        ++count;
      }
      if (count < kLeast) continue;
      mean /= count;
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
      eigen.computeDirect(square / count - mean * mean.transpose());
      const Eigen::Vector3d normal = eigen.eigenvectors().col(0);
      if (std::abs(normal.z()) > kUpright) continue;
      if (eigen.eigenvalues()[0] > kFlat * eigen.eigenvalues()[1]) continue;
      walls_.push_back({p, normal.head<2>().normalized()});
    }
  }
}

NearestWall::NearestWall(const MapEvidence& evidence, const SubmapSurface& surface, double r,
                         const EvidenceTable& table, double reach)
    : r_(r), walls_(surface.walls()) {
  if (evidence.empty()) return;
  int high[3];
  for (int a = 0; a < 3; ++a) {
    low_[a] = std::numeric_limits<int>::max();
    high[a] = std::numeric_limits<int>::min();
  }
  for (const auto& [at, brick] : evidence.bricks()) {
    for (std::size_t a = 0; a < 3; ++a) {
      low_[a] = std::min(low_[a], at[a] * kEdge);
      high[a] = std::max(high[a], (at[a] + 1) * kEdge);
    }
  }
  for (int a = 0; a < 3; ++a) size_[a] = high[a] - low_[a];
  const std::size_t volume = static_cast<std::size_t>(size_[0]) *
                             static_cast<std::size_t>(size_[1]) *
                             static_cast<std::size_t>(size_[2]);
  nearest_.assign(volume, -1);
  place_.assign(volume, Place::kUnknown);
  const auto at = [this](int i, int j, int k) {
    return (static_cast<std::size_t>(k - low_[2]) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(j - low_[1])) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(i - low_[0]);
  };
  for (const auto& [address, brick] : evidence.bricks()) {
    for (int n = 0; n < MapEvidence::kVoxels; ++n) {
      const EvidenceTable::State s = brick.states[static_cast<std::size_t>(n)];
      if (s == EvidenceTable::kNothing) continue;
      place_[at(address[0] * kEdge + n / (kEdge * kEdge), address[1] * kEdge + n / kEdge % kEdge,
                address[2] * kEdge + n % kEdge)] =
          table.is_surface(s) ? Place::kSurface : Place::kFree;
    }
  }
  // Each wall is offered to the voxels around it, in its layer.
  std::vector<float> least(volume, static_cast<float>(reach * reach));
  const int around = static_cast<int>(std::ceil(reach / r));
  for (std::size_t n = 0; n < walls_.size(); ++n) {
    const Eigen::Vector3d& p = walls_[n].at;
    const int i = static_cast<int>(std::floor(p.x() / r)),
              j = static_cast<int>(std::floor(p.y() / r)),
              k = static_cast<int>(std::floor(p.z() / r));
    if (k < low_[2] || k >= high[2]) continue;
    for (int y = std::max(j - around, low_[1]); y <= std::min(j + around, high[1] - 1); ++y) {
      for (int x = std::max(i - around, low_[0]); x <= std::min(i + around, high[0] - 1); ++x) {
        const double dx = (x + 0.5) * r - p.x(), dy = (y + 0.5) * r - p.y();
        const float squared = static_cast<float>(dx * dx + dy * dy);
        const std::size_t v = at(x, y, k);
        if (squared >= least[v]) continue;
        least[v] = squared;
        nearest_[v] = static_cast<std::int32_t>(n);
      }
    }
  }
}

bool NearestWall::index(const Eigen::Vector3d& p, std::size_t& at) const {
  int v[3];
  for (int a = 0; a < 3; ++a) {
    v[a] = static_cast<int>(std::floor(p[a] / r_)) - low_[a];
    if (v[a] < 0 || v[a] >= size_[a]) return false;
  }
  at = (static_cast<std::size_t>(v[2]) * static_cast<std::size_t>(size_[1]) +
        static_cast<std::size_t>(v[1])) *
           static_cast<std::size_t>(size_[0]) +
       static_cast<std::size_t>(v[0]);
  return true;
}

NearestWall::Place NearestWall::place(const Eigen::Vector3d& p) const {
  std::size_t at = 0;
  return index(p, at) ? place_[at] : Place::kUnknown;
}

const SubmapSurface::Wall* NearestWall::nearest(const Eigen::Vector3d& p) const {
  std::size_t at = 0;
  if (!index(p, at) || nearest_[at] < 0) return nullptr;
  return &walls_[static_cast<std::size_t>(nearest_[at])];
}

}  // namespace prospect
