// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

namespace prospect {

/// Exponential and normal distribution as straight-line code: no branches, no tables, no calls, so
/// that loops over them vectorise, and IEEE additions, multiplications and divisions only, so that
/// every vector width gives the same bits (as long as the compiler may not contract a * b + c, see
/// cmake/Room.cmake).
///
/// Errors, for all finite arguments unless said otherwise (checked against long double):
///                         double                       float
///   exponential           6e-16 relative               2e-7 relative
///   normal_density        1e-14 relative, |x| <= 12    2e-6 relative, |x| <= 5
///   normal_cdf            4e-16 absolute               2e-7 absolute
///   normal_cdf, x < 0     3e-14 relative, x > -3       2e-6 relative, x > -5
///                         4e-6 relative, x > -37       1e-5 relative, x > -12
/// The density's relative error grows as x^2 times the machine precision, from rounding x^2 / 2.
/// Out of range arguments are clamped: the exponential beyond +-708 (double), +-87 (float), the
/// normal distribution beyond |x| = 37.5 (double), 13 (float), where it is below 1e-300 (1e-38).
///
/// Source: exponential, reduction by ln 2 and a polynomial interpolating at Chebyshev nodes; normal
/// distribution, Hart et al., Computer Approximations, 5666, in the form of West, "Better
/// approximations to cumulative normal functions", Wilmott (2005). Its rational part, made for
/// |x| < 7, tends to 0.39894228 / x, the asymptote of Mills' ratio, so it serves for all x.
namespace normal_distribution_detail {

template <typename T>
struct Format;

template <>
struct Format<double> {
  using Bits = std::uint64_t;
  static constexpr double kRound = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to integers
  static constexpr int kMantissa = 52;
  static constexpr Bits kBias = 1023;
  static constexpr double kLn2High = 6.93147180369123816490e-01;  // few bits: n * high is exact
  static constexpr double kLn2Low = 1.90821492927058770002e-10;
  static constexpr double kExponentLimit = 708.0;
  static constexpr double kNormalLimit = 37.5;

  // exp(r), |r| <= ln 2 / 2.
  [[gnu::always_inline]] static inline double reduced(double r) {
    double p = 2.7626371065696354e-07;
    p = p * r + 2.764019739169484e-06;
    p = p * r + 2.480150431378554e-05;
    p = p * r + 0.00019841170230570286;
    p = p * r + 0.001388888893251478;
    p = p * r + 0.008333333385699212;
    p = p * r + 0.041666666666573066;
    p = p * r + 0.16666666666554314;
    p = p * r + 0.5000000000000006;
    p = p * r + 1.0000000000000067;
    p = p * r + 1.0;
    return p;
  }
};

template <>
struct Format<float> {
  using Bits = std::uint32_t;
  static constexpr float kRound = 12582912.0f;  // 1.5 * 2^23
  static constexpr int kMantissa = 23;
  static constexpr Bits kBias = 127;
  static constexpr float kLn2High = 0.693359375f;
  static constexpr float kLn2Low = -2.12194440e-4f;
  static constexpr float kExponentLimit = 87.0f;
  static constexpr float kNormalLimit = 13.0f;

  [[gnu::always_inline]] static inline float reduced(float r) {
    float p = 0.00139411189f;
    p = p * r + 0.00837513477f;
    p = p * r + 0.0416663528f;
    p = p * r + 0.166664154f;
    p = p * r + 0.500000005f;
    p = p * r + 1.00000004f;
    p = p * r + 1.0f;
    return p;
  }
};

// d < 0 ? a : b, by the sign bit of d (so -0 counts as negative). Written with ?:, compilers turn
// this into jumps, specialise the code after them for constants in a and b, and no longer vectorise
// the loop around it.
template <typename T>
[[gnu::always_inline]] inline T select_negative(T d, T a, T b) {
  using Bits = typename Format<T>::Bits;
  const Bits mask = Bits(0) - (std::bit_cast<Bits>(d) >> (8 * sizeof(T) - 1));
  return std::bit_cast<T>((std::bit_cast<Bits>(a) & mask) | (std::bit_cast<Bits>(b) & ~mask));
}

// For finite x.
template <typename T>
[[gnu::always_inline]] inline T clamp(T x, T lower, T upper) {
  const T y = select_negative(x - lower, lower, x);
  return select_negative(upper - y, upper, y);
}

}  // namespace normal_distribution_detail

/// exp(x) for |x| <= 708 (double), 87 (float). Unspecified beyond.
template <typename T>
[[gnu::always_inline]] inline T exponential_in_range(T x) {
  using F = normal_distribution_detail::Format<T>;
  using Bits = typename F::Bits;
  // x = n ln 2 + r. The low bits of `shifted` hold the integer n.
  const T shifted = x * T(1.44269504088896340736) + F::kRound;
  const T n = shifted - F::kRound;
  const T r = (x - n * F::kLn2High) - n * F::kLn2Low;
  const Bits scale = (std::bit_cast<Bits>(shifted) + F::kBias) << F::kMantissa;
  return F::reduced(r) * std::bit_cast<T>(scale);
}

/// exp(x), clamped.
template <typename T>
[[gnu::always_inline]] inline T exponential(T x) {
  using F = normal_distribution_detail::Format<T>;
  return exponential_in_range(
      normal_distribution_detail::clamp(x, -F::kExponentLimit, F::kExponentLimit));
}

/// Phi(x) and phi(x) = Phi'(x) for |x| <= 37.5 (double), 13 (float). Unspecified beyond.
template <typename T>
[[gnu::always_inline]] inline void normal_in_range(T x, T& cdf, T& density) {
  const T y = normal_distribution_detail::select_negative(x, -x, x);
  const T e = exponential_in_range(T(-0.5) * (y * y));
  T p = T(3.52624965998911e-02) * y + T(0.700383064443688);
  p = p * y + T(6.37396220353165);
  p = p * y + T(33.912866078383);
  p = p * y + T(112.079291497871);
  p = p * y + T(221.213596169931);
  p = p * y + T(220.206867912376);
  T q = T(8.83883476483184e-02) * y + T(1.75566716318264);
  q = q * y + T(16.064177579207);
  q = q * y + T(86.7807322029461);
  q = q * y + T(296.564248779674);
  q = q * y + T(637.333633378831);
  q = q * y + T(793.826512519948);
  q = q * y + T(440.413735824752);
  const T tail = e * (p / q);
  cdf = normal_distribution_detail::select_negative(x, tail, T(1) - tail);
  density = T(0.398942280401432677940) * e;
}

/// Phi(x) and phi(x), clamped.
template <typename T>
[[gnu::always_inline]] inline void normal(T x, T& cdf, T& density) {
  using F = normal_distribution_detail::Format<T>;
  normal_in_range(normal_distribution_detail::clamp(x, -F::kNormalLimit, F::kNormalLimit), cdf,
                  density);
}

/// Phi(x) = P(Z <= x), Z standard normal.
template <typename T>
[[gnu::always_inline]] inline T normal_cdf(T x) {
  T cdf, density;
  normal(x, cdf, density);
  return cdf;
}

/// phi(x) = exp(-x^2 / 2) / sqrt(2 pi).
template <typename T>
[[gnu::always_inline]] inline T normal_density(T x) {
  T cdf, density;
  normal(x, cdf, density);
  return density;
}

}  // namespace prospect
