// SPDX-License-Identifier: Apache-2.0
#include "engine/features/footprint_kernel.h"

#include <cmath>

#include "engine/support/converted_numbers.h"
#include "engine/support/normal_distribution.h"

namespace prospect {
namespace {

// Points that fill the widest vector.
template <typename T>
constexpr int kLanes = 64 / sizeof(T);

// Regularises angles of a point at the sensor itself [m].
template <typename T>
constexpr T kNear = T(0.02);
// Beyond this exponent a sigmoid is below 1e-43, or 1 to the last bit (single precision: below the
// cut-off, or 1 to 1e-6); the clamp keeps products of six finite.
template <typename T>
constexpr T kLargestExponent = T(100.0);
template <>
constexpr float kLargestExponent<float> = 14.0f;

template <typename T>
PROSPECT_FORCE_INLINE T at_most(T a, T b) {
  return a < b ? a : b;
}

template <typename T>
PROSPECT_FORCE_INLINE T magnitude(T a) {
  return std::abs(a);
}

// 1 / s(a) - 1 = e^exponent of a sigmoid.
template <typename T>
PROSPECT_FORCE_INLINE T odds(T exponent) {
  return exponential_in_range(
      normal_distribution_detail::clamp(exponent, -kLargestExponent<T>, kLargestExponent<T>));
}

// Everything about one point; the pairs of sigmoids A (left, right), B (top, bottom), C (near,
// far).
template <typename T>
struct ViewOf {
  T inverse_rho, inverse_r, rho;
  T e0, e1, e2, e3, e4, e5;  // e^-a of the six sigmoids
  T A, B, C;                 // 1 / product of each pair
  T product;                 // 1 / (P_fov P_range)
  T g;                       // P_fov P_range before the cut-off
  T above;                   // 1 - negligible / g, at least 0
};
using View = ViewOf<double>;

template <typename T>
PROSPECT_FORCE_INLINE ViewOf<T> view(const FootprintKernelConstantsOf<T>& c, T X, T Y, T Z) {
  ViewOf<T> l;
  const T rho_squared = X * X + Z * Z + kNear<T> * kNear<T>;
  l.rho = std::sqrt(rho_squared);
  const T r = std::sqrt(rho_squared + Y * Y);
  const T inverse = T(1.0) / (l.rho * r);
  l.inverse_rho = inverse * r;
  l.inverse_r = inverse * l.rho;
  const T h = c.inverse_angle_scale * l.inverse_rho;
  const T v = c.inverse_angle_scale * l.inverse_r;
  const T h0 = (c.inset + c.bias_h) - c.sin_h * Z * h, h1 = c.cos_h * X * h;
  const T v0 = (c.inset + c.bias_v) - c.sin_v * l.rho * v, v1 = c.cos_v * Y * v;
  l.e0 = odds(h0 + h1);
  l.e1 = odds(h0 - h1);
  l.e2 = odds(v0 + v1);
  l.e3 = odds(v0 - v1);
  l.e4 = odds(c.inset - (r - c.min_range) * c.inverse_range_scale);
  l.e5 = odds(c.inset - (c.max_range - r) * c.inverse_range_scale);
  l.A = (T(1.0) + l.e0) * (T(1.0) + l.e1);
  l.B = (T(1.0) + l.e2) * (T(1.0) + l.e3);
  l.C = (T(1.0) + l.e4) * (T(1.0) + l.e5);
  l.product = l.A * l.B * l.C;
  l.g = T(1.0) / l.product;
  const T above = T(1.0) - c.negligible * l.product;
  l.above = normal_distribution_detail::select_negative(above, T(0.0), above);
  return l;
}

// Arrays do not overlap.
template <typename T>
PROSPECT_FORCE_INLINE int select_body(const FootprintKernelConstants& constants,
                                      const FootprintKernelPose& pose,
                                      const FootprintPointsOf<T>& points,
                                      const FootprintSelectionOf<T>& result) {
  const T* __restrict px = points.x, * __restrict py = points.y, * __restrict pz = points.z;
  const T* __restrict unoccluded = points.unoccluded;
  int* __restrict point = result.point;
  T* __restrict X = result.X, * __restrict Y = result.Y, * __restrict Z = result.Z;
  const int n = points.n;
  const auto c = converted_numbers<FootprintKernelConstantsOf, T>(constants);
  const auto p = converted_numbers<FootprintKernelPoseOf, T>(pose);
  alignas(64) T x[kLanes<T>], y[kLanes<T>], z[kLanes<T>], open[kLanes<T>], live[kLanes<T>];
  int selected = 0;
  for (int first = 0; first < n; first += kLanes<T>) {
    const int count = n - first < kLanes<T> ? n - first : kLanes<T>;
    if (count == kLanes<T>) {
      for (int j = 0; j < kLanes<T>; ++j) open[j] = unoccluded[first + j];
    } else {
      for (int j = 0; j < kLanes<T>; ++j) open[j] = j < count ? unoccluded[first + j] : T(0.0);
    }
    for (int j = 0; j < kLanes<T>; ++j) {
      const T dx = px[first + j] - p.sensor[0], dy = py[first + j] - p.sensor[1],
              dz = pz[first + j] - p.sensor[2];
      x[j] = p.R[0] * dx + p.R[1] * dy + p.R[2] * dz;
      y[j] = p.R[3] * dx + p.R[4] * dy + p.R[5] * dz;
      z[j] = p.R[6] * dx + p.R[7] * dy + p.R[8] * dz;
      const T rho_squared = x[j] * x[j] + z[j] * z[j] + kNear<T> * kNear<T>;
      // Signed square of rho sin(angle inside the nearer side).
      const T inside = c.sin_h * z[j] - c.cos_h * magnitude(x[j]);
      const T beside = inside * magnitude(inside) + c.outside_squared * rho_squared;
      const T near = c.far_squared - (rho_squared + y[j] * y[j]);
      live[j] = at_most(at_most(beside, near), open[j]);
    }
    T most = live[0];
    for (int j = 1; j < kLanes<T>; ++j) most = most > live[j] ? most : live[j];
    if (!(most > T(0.0))) continue;
    for (int j = 0; j < kLanes<T>; ++j) {
      point[selected] = first + j;
      X[selected] = x[j];
      Y[selected] = y[j];
      Z[selected] = z[j];
      selected += live[j] > T(0.0);
    }
  }
  // The padding is any point before the sensor.
  for (int j = selected; j < FootprintKernel::padded(selected); ++j) {
    point[j] = 0;
    X[j] = Y[j] = T(0.0);
    Z[j] = T(1.0);
  }
  return selected;
}

template <typename T>
PROSPECT_FORCE_INLINE void value_body(const FootprintKernelConstants& constants,
                                      const FootprintPointsOf<T>& points, T* __restrict q) {
  const T* __restrict X = points.x, * __restrict Y = points.y, * __restrict Z = points.z;
  const T* __restrict unoccluded = points.unoccluded;
  const int n = points.n;
  const auto c = converted_numbers<FootprintKernelConstantsOf, T>(constants);
  for (int first = 0; first < n; first += kLanes<T>) {
    for (int i = first; i < first + kLanes<T>; ++i) {
      const ViewOf<T> l = view(c, X[i], Y[i], Z[i]);
      q[i] = unoccluded[i] * (l.g * (l.above * l.above));
    }
  }
}

PROSPECT_FORCE_INLINE void gradient_body(const FootprintKernelConstants& constants,
                                         const FootprintKernelPose& pose,
                                         const FootprintKernel::Points& points,
                                         const UnoccludedSlopes& slopes,
                                         const FootprintGradient& result) {
  const double* __restrict X = points.x, * __restrict Y = points.y, * __restrict Z = points.z;
  const double* __restrict unoccluded = points.unoccluded;
  const double* __restrict u_x = slopes.x, * __restrict u_y = slopes.y, * __restrict u_z = slopes.z;
  double* __restrict q = result.q, * __restrict d_x = result.d_x, * __restrict d_y = result.d_y;
  double* __restrict d_z = result.d_z, * __restrict d_yaw = result.d_yaw;
  const int n = points.n;
  const FootprintKernelConstants c = constants;
  const FootprintKernelPose p = pose;
  for (int first = 0; first < n; first += kLanes<double>) {
    for (int i = first; i < first + kLanes<double>; ++i) {
      const double x = X[i], y = Y[i], z = Z[i];
      const View l = view(c, x, y, z);
      const double footprint = l.g * (l.above * l.above);
      q[i] = unoccluded[i] * footprint;
      // d(g above^2)/dg = above (1 + negligible / g); dg/da = g (1 - s(a)) for each sigmoid, with
      // 1 - s(a) = e / (1 + e), and 1 / A = g B C.
      const double w = unoccluded[i] * (l.g * (l.above * (1.0 + c.negligible * l.product)));
      const double wA = w * (l.g * (l.B * l.C));
      const double wB = w * (l.g * (l.A * l.C));
      const double wC = w * (l.g * (l.A * l.B));
      const double a0 = wA * (l.e0 * (1.0 + l.e1)), a1 = wA * (l.e1 * (1.0 + l.e0));
      const double a2 = wB * (l.e2 * (1.0 + l.e3)), a3 = wB * (l.e3 * (1.0 + l.e2));
      const double a4 = wC * (l.e4 * (1.0 + l.e5)), a5 = wC * (l.e5 * (1.0 + l.e4));
      const double h = c.inverse_angle_scale * l.inverse_rho;
      const double v = c.inverse_angle_scale * l.inverse_r;
      // (sin_h Z -+ cos_h X) / rho
      const double sz = c.sin_h * z, cx = c.cos_h * x;
      const double horizontal = (a0 * (sz - cx) + a1 * (sz + cx)) * l.inverse_rho;
      double gX = h * ((a1 - a0) * c.cos_h - horizontal * x * l.inverse_rho);
      double gZ = h * ((a0 + a1) * c.sin_h - horizontal * z * l.inverse_rho);
      // (sin_v rho -+ cos_v Y) / r
      const double sr = c.sin_v * l.rho, cy = c.cos_v * y;
      const double vertical = (a2 * (sr - cy) + a3 * (sr + cy)) * l.inverse_r;
      double gY = v * ((a3 - a2) * c.cos_v - vertical * y * l.inverse_r);
      const double g_rho =
          v * ((a2 + a3) * c.sin_v - vertical * l.rho * l.inverse_r) * l.inverse_rho;
      const double g_r = (a4 - a5) * c.inverse_range_scale * l.inverse_r;
      gX += (g_rho + g_r) * x;
      gZ += (g_rho + g_r) * z;
      gY += g_r * y;
      // Moving the camera by dc moves the point by -R_CW dc in C; turning the base turns it by
      // -d(yaw) about W's z axis and moves the camera along z x arm.
      const double bx = footprint * u_x[i] - (p.R[0] * gX + p.R[3] * gY + p.R[6] * gZ);
      const double by = footprint * u_y[i] - (p.R[1] * gX + p.R[4] * gY + p.R[7] * gZ);
      const double bz = footprint * u_z[i] - (p.R[2] * gX + p.R[5] * gY + p.R[8] * gZ);
      const double turn =
          p.R[2] * (y * gZ - z * gY) + p.R[5] * (z * gX - x * gZ) + p.R[8] * (x * gY - y * gX);
      d_x[i] = bx;
      d_y[i] = by;
      d_z[i] = bz;
      d_yaw[i] = by * p.arm[0] - bx * p.arm[1] - turn;
    }
  }
}

#define PROSPECT_FOOTPRINT_KERNEL(SUFFIX, TARGET)                                                  \
  TARGET int select_##SUFFIX(const FootprintKernelConstants& c, const FootprintKernelPose& p,      \
                             const FootprintKernel::Points& points,                                \
                             const FootprintSelectionOf<double>& selected) {                       \
    return select_body(c, p, points, selected);                                                    \
  }                                                                                                \
  TARGET void value_##SUFFIX(const FootprintKernelConstants& c,                                    \
                             const FootprintKernel::Points& points, double* q) {                   \
    value_body(c, points, q);                                                                      \
  }                                                                                                \
  TARGET void gradient_##SUFFIX(const FootprintKernelConstants& c, const FootprintKernelPose& p,   \
                                const FootprintKernel::Points& points,                             \
                                const UnoccludedSlopes& slopes, const FootprintGradient& result) { \
    gradient_body(c, p, points, slopes, result);                                                   \
  }                                                                                                \
  TARGET int select_score_##SUFFIX(                                                                \
      const FootprintKernelConstants& c, const FootprintKernelPose& p,                             \
      const FootprintKernel::ScorePoints& points, const FootprintSelectionOf<float>& selected) {   \
    return select_body(c, p, points, selected);                                                    \
  }                                                                                                \
  TARGET void value_score_##SUFFIX(const FootprintKernelConstants& c,                              \
                                   const FootprintKernel::ScorePoints& points, float* q) {         \
    value_body(c, points, q);                                                                      \
  }

PROSPECT_FOOTPRINT_KERNEL(generic, )
#if defined(__x86_64__)
PROSPECT_FOOTPRINT_KERNEL(avx2, PROSPECT_TARGET_AVX2)
PROSPECT_FOOTPRINT_KERNEL(avx512, PROSPECT_TARGET_AVX512)
#endif
#undef PROSPECT_FOOTPRINT_KERNEL

}  // namespace

FootprintKernel footprint_kernel([[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512)
    return {select_avx512, value_avx512, gradient_avx512, select_score_avx512, value_score_avx512};
  if (set == InstructionSet::kAvx2)
    return {select_avx2, value_avx2, gradient_avx2, select_score_avx2, value_score_avx2};
#endif
  return {select_generic, value_generic, gradient_generic, select_score_generic,
          value_score_generic};
}

double footprint_value(const FootprintKernelConstants& constants, double X, double Y, double Z) {
  const View l = view(constants, X, Y, Z);
  return l.g * (l.above * l.above);
}

}  // namespace prospect
