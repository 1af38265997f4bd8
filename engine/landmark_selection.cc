#include "engine/landmark_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

namespace prospect {
namespace {

constexpr int kSectors = 32;
constexpr double kWidths = 4.0;  // logistic widths beyond a limit that still count
// Range over depth in the corner of the image, for fields of view up to 96 degrees on the diagonal.
constexpr double kRangeOverDepth = 1.5;

double logistic(double x) { return 1.0 / (1.0 + std::exp(-x)); }

struct Eligible {
  const Landmark* landmark;
  double azimuth;
  double bound;
  std::size_t sector;
};

bool usable(const Landmark& l) {
  return l.position.allFinite() && l.covariance.allFinite() && l.creation_direction.allFinite() &&
         l.creation_direction.norm() > 1e-6 && std::isfinite(l.creation_range) &&
         l.creation_range > 0.0 && l.survival > 0.0 && l.survival <= 1.0 && l.multiplicity > 0.0 &&
         std::isfinite(l.multiplicity);
}

// The largest survival * P_range * P_view over camera positions within `reach` of `center`, each
// factor bounded on its own; 0 if the landmark cannot matter.
double visibility_bound(const Landmark& l, const Eigen::Vector3d& center, double reach,
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
    return 0.0;
  }
  // From `center` the ball is seen under asin(reach / distance): the view angle can shrink by that.
  double angle = 0.0;
  if (distance > reach) {
    const double cosine =
        to_center.dot(l.creation_direction) / (distance * l.creation_direction.norm());
    angle = std::acos(std::clamp(cosine, -1.0, 1.0)) - std::asin(reach / distance);
    angle = std::max(0.0, angle);
  }
  if (angle > p.view_angle + kWidths * p.view_angle_width) return 0.0;
  return l.survival * logistic((p.r_max - least_depth) / p.r_max_width) *
         logistic((p.scale_max - scale_near) / p.scale_width) *
         logistic((scale_far - p.scale_min) / p.scale_width) *
         logistic((p.view_angle - angle) / p.view_angle_width);
}

}  // namespace

std::vector<Landmark> select_landmarks(const LandmarkMap& map, const Pose& pose, double reach,
                                       int max_count, const VisibilityParameters& parameters) {
  std::array<std::vector<Eligible>, kSectors> sectors;
  std::size_t total = 0;
  for (const Landmark& l : map.landmarks) {
    if (!usable(l)) continue;
    const double bound = visibility_bound(l, pose.position, reach, parameters);
    if (!(bound > 0.0)) continue;
    const double azimuth =
        std::atan2(l.position.y() - pose.position.y(), l.position.x() - pose.position.x());
    const double turn = azimuth / (2.0 * std::numbers::pi) + 0.5;
    const auto sector =
        static_cast<std::size_t>(std::clamp(static_cast<int>(turn * kSectors), 0, kSectors - 1));
    sectors[sector].push_back({&l, azimuth, bound, sector});
    ++total;
  }
  // Ties are broken by everything that can tell two landmarks apart, so that the order in the map
  // does not matter even for repeated ids.
  const auto key = [](const Eligible& c) {
    const Eigen::Vector3d& p = c.landmark->position;
    return std::make_tuple(c.landmark->id, p.x(), p.y(), p.z());
  };
  for (auto& sector : sectors) {
    std::sort(sector.begin(), sector.end(), [&](const Eligible& a, const Eligible& b) {
      return a.bound != b.bound ? a.bound > b.bound : key(a) < key(b);
    });
  }
  std::vector<Eligible> chosen;
  const std::size_t wanted = std::min(total, static_cast<std::size_t>(std::max(0, max_count)));
  std::array<std::size_t, kSectors> taken{};
  for (std::size_t rank = 0; chosen.size() < wanted; ++rank) {
    for (std::size_t s = 0; s < kSectors; ++s) {
      if (rank >= sectors[s].size() || chosen.size() >= wanted) continue;
      chosen.push_back(sectors[s][rank]);
      taken[s] = rank + 1;
    }
  }
  std::array<double, kSectors> stands_for{};
  for (std::size_t s = 0; s < kSectors; ++s) {
    double all = 0.0, of_chosen = 0.0;
    for (std::size_t rank = 0; rank < sectors[s].size(); ++rank) {
      const double mass = sectors[s][rank].bound * sectors[s][rank].landmark->multiplicity;
      all += mass;
      if (rank < taken[s]) of_chosen += mass;
    }
    stands_for[s] = of_chosen > 0.0 ? all / of_chosen : 1.0;
  }
  std::sort(chosen.begin(), chosen.end(), [&](const Eligible& a, const Eligible& b) {
    return a.azimuth != b.azimuth ? a.azimuth < b.azimuth : key(a) < key(b);
  });
  std::vector<Landmark> result;
  result.reserve(chosen.size());
  for (const Eligible& c : chosen) {
    result.push_back(*c.landmark);
    result.back().multiplicity *= stands_for[c.sector];
  }
  return result;
}

}  // namespace prospect
