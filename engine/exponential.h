#pragma once

#include <bit>
#include <cstdint>

namespace prospect {

/// e^x for |x| <= 700, relative error below 4e-16 (2 units in the last place). Straight-line
/// arithmetic without branches or tables, so that a compiler turns a loop over it into vector code
/// at any width; the same bits on every machine. Beyond 700 in magnitude the result is meaningless
/// (clamp first); NaN in gives a non-finite or meaningless number.
///
///   e^x = 2^n e^r,   n = round(x / ln 2),   |r| <= ln(2)/2,   e^r by its Taylor polynomial to
///   r^13.
inline double exponential(double x) {
  constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
  constexpr double kLog2E = 1.4426950408889634;
  constexpr double kLn2High = 6.93147180369123816490e-01;  // 33 bits: n * kLn2High is exact
  constexpr double kLn2Low = 1.90821492927058770002e-10;
  const double shifted = x * kLog2E + kShift;
  const double n = shifted - kShift;
  const double r = (x - n * kLn2High) - n * kLn2Low;
  const double r2 = r * r, r4 = r2 * r2, r8 = r4 * r4;
  const double c0 = 1.0 / 2.0 + r * (1.0 / 6.0);
  const double c1 = 1.0 / 24.0 + r * (1.0 / 120.0);
  const double c2 = 1.0 / 720.0 + r * (1.0 / 5040.0);
  const double c3 = 1.0 / 40320.0 + r * (1.0 / 362880.0);
  const double c4 = 1.0 / 3628800.0 + r * (1.0 / 39916800.0);
  const double c5 = 1.0 / 479001600.0 + r * (1.0 / 6227020800.0);
  const double tail = (c0 + r2 * c1) + r4 * (c2 + r2 * c3) + r8 * (c4 + r2 * c5);
  const double power = 1.0 + (r + r2 * tail);
  // The low bits of `shifted` are n; they become the exponent.
  const std::uint64_t bits =
      (std::bit_cast<std::uint64_t>(shifted) << 52) + (std::uint64_t{1023} << 52);
  return power * std::bit_cast<double>(bits);
}

}  // namespace prospect
