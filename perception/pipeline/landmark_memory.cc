// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/landmark_memory.h"

#include <algorithm>
#include <unordered_set>
#include <utility>
#include <vector>

#include "engine/features/landmarks_per_cell.h"
#include "perception/odometry/lattice_cell.h"

namespace prospect {
namespace {

constexpr double kCell = 0.25;  // [m]

std::uint64_t cell_of(const Landmark& l) { return lattice_cell(l.position, kCell); }

}  // namespace

void LandmarkMemory::add(const LandmarkMap& now) {
  ++time_;
  for (const Landmark& l : now.landmarks) {
    if (l.position.allFinite()) cells_[cell_of(l)] = {l, time_};
  }
  if (cells_.size() <= most_) return;
  // A tenth more than needed, so that this is rare.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> order;  // when, cell
  order.reserve(cells_.size());
  for (const auto& [cell, seen] : cells_) order.emplace_back(seen.when, cell);
  std::sort(order.begin(), order.end());
  const std::size_t keep = most_ - most_ / 10;
  for (std::size_t i = 0; i + keep < order.size(); ++i) cells_.erase(order[i].second);
}

void LandmarkMemory::follow(const PlaceMoves& moves) {
  std::vector<Seen> all;
  all.reserve(cells_.size());
  for (const auto& [cell, seen] : cells_) all.push_back(seen);
  std::sort(all.begin(), all.end(), [](const Seen& a, const Seen& b) {
    return std::pair(a.when, a.landmark.id) < std::pair(b.when, b.landmark.id);
  });
  cells_.clear();
  for (Seen& seen : all) {
    const PlanarMove move = moves.of_before(seen.landmark.position.head<2>());
    seen.landmark.position = move(seen.landmark.position);
    const Eigen::AngleAxisd turn(move.yaw, Eigen::Vector3d::UnitZ());
    const Eigen::Matrix3d R = turn.toRotationMatrix();
    seen.landmark.creation_direction = R * seen.landmark.creation_direction.eval();
    seen.landmark.covariance = R * seen.landmark.covariance.eval() * R.transpose();
    cells_[cell_of(seen.landmark)] = seen;  // of two in a cell, the newer one
  }
}

std::shared_ptr<const LandmarkMap> LandmarkMemory::with_remembered(const LandmarkMap& now) const {
  auto map = std::make_shared<LandmarkMap>(now);
  std::unordered_set<std::uint64_t> held, ids;
  for (const Landmark& l : now.landmarks) {
    held.insert(cell_of(l));
    ids.insert(l.id);
  }
  std::vector<std::pair<std::uint64_t, const Landmark*>> remembered;
  for (const auto& [cell, seen] : cells_) {
    if (held.count(cell) || ids.count(seen.landmark.id)) continue;
    remembered.emplace_back(cell, &seen.landmark);
  }
  std::sort(remembered.begin(), remembered.end());  // by cell: no two are the same
  for (const auto& [cell, landmark] : remembered) map->landmarks.push_back(*landmark);
  note_landmarks_per_cell(*map);
  return map;
}

}  // namespace prospect
