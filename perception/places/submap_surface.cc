// SPDX-License-Identifier: Apache-2.0
#include "perception/places/submap_surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace prospect {
namespace {

constexpr int kEdge = MapEvidence::kEdge;
constexpr double kAlike = 0.8;  // cosine between walls that face alike

bool is_free(const MapEvidence& evidence, const Eigen::Vector3d& p, double r,
             const EvidenceTable& table) {
  const EvidenceTable::State s = evidence.state(static_cast<int>(std::floor(p.x() / r)),
                                                static_cast<int>(std::floor(p.y() / r)),
                                                static_cast<int>(std::floor(p.z() / r)));
  return s != EvidenceTable::kNothing && !table.is_surface(s);
}

/// To the side of it that is free nearer to it.
SubmapSurface::Wall facing(const MapEvidence& evidence, const Eigen::Vector3d& p,
                           const Eigen::Vector2d& normal, double r, const EvidenceTable& table) {
  const Eigen::Vector3d n(normal.x(), normal.y(), 0.0);
  for (double off = r; off < SubmapSurface::kAround + 0.5 * r; off += r) {
    const bool there = is_free(evidence, p + off * n, r, table),
               here = is_free(evidence, p - off * n, r, table);
    if (there != here) return {p, there ? normal : Eigen::Vector2d(-normal), false};
    if (there) break;
  }
  return {p, normal, true};
}

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
  const auto layer = [r](const Eigen::Vector3d& p) { return std::floor(p.z() / r); };
  const bool one_layer = std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
    return layer(p) == layer(points.front());
  });
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
      Eigen::Matrix3d spread = square / count - mean * mean.transpose();
      if (one_layer) spread(2, 2) += kAround * kAround;  // whatever is above and below
      eigen.computeDirect(spread);
      const Eigen::Vector3d normal = eigen.eigenvectors().col(0);
      if (std::abs(normal.z()) > kUpright) continue;
      if (eigen.eigenvalues()[0] > kFlat * eigen.eigenvalues()[1]) continue;
      walls_.push_back(facing(evidence, p, normal.head<2>().normalized(), r, table));
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
  std::vector<float> least[kSectors];
  const int around = static_cast<int>(std::ceil(reach / r));
  const auto offer = [&](std::size_t n, int sector) {
    std::vector<float>& distance = least[sector];
    std::vector<std::int32_t>& nearest = nearest_[sector];
    if (nearest.empty()) {
      nearest.assign(volume, -1);
      distance.assign(volume, static_cast<float>(reach * reach));
    }
    const Eigen::Vector3d& p = walls_[n].at;
    const int i = static_cast<int>(std::floor(p.x() / r)),
              j = static_cast<int>(std::floor(p.y() / r)),
              k = static_cast<int>(std::floor(p.z() / r));
    if (k < low_[2] || k >= high[2]) return;
    for (int y = std::max(j - around, low_[1]); y <= std::min(j + around, high[1] - 1); ++y) {
      for (int x = std::max(i - around, low_[0]); x <= std::min(i + around, high[0] - 1); ++x) {
        const double dx = (x + 0.5) * r - p.x(), dy = (y + 0.5) * r - p.y();
        const float squared = static_cast<float>(dx * dx + dy * dy);
        const std::size_t v = at(x, y, k);
        if (squared >= distance[v]) continue;
        distance[v] = squared;
        nearest[v] = static_cast<std::int32_t>(n);
      }
    }
  };
  for (std::size_t n = 0; n < walls_.size(); ++n) {
    offer(n, sector(walls_[n].normal));
    if (walls_[n].either) offer(n, sector(-walls_[n].normal));
  }
}

int NearestWall::sector(const Eigen::Vector2d& normal) {
  const double turn = std::atan2(normal.y(), normal.x()) / (2.0 * M_PI);
  return static_cast<int>(std::lround(turn * kSectors) + kSectors) % kSectors;
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

const SubmapSurface::Wall* NearestWall::nearest(const Eigen::Vector3d& p,
                                                const Eigen::Vector2d& normal, bool either) const {
  std::size_t at = 0;
  if (!index(p, at)) return nullptr;
  const SubmapSurface::Wall* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  const int middle = sector(normal);
  for (const int opposite : {0, kSectors / 2}) {
    if (opposite != 0 && !either) break;
    for (int by = -1; by <= 1; ++by) {
      const std::vector<std::int32_t>& nearest =
          nearest_[(middle + opposite + by + kSectors) % kSectors];
      if (nearest.empty() || nearest[at] < 0) continue;
      const SubmapSurface::Wall& wall = walls_[static_cast<std::size_t>(nearest[at])];
      const double squared = (wall.at - p).head<2>().squaredNorm();
      if (squared >= least || std::abs(wall.normal.dot(normal)) < kAlike) continue;
      least = squared;
      best = &wall;
    }
  }
  return best;
}

}  // namespace prospect
