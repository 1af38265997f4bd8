#include "engine/features/landmark_selection.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>
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
  double angle = 0.0;
  if (distance > reach) {
    const double cosine =
        to_center.dot(l.creation_direction) / (distance * l.creation_direction.norm());
    angle = std::acos(std::clamp(cosine, -1.0, 1.0)) - std::asin(reach / distance);
    angle = std::max(0.0, angle);
  }
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

using CellKey = std::tuple<std::int64_t, std::int64_t, std::int64_t, int>;

CellKey cell_of(const Landmark& l, double size) {
  const auto at = [&](int a) {
    return static_cast<std::int64_t>(std::floor(l.position[a] / size));
  };
  const Eigen::Vector3d& d = l.creation_direction;
  return {at(0), at(1), at(2), 2 * (d.x() > 0.0) + (d.y() > 0.0)};
}

/// `landmarks`, by key, as clusters of a lattice; given up as soon as there are more than `most`.
std::vector<Cluster> clusters(const std::vector<const Landmark*>& landmarks, double size,
                              std::size_t most, const PausePoint& pause) {
  std::map<CellKey, Cluster> cells;
  std::size_t taken = 0;
  for (const Landmark* l : landmarks) {
    if (++taken % 64 == 0) pause();
    Cluster& c = cells[cell_of(*l, size)];
    if (!c.first) c.first = l;
    c.multiplicity += l->multiplicity;
    c.survival += l->multiplicity * l->survival;
    c.per_cell += l->multiplicity * l->per_cell;
    if (cells.size() > most) break;
  }
  std::vector<Cluster> result;
  result.reserve(cells.size());
  for (const auto& [cell, cluster] : cells) result.push_back(cluster);
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
    std::vector<Cluster> chosen;
    for (double size = kFinest; size <= kCoarsest; size *= std::numbers::sqrt2) {
      chosen = clusters(eligible, size, most, pause);
      if (chosen.size() <= most) break;
    }
    if (chosen.size() > most) chosen = clusters(eligible, kCoarsest, eligible.size(), pause);
    std::sort(chosen.begin(), chosen.end(),
              [](const Cluster& a, const Cluster& b) { return key(*a.first) < key(*b.first); });
    if (chosen.size() > most) chosen.resize(most);
    for (const Cluster& c : chosen) {
      result.push_back(*c.first);
      result.back().multiplicity = std::min(kMostMultiplicity, c.multiplicity);
      result.back().survival = std::min(1.0, c.survival / c.multiplicity);
      result.back().per_cell = c.per_cell / c.multiplicity;
    }
  }
  const auto azimuth = [&](const Landmark& l) {
    return std::atan2(l.position.y() - pose.position.y(), l.position.x() - pose.position.x());
  };
  std::stable_sort(result.begin(), result.end(), [&](const Landmark& a, const Landmark& b) {
    return azimuth(a) < azimuth(b);  // by key before
  });
  return result;
}

}  // namespace prospect
