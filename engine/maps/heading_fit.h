// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "models/robot_shape.h"

namespace prospect {

/// A set of headings: bit k stands for 2 pi k / kHeadings [rad], counted from W's x axis. Half a
/// step, 2.8 degrees, is what a body must turn away from its best heading at most: it takes 5 cm of
/// room from a body of 2 m in a corridor.
using HeadingMask = std::uint64_t;
inline constexpr int kHeadings = 64;
inline constexpr HeadingMask kNoHeading = 0;
inline constexpr HeadingMask kAllHeadings = ~HeadingMask{0};

/// [rad], 0 to 2 pi.
double heading_at(int k);
/// The heading nearest to a finite yaw [rad].
int nearest_heading(double yaw);

/// Signed distance [m] between a body's ground outline at a pose in the plane and the square
/// [low, low + side] x [low, low + side] of W: to the nearest point of the square, or minus the
/// path by which the deepest part must move until it only touches it. Exact for each part, polygon
/// or disc.
double outline_distance(const std::vector<OutlinePart>& outline, const Eigen::Vector2d& position,
                        double yaw, const Eigen::Vector2d& low, double side);

/// At which headings a body that stands on the centre of a cell has room, by what is occupied
/// around it.
///
///   bars(d) = { k : outline_distance(body at heading k on a cell's centre, square of the cell
///               offset by d) < room }
///   fits(c) = not union of bars(o - c) over the occupied cells o
///
/// room [m] is kept all round; negative, the body may overlap squares by as much. A disc of radius
/// R gives back the rule of radii: all headings where the distance from the centre of c to every
/// occupied square is at least R + room, else none.
///
/// Thread-safety: immutable. Cost: some milliseconds to make; a cell costs one step an entry.
class HeadingFit {
 public:
  struct Entry {
    int di, dj;        // offset of the occupied cell
    HeadingMask bars;  // not empty
  };

  /// resolution > 0 [m]. Throws as validate(shape), and std::invalid_argument for other numbers
  /// that are not finite.
  HeadingFit(const RobotShape& shape, double room, double resolution);

  /// All offsets that bar some heading, in scan order.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Offsets of entries are within this many cells along either axis.
  int reach() const { return reach_; }

 private:
  std::vector<Entry> entries_;
  int reach_ = 0;
};

}  // namespace prospect
