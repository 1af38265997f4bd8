// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace prospect {

/// Something that moves by itself, such as a person: an upright cylinder on the floor, in W. It
/// keeps its velocity for all that is known, and what is not known of it grows: t seconds after its
/// stamp it is somewhere within
///   reach(t) = radius + min(spread t, kMostSpread)   of   at(t) = position + t velocity.
struct Mover {
  static constexpr double kMostSpread = 0.5;  ///< [m]

  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< [m/s]; zero: it stands
  double radius = 0.0;                                 ///< [m] >= 0
  double spread = 0.0;                                 ///< [m/s] >= 0

  Eigen::Vector2d at(double t) const { return position + t * velocity; }
  double reach(double t) const { return radius + std::min(spread * t, kMostSpread); }
  /// What is predicted t seconds on, as seen from then.
  Mover after(double t) const { return {at(t), velocity, reach(t), spread}; }

  /// Whether all numbers are finite and no length is below zero.
  bool sound() const {
    return position.allFinite() && velocity.allFinite() && radius >= 0.0 && spread >= 0.0 &&
           radius < 1e6 && spread < 1e6;
  }
};

/// Those that are known at one time.
struct Movers {
  double stamp = 0.0;  ///< [s], in the clock of Belief::stamp
  std::vector<Mover> all;
};

/// All as predicted for `stamp` [s], or as they are if that lies before theirs. null: none.
inline std::vector<Mover> predicted(const Movers* known, double stamp) {
  if (known == nullptr) return {};
  const double since = std::max(0.0, stamp - known->stamp);
  std::vector<Mover> all;
  all.reserve(known->all.size());
  for (const Mover& mover : known->all) all.push_back(mover.after(since));
  return all;
}

}  // namespace prospect
