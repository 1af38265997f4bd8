// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace prospect {

/// The change of each variable that counts as one [-], for what has to say whether a cost, a
/// constraint or a step is large:
///
///   s_i = min(upper_i - lower_i, 2 max(1, |x_i|))
///
/// the width of its bounds, as long as these say something of it: bounds that are there only so
/// that there are some are far wider than that. All arguments are of one size and finite.
Eigen::VectorXd typical_change(const Eigen::VectorXd& x, const Eigen::VectorXd& lower,
                               const Eigen::VectorXd& upper);

/// Units of a constraint, what a typical change of the variables changes it by, in which it is
/// taken as it is: the tolerances of back ends are absolute below 1. [-]
inline constexpr double kSmallestUnit = 0x1p-7;
inline constexpr double kLargestUnit = 0x1p10;

/// Whether such a unit is plain. So is that of what does not change at all, of which nothing is
/// known.
inline bool is_plain_unit(double unit) {
  return unit == 0.0 || (unit >= kSmallestUnit && unit <= kLargestUnit);
}

/// Whether a cost f is taken as it is that a typical change of the variables changes by `unit`: by
/// no more than kLargestUnit, and by no less than a 64th of max(1, |f|), to which tolerances are
/// relative: an absolute value is right near zero and a relative one far from it, but neither an
/// offset nor a small unit may make a difference vanish.
bool is_plain_cost(double cost, double unit);

/// What a tolerance of 1 stands for in a cost: max(1, |f|), at most 16 units; of one that is too
/// small to be plain one unit.
double size_of_cost(double cost, double unit);

}  // namespace prospect
