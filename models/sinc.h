// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace prospect {

/// Half-width of the interval around zero where the series is used, [rad]. Inside, the truncated
/// series below are exact to rounding; outside, the direct formulas lose at most a few ulp.
inline constexpr double kSincSeriesRadius = 0.5;

/// sinc(x) = sin(x)/x, sinc(0) = 1; x [rad]. Smooth through zero.
inline double sinc(double x) {
  if (std::abs(x) >= kSincSeriesRadius) return std::sin(x) / x;
  const double z = x * x;  // sum (-z)^n / (2n+1)!, n = 0..7
  return 1.0 -
         z / 6.0 *
             (1.0 - z / 20.0 *
                        (1.0 - z / 42.0 *
                                   (1.0 - z / 72.0 *
                                              (1.0 - z / 110.0 *
                                                         (1.0 - z / 156.0 * (1.0 - z / 210.0))))));
}

/// sinc'(x) = (x cos(x) - sin(x))/x^2, sinc'(0) = 0. The direct formula cancels like eps/x^2 near
/// zero, hence the series there.
inline double sinc_derivative(double x) {
  if (std::abs(x) >= kSincSeriesRadius) return (x * std::cos(x) - std::sin(x)) / (x * x);
  const double z = x * x;  // sum (-1)^n 2n x^(2n-1) / (2n+1)!, n = 1..8
  return -x / 3.0 *
         (1.0 -
          z / 10.0 *
              (1.0 -
               z / 28.0 *
                   (1.0 -
                    z / 54.0 *
                        (1.0 -
                         z / 88.0 * (1.0 - z / 130.0 * (1.0 - z / 180.0 * (1.0 - z / 238.0)))))));
}

}  // namespace prospect
