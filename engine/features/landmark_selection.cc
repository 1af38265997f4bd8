// SPDX-License-Identifier: Apache-2.0
#include "engine/features/landmark_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace prospect {
namespace {

constexpr double kFinest = 0.2;    // [m]
constexpr double kCoarsest = 1e3;  // [m]
constexpr double kWidths = 4.0;    // logistic widths beyond a limit that still count
// Range over depth in the corner of the image, for fields of view up to 96 degrees on the diagonal.
constexpr double kRangeOverDepth = 1.5;

/// Landmarks that one stands for.
struct Cluster {
  const Landmark* first = nullptr;  // lowest id
  double multiplicity = 0.0;
  double survival = 0.0;  // times multiplicity
  double per_cell = 0.0;  // likewise
};

/// Everything that can tell two landmarks apart, so that the order in the map does not matter even
/// for repeated ids.
auto key(const Landmark& l) {
  return std::make_tuple(l.id, l.position.x(), l.position.y(), l.position.z());
}

bool usable(const Landmark& l) {
  return l.position.allFinite() && l.covariance.allFinite() && l.creation_direction.allFinite() &&
         l.creation_direction.norm() > 1e-6 && std::isfinite(l.creation_range) &&
         l.creation_range > 0.0 && l.survival > 0.0 && l.survival <= 1.0 && l.multiplicity > 0.0 &&
         std::isfinite(l.multiplicity) && l.per_cell >= 0.0 && std::isfinite(l.per_cell);
}

// Whether P_range and P_view are above nothing for some camera position within `reach` of `center`.
bool can_matter(const Landmark& l, const Eigen::Vector3d& center, double reach,
                const VisibilityParameters& p) {
  const Eigen::Vector3d to_center = center - l.position;
  const double distance = to_center.norm();
  const double nearest = std::max(0.0, distance - reach);
  const double farthest = distance + reach;
  // The far limits bind the nearest position, the near ones the farthest; depth is at most the
  // range.
  const double least_depth = nearest / kRangeOverDepth;
  const double scale_near = nearest / l.creation_range;
  const double scale_far = farthest / l.creation_range;
  if (least_depth > p.r_max + kWidths * p.r_max_width ||
      farthest < p.r_min - kWidths * p.r_min_width ||
      scale_near > p.scale_max + kWidths * p.scale_width ||
      scale_far < p.scale_min - kWidths * p.scale_width) {
    return false;
  }
  // From `center` the ball is seen under asin(reach / distance): the view angle can shrink by that.
  if (distance <= reach) return true;
  const double cosine =
      to_center.dot(l.creation_direction) / (distance * l.creation_direction.norm());
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) - std::asin(reach / distance);
  return angle <= p.view_angle + kWidths * p.view_angle_width;
}

std::vector<const Landmark*> those_that_matter(const LandmarkMap& map, const Pose& pose,
                                               double reach, const VisibilityParameters& parameters,
                                               const PausePoint& pause) {
  std::vector<const Landmark*> eligible;
  eligible.reserve(map.landmarks.size());  // else it is moved as it grows, without a pause
  std::size_t seen = 0;
  for (const Landmark& l : map.landmarks) {
    if (++seen % 128 == 0) pause();
    if (usable(l) && can_matter(l, pose.position, reach, parameters)) eligible.push_back(&l);
  }
  return eligible;
}

/// Maps are in the order of ids as a rule; and of a million others nearly all are told apart by id
/// alone, which need not be looked up where they are.
std::vector<const Landmark*> sorted_by_key(std::vector<const Landmark*> landmarks,
                                           const PausePoint& pause) {
  std::size_t compared = 0;
  const auto less = [&](const Landmark* a, const Landmark* b) {
    if (++compared % 128 == 0) pause();
    return key(*a) < key(*b);
  };
  if (std::is_sorted(landmarks.begin(), landmarks.end(), less)) return landmarks;
  std::vector<std::pair<std::uint64_t, const Landmark*>> by_id;
  by_id.reserve(landmarks.size());
  for (const Landmark* l : landmarks) {
    if (by_id.size() % 128 == 0) pause();
    by_id.emplace_back(l->id, l);
  }
  std::sort(by_id.begin(), by_id.end(), [&](const auto& a, const auto& b) {
    if (a.first == b.first) return less(a.second, b.second);
    if (++compared % 128 == 0) pause();
    return a.first < b.first;
  });
  std::transform(by_id.begin(), by_id.end(), landmarks.begin(),
                 [](const auto& l) { return l.second; });
  return landmarks;
}

/// Of a lattice: address and quadrant of the direction.
using LatticeCell = std::array<std::int64_t, 4>;

struct LatticeCellHash {
  std::size_t operator()(const LatticeCell& cell) const {
    std::uint64_t h = 0;
    for (const std::int64_t v : cell) {
      h = (h ^ static_cast<std::uint64_t>(v)) * 0x9E3779B97F4A7C15U;
      h ^= h >> 32;
    }
    return h;
  }
};

LatticeCell cell_of(const Landmark& l, double size) {
  const auto at = [&](int a) {
    return static_cast<std::int64_t>(std::floor(l.position[a] / size));
  };
  const Eigen::Vector3d& d = l.creation_direction;
  return {at(0), at(1), at(2), 2 * (d.x() > 0.0) + (d.y() > 0.0)};
}

/// `landmarks`, by key, as clusters of a lattice, by the key of their first. Of more than `most`
/// the first ones if `leave_out`, else none at all.
std::optional<std::vector<Cluster>> clusters(const std::vector<const Landmark*>& landmarks,
                                             double size, std::size_t most, bool leave_out,
                                             const PausePoint& pause) {
  std::unordered_map<LatticeCell, std::size_t, LatticeCellHash> cells;
  cells.reserve(most);
  std::vector<Cluster> result;
  std::size_t taken = 0;
  for (const Landmark* l : landmarks) {
    if (++taken % 64 == 0) pause();
    const LatticeCell cell = cell_of(*l, size);
    auto at = cells.find(cell);
    if (at == cells.end()) {
      if (result.size() == most && !leave_out) return std::nullopt;
      if (result.size() == most) continue;
      at = cells.emplace(cell, result.size()).first;
      result.push_back({l});
    }
    Cluster& c = result[at->second];
    c.multiplicity += l->multiplicity;
    c.survival += l->multiplicity * l->survival;
    c.per_cell += l->multiplicity * l->per_cell;
  }
  return result;
}

}  // namespace

std::vector<Landmark> select_landmarks(const LandmarkMap& map, const Pose& pose, double reach,
                                       int max_count, const VisibilityParameters& parameters,
                                       const PausePoint& pause) {
  const std::vector<const Landmark*> eligible =
      sorted_by_key(those_that_matter(map, pose, reach, parameters, pause), pause);
  std::vector<Landmark> result;
  const auto most = static_cast<std::size_t>(std::max(0, max_count));
  if (eligible.size() <= most) {
    for (const Landmark* l : eligible) result.push_back(*l);
  } else {
    std::optional<std::vector<Cluster>> chosen;
    for (double size = kFinest; !chosen && size <= kCoarsest; size *= std::numbers::sqrt2) {
      chosen = clusters(eligible, size, most, false, pause);
    }
    if (!chosen) chosen = clusters(eligible, kCoarsest, most, true, pause);
    for (const Cluster& c : *chosen) {
      result.push_back(*c.first);
      result.back().multiplicity = std::min(kMostMultiplicity, c.multiplicity);
      result.back().survival = std::min(1.0, c.survival / c.multiplicity);
      result.back().per_cell = c.per_cell / c.multiplicity;
    }
  }
  std::vector<std::pair<double, std::size_t>> by_azimuth;  // and by key, as they are now
  for (const Landmark& l : result) {
    if (by_azimuth.size() % 256 == 0) pause();
    const Eigen::Vector3d to = l.position - pose.position;
    by_azimuth.emplace_back(std::atan2(to.y(), to.x()), by_azimuth.size());
  }
  std::sort(by_azimuth.begin(), by_azimuth.end());
  std::vector<Landmark> ordered;
  ordered.reserve(result.size());
  for (const auto& [azimuth, n] : by_azimuth) ordered.push_back(result[n]);
  return ordered;
}

}  // namespace prospect
