// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/map_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "engine/maps/grid.h"

namespace prospect {
namespace {

constexpr int kEdge = MapEvidence::kEdge;

int brick_of(int address) { return floor_divide(address, kEdge); }

/// The hit of a voxel, made if there is none.
MapEvidence::Hit& hit_of(MapEvidence::Brick& brick, int voxel) {
  const auto at = std::lower_bound(
      brick.hits.begin(), brick.hits.end(), voxel,
      [](const MapEvidence::Hit& h, int v) { return static_cast<int>(h.voxel) < v; });
  if (at != brick.hits.end() && at->voxel == voxel) return *at;
  return *brick.hits.insert(at, {static_cast<std::uint16_t>(voxel)});
}

/// The mean of two sets of points; of very many the newest go on counting.
void merge(MapEvidence::Hit& hit, const Eigen::Vector3f& mean, float spread, int count) {
  constexpr int kMost = 1000;
  const int before = std::min<int>(hit.count, kMost);
  const int all = before + count;
  const float share = static_cast<float>(count) / static_cast<float>(all);
  const float higher = mean.z() - hit.mean.z();
  hit.spread += share * (spread - hit.spread + (1.0F - share) * higher * higher);
  hit.mean += share * (mean - hit.mean);
  hit.count = static_cast<std::uint16_t>(std::min(all, kMost));
}

}  // namespace

std::size_t MapEvidence::bytes() const {
  constexpr std::size_t kNode = 64;  // of the map
  std::size_t sum = sizeof *this;
  for (const auto& [at, brick] : bricks_) {
    sum += kNode + sizeof at + sizeof brick + brick.hits.capacity() * sizeof(Hit);
  }
  return sum;
}

MapEvidence::State MapEvidence::state(int i, int j, int k) const {
  const Address at{brick_of(i), brick_of(j), brick_of(k)};
  const auto found = bricks_.find(at);
  if (found == bricks_.end()) return EvidenceTable::kNothing;
  return found->second.states[static_cast<std::size_t>(
      voxel(i - at[0] * kEdge, j - at[1] * kEdge, k - at[2] * kEdge))];
}

void MapEvidence::add_hit(const Eigen::Vector3d& point, int i, int j, int k) {
  const Address at{brick_of(i), brick_of(j), brick_of(k)};
  const Eigen::Vector3d corner(at[0] * kEdge, at[1] * kEdge, at[2] * kEdge);
  const int v = voxel(i - at[0] * kEdge, j - at[1] * kEdge, k - at[2] * kEdge);
  merge(hit_of(bricks_[at], v), (point - corner).cast<float>(), 0.0F, 1);
}

MapEvidence MapEvidence::moved(const PlanarMove& move, double r, const EvidenceTable& table) const {
  if (move.is_none()) return *this;
  MapEvidence to;
  const PlanarMove back = move.inverse();
  // Bricks that hold a middle which comes to lie in one of these.
  std::set<Address> reached;
  for (const auto& [at, brick] : bricks_) {
    double low[2] = {std::numeric_limits<double>::infinity(),
                     std::numeric_limits<double>::infinity()};
    double high[2] = {-low[0], -low[1]};
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector2d p = move(
          Eigen::Vector2d((at[0] + (corner & 1)) * kEdge * r, (at[1] + (corner >> 1)) * kEdge * r));
      for (int a = 0; a < 2; ++a) {
        low[a] = std::min(low[a], p[a]);
        high[a] = std::max(high[a], p[a]);
      }
    }
    const double edge = kEdge * r;
    for (int x = static_cast<int>(std::floor(low[0] / edge)); x * edge < high[0]; ++x) {
      for (int y = static_cast<int>(std::floor(low[1] / edge)); y * edge < high[1]; ++y) {
        reached.insert({x, y, at[2]});
      }
    }
  }
  auto source = bricks_.end();  // found last
  for (const Address& at : reached) {
    Brick* made = nullptr;
    for (int x = 0; x < kEdge; ++x) {
      for (int y = 0; y < kEdge; ++y) {
        const Eigen::Vector2d from =
            back(Eigen::Vector2d((at[0] * kEdge + x + 0.5) * r, (at[1] * kEdge + y + 0.5) * r));
        const int i = static_cast<int>(std::floor(from.x() / r)),
                  j = static_cast<int>(std::floor(from.y() / r));
        const Address there{brick_of(i), brick_of(j), at[2]};
        if (source == bricks_.end() || source->first != there) source = bricks_.find(there);
        if (source == bricks_.end()) continue;
        const int column = voxel(i - kEdge * source->first[0], j - kEdge * source->first[1], 0);
        for (int z = 0; z < kEdge; ++z) {
          const State s = source->second.states[static_cast<std::size_t>(column + z)];
          if (s == EvidenceTable::kNothing || table.is_surface(s)) continue;
          if (made == nullptr) made = &to.bricks_[at];
          made->states[static_cast<std::size_t>(voxel(x, y, z))] = s;
        }
      }
    }
  }
  for (const auto& [at, brick] : bricks_) {
    for (const Hit& hit : brick.hits) {
      const State s = brick.states[hit.voxel];
      if (!table.is_surface(s)) continue;
      const Eigen::Vector3d corner(at[0] * kEdge, at[1] * kEdge, at[2] * kEdge);
      const Eigen::Vector3d p = move(Eigen::Vector3d(r * (corner + hit.mean.cast<double>()))) / r;
      const int k = kEdge * at[2] + hit.voxel % kEdge;
      const int i = static_cast<int>(std::floor(p.x())), j = static_cast<int>(std::floor(p.y()));
      const Address there{brick_of(i), brick_of(j), at[2]};
      Brick& b = to.bricks_[there];
      const int v = voxel(i - kEdge * there[0], j - kEdge * there[1], k - kEdge * there[2]);
      State& now = b.states[static_cast<std::size_t>(v)];
      // Of two surfaces in a voxel, what is surest.
      const bool first = !table.is_surface(now);
      if (first || table.of_unknown(s) > table.of_unknown(now)) now = s;
      const Eigen::Vector3d corner_there(there[0] * kEdge, there[1] * kEdge, there[2] * kEdge);
      merge(hit_of(b, v), (p - corner_there).cast<float>(), hit.spread, hit.count);
    }
  }
  return to;
}

MapEvidence MapEvidence::around(const Eigen::Vector2d& place, double reach, double r) const {
  MapEvidence part;
  const Eigen::Vector2d low = (place.array() - reach) / (kEdge * r),
                        high = (place.array() + reach) / (kEdge * r);
  for (const auto& [at, brick] : bricks_) {
    if (at[0] + 1 < low.x() || at[1] + 1 < low.y() || at[0] > high.x() || at[1] > high.y())
      continue;
    part.bricks_.emplace_hint(part.bricks_.end(), at, brick);
  }
  return part;
}

void MapEvidence::append(const MapEvidence& later, EvidenceTable& table) {
  for (const auto& [at, more] : later.bricks_) {
    Brick& brick = bricks_[at];
    for (std::size_t v = 0; v < kVoxels; ++v) {
      if (more.states[v] != EvidenceTable::kNothing) {
        brick.states[v] = table.sequence(brick.states[v], more.states[v]);
      }
    }
    for (const Hit& hit : more.hits)
      merge(hit_of(brick, hit.voxel), hit.mean, hit.spread, hit.count);
  }
}

std::vector<Eigen::Vector3d> MapEvidence::surface(double r, const EvidenceTable& table) const {
  std::vector<Eigen::Vector3d> points;
  for (const auto& [at, brick] : bricks_) {
    const Eigen::Vector3d corner(at[0] * kEdge, at[1] * kEdge, at[2] * kEdge);
    for (const Hit& hit : brick.hits) {
      if (!table.is_surface(brick.states[hit.voxel])) continue;
      points.push_back(r * (corner + hit.mean.cast<double>()));
    }
  }
  return points;
}

}  // namespace prospect
