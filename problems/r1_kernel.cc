// SPDX-License-Identifier: Apache-2.0
#include "problems/r1_kernel.h"

#include <cmath>

#include "engine/support/normal_distribution.h"

namespace prospect {
namespace {

// Points that fill the widest vector.
template <typename T>
constexpr int kLanes = 64 / sizeof(T);
constexpr double kAcross = 1.603810890548638e-28;  // e^-64, a width of 640 by 10
constexpr double kDown = 1.4251640827409352e-21;   // e^-48, a height of 480 by 10

PROSPECT_FORCE_INLINE double exponential_clamped(double a) {
  return exponential_in_range(normal_distribution_detail::clamp(a, -100.0, 100.0));
}
PROSPECT_FORCE_INLINE float exponential_clamped(float a) {
  return exponential_in_range(normal_distribution_detail::clamp(a, -80.0f, 25.0f));
}

PROSPECT_FORCE_INLINE float at_most(float a, float b) { return a < b ? a : b; }
PROSPECT_FORCE_INLINE float at_least(float a, float b) { return a > b ? a : b; }

template <typename T>
PROSPECT_FORCE_INLINE double sum(const T* lane) {
  double total = 0.0;
  for (int j = 0; j < kLanes<T>; ++j) total += static_cast<double>(lane[j]);
  return total;
}

PROSPECT_FORCE_INLINE double visible_score_body(const R1Pose& pose, const float* __restrict x,
                                                const float* __restrict y,
                                                const float* __restrict down, int n) {
  const auto px = static_cast<float>(pose.px), py = static_cast<float>(pose.py);
  const auto cosine = static_cast<float>(pose.cos_theta), sine = static_cast<float>(pose.sin_theta);
  alignas(64) float count[kLanes<float>] = {};
  for (int first = 0; first < n; first += kLanes<float>) {
    for (int j = 0; j < kLanes<float>; ++j) {
      const float dx = x[first + j] - px, dy = y[first + j] - py;
      const float zc = cosine * dx + sine * dy;
      const float xc = sine * dx - cosine * dy;
      const float behind = 0.05f - zc;
      const float live = normal_distribution_detail::select_negative(behind, 1.0f, 0.0f);
      const float z = normal_distribution_detail::select_negative(behind, zc, 0.05f);
      const float scale = 45.0f / z;
      const float a = exponential_in_range(at_most(std::abs(scale * xc) - 32.0f, 25.0f));
      const float b =
          exponential_in_range(at_most(std::abs(scale * down[first + j]) - 24.0f, 25.0f));
      const float e = exponential_in_range(at_least(5.0f - 10.0f * z, -80.0f));
      count[j] += live / ((1.0f + a) * (1.0f + b) * (1.0f + e));
    }
  }
  return sum(count);
}

template <bool gradient>
PROSPECT_FORCE_INLINE R1Value visible_body(const R1Pose& pose, const double* __restrict x,
                                           const double* __restrict y,
                                           const double* __restrict down, int n) {
  const R1Pose p = pose;
  alignas(64) double count[kLanes<double>] = {}, aside[kLanes<double>] = {},
                     ahead[kLanes<double>] = {}, turn[kLanes<double>] = {};
  for (int first = 0; first < n; first += kLanes<double>) {
    for (int j = 0; j < kLanes<double>; ++j) {
      const double dx = x[first + j] - p.px, dy = y[first + j] - p.py, yc = down[first + j];
      const double zc = p.cos_theta * dx + p.sin_theta * dy;
      const double xc = p.sin_theta * dx - p.cos_theta * dy;
      const double behind = 0.05 - zc;
      const double live = normal_distribution_detail::select_negative(behind, 1.0, 0.0);
      const double z = normal_distribution_detail::select_negative(behind, zc, 0.05);
      const double scale = 450.0 / z;
      const double a = exponential_clamped(-0.1 * (scale * xc + 320.0));
      const double b = exponential_clamped(-0.1 * (scale * yc + 240.0));
      const double e = exponential_clamped(5.0 - 10.0 * z);
      const double A = (1.0 + a) * (a + kAcross);
      const double B = (1.0 + b) * (b + kDown);
      const double E = 1.0 + e;
      const double inverse = 1.0 / (A * B * E);
      const double in_view = live * (a * b * inverse);
      count[j] += in_view;
      if constexpr (gradient) {
        const double weight = 0.1 * in_view * scale;
        const double d_u = weight * (a * a - kAcross) * (inverse * (B * E));
        const double d_v = weight * (b * b - kDown) * (inverse * (A * E));
        const double d_range = 10.0 * in_view * e * (inverse * (A * B));
        const double d_z = d_range - (d_u * xc + d_v * yc) / z;
        aside[j] += d_u;
        ahead[j] += d_z;
        turn[j] += d_u * z - d_z * xc;
      }
    }
  }
  R1Value result{sum(count)};
  if constexpr (gradient) {
    const double d_x = sum(aside), d_z = sum(ahead);
    result.d_px = -p.sin_theta * d_x - p.cos_theta * d_z;
    result.d_py = p.cos_theta * d_x - p.sin_theta * d_z;
    result.d_theta = sum(turn);
  }
  return result;
}

template <typename T, bool gradient>
PROSPECT_FORCE_INLINE R1Value collision_body(const R1Pose& pose, const T* __restrict x,
                                             const T* __restrict y, int n) {
  const T px = static_cast<T>(pose.px), py = static_cast<T>(pose.py);
  alignas(64) T value[kLanes<T>] = {}, along_x[kLanes<T>] = {}, along_y[kLanes<T>] = {};
  for (int first = 0; first < n; first += kLanes<T>) {
    for (int j = 0; j < kLanes<T>; ++j) {
      const T dx = px - x[first + j], dy = py - y[first + j];
      // The small number keeps the derivative at a centre finite; it moves no distance.
      const T distance = std::sqrt(dx * dx + dy * dy + T(1e-30));
      const T e = exponential_clamped(T(16.0) * (distance - T(0.6)));
      const T s = T(1.0) / (T(1.0) + e);
      value[j] += s;
      if constexpr (gradient) {
        const double slope = -16.0 * (s * s * e) / distance;
        along_x[j] += slope * dx;
        along_y[j] += slope * dy;
      }
    }
  }
  return {sum(value), sum(along_x), sum(along_y), 0.0};
}

template <typename T, bool gradient>
PROSPECT_FORCE_INLINE R1Value gain_body(const R1Pose& pose, const T* __restrict x,
                                        const T* __restrict y, int n) {
  constexpr double kAhead = 1.5, kSquare = 0.8 * 0.8;
  const R1Pose p = pose;
  const T qx = static_cast<T>(p.px + kAhead * p.cos_theta);
  const T qy = static_cast<T>(p.py + kAhead * p.sin_theta);
  alignas(64) T value[kLanes<T>] = {}, along_x[kLanes<T>] = {}, along_y[kLanes<T>] = {};
  for (int first = 0; first < n; first += kLanes<T>) {
    for (int j = 0; j < kLanes<T>; ++j) {
      const T dx = qx - x[first + j], dy = qy - y[first + j];
      const T e = exponential_clamped((dx * dx + dy * dy) * T(-0.5 / kSquare));
      value[j] += e;
      if constexpr (gradient) {
        along_x[j] += (-1.0 / kSquare) * e * dx;
        along_y[j] += (-1.0 / kSquare) * e * dy;
      }
    }
  }
  const double d_x = sum(along_x), d_y = sum(along_y);
  return {sum(value), d_x, d_y, kAhead * (p.cos_theta * d_y - p.sin_theta * d_x)};
}

#define R1_ENTRIES(SET, TARGET)                                                                    \
  template <bool gradient>                                                                         \
  TARGET R1Value visible_##SET(const R1Pose& pose, const double* x, const double* y,               \
                               const double* down, int n) {                                        \
    return visible_body<gradient>(pose, x, y, down, n);                                            \
  }                                                                                                \
  template <bool gradient>                                                                         \
  TARGET R1Value collision_##SET(const R1Pose& pose, const double* x, const double* y, int n) {    \
    return collision_body<double, gradient>(pose, x, y, n);                                        \
  }                                                                                                \
  template <bool gradient>                                                                         \
  TARGET R1Value gain_##SET(const R1Pose& pose, const double* x, const double* y, int n) {         \
    return gain_body<double, gradient>(pose, x, y, n);                                             \
  }                                                                                                \
  TARGET double visible_score_##SET(const R1Pose& pose, const float* x, const float* y,            \
                                    const float* down, int n) {                                    \
    return visible_score_body(pose, x, y, down, n);                                                \
  }                                                                                                \
  TARGET double collision_score_##SET(const R1Pose& pose, const float* x, const float* y, int n) { \
    return collision_body<float, false>(pose, x, y, n).value;                                      \
  }                                                                                                \
  TARGET double gain_score_##SET(const R1Pose& pose, const float* x, const float* y, int n) {      \
    return gain_body<float, false>(pose, x, y, n).value;                                           \
  }                                                                                                \
  constexpr R1Kernel kernel_##SET{                                                                 \
      &visible_##SET<false>,  &visible_##SET<true>,  &collision_##SET<false>,                      \
      &collision_##SET<true>, &gain_##SET<false>,    &gain_##SET<true>,                            \
      visible_score_##SET,    collision_score_##SET, gain_score_##SET};

R1_ENTRIES(generic, )
#if defined(__x86_64__)
R1_ENTRIES(avx2, PROSPECT_TARGET_AVX2)
R1_ENTRIES(avx512, PROSPECT_TARGET_AVX512)
#endif
#undef R1_ENTRIES

}  // namespace

R1Kernel r1_kernel(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return kernel_avx512;
  if (set == InstructionSet::kAvx2) return kernel_avx2;
#endif
  (void)set;
  return kernel_generic;
}

}  // namespace prospect
