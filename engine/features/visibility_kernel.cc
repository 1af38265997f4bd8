// SPDX-License-Identifier: Apache-2.0
#include "engine/features/visibility_kernel.h"

#include <cmath>
#include <type_traits>

#include "engine/support/converted_numbers.h"
#include "engine/support/instruction_set.h"
#include "engine/support/normal_distribution.h"

namespace prospect {
namespace {

namespace vd = visibility_derivative;
constexpr int kLanes = VisibilityBlock::kLanes;

// Beyond this many standard deviations outside the image P_fov counts as 0: Phi there is 1e-19, far
// below what the sum over the landmarks can hold, and the clamp keeps products of tails out of the
// slow denormal range. The same for the logistic factors: 4e-18.
// Single precision has fewer exponents to multiply them in: 1e-12 and 4e-11.
template <typename T>
constexpr T kTail = T(9.0);
template <>
constexpr float kTail<float> = 7.0f;
template <typename T>
constexpr T kLogisticTail = T(40.0);
template <>
constexpr float kLogisticTail<float> = 24.0f;

template <typename T>
PROSPECT_FORCE_INLINE T clamp(T x, T lower, T upper) {
  return normal_distribution_detail::clamp(x, lower, upper);
}

template <typename T>
PROSPECT_FORCE_INLINE T at_least(T x, T lower) {
  return normal_distribution_detail::select_negative(x - lower, lower, x);
}

// A point before the camera and the uncertainty of its image. Notation: Y = (X, Y, Z) in C,
// a = X/Z, b = Y/Z, g = dY/dyaw. dY_x - a dY_z is what moves u, dY_y - b dY_z what moves v:
//   Q_u = Var(dY_x - a dY_z),  S_uu = (fx/Z)^2 Q_u + sigma^2.
template <typename T>
struct PointOf {
  T dx, dy, dz;  // l - sensor, in W
  T X, Y, Z;
  T inverse_z;  // of max(Z, near_depth)
  T a, b;
  T gz;                // g_z
  T gamma_u, gamma_v;  // g_x - a g_z, g_y - b g_z
  T ru[3], rv[3];      // rows of (e_x - a e_z)^T R_CW, (e_y - b e_z)^T R_CW
  T wu[3], wv[3];      // Sigma_i ru, Sigma_i rv
  T cu, cv;            // c_x - a c_z, c_y - b c_z
  T Qu, Qv;
  T gx, gy;
};
using Point = PointOf<double>;

template <typename T>
PROSPECT_FORCE_INLINE PointOf<T> point(const VisibilityBlockOf<T>& l, int j,
                                       const VisibilityKernelConstantsOf<T>& c,
                                       const VisibilityKernelStageOf<T>& s) {
  PointOf<T> p;
  p.dx = l.x[j] - s.sensor[0];
  p.dy = l.y[j] - s.sensor[1];
  p.dz = l.z[j] - s.sensor[2];
  p.X = s.R[0] * p.dx + s.R[1] * p.dy + s.R[2] * p.dz;
  p.Y = s.R[3] * p.dx + s.R[4] * p.dy + s.R[5] * p.dz;
  p.Z = s.R[6] * p.dx + s.R[7] * p.dy + s.R[8] * p.dz;
  const T z = at_least(p.Z, c.near_depth);
  p.inverse_z = T(1.0) / z;
  p.a = p.X * p.inverse_z;
  p.b = p.Y * p.inverse_z;
  p.gx = p.Y * c.up[2] - p.Z * c.up[1] + c.lever[0];
  p.gy = p.Z * c.up[0] - p.X * c.up[2] + c.lever[1];
  p.gz = p.X * c.up[1] - p.Y * c.up[0] + c.lever[2];
  p.gamma_u = p.gx - p.a * p.gz;
  p.gamma_v = p.gy - p.b * p.gz;
  for (int i = 0; i < 3; ++i) {
    p.ru[i] = s.R[i] - p.a * s.R[6 + i];
    p.rv[i] = s.R[3 + i] - p.b * s.R[6 + i];
  }
  p.wu[0] = l.xx[j] * p.ru[0] + l.xy[j] * p.ru[1] + l.xz[j] * p.ru[2];
  p.wu[1] = l.xy[j] * p.ru[0] + l.yy[j] * p.ru[1] + l.yz[j] * p.ru[2];
  p.wu[2] = l.xz[j] * p.ru[0] + l.yz[j] * p.ru[1] + l.zz[j] * p.ru[2];
  p.wv[0] = l.xx[j] * p.rv[0] + l.xy[j] * p.rv[1] + l.xz[j] * p.rv[2];
  p.wv[1] = l.xy[j] * p.rv[0] + l.yy[j] * p.rv[1] + l.yz[j] * p.rv[2];
  p.wv[2] = l.xz[j] * p.rv[0] + l.yz[j] * p.rv[1] + l.zz[j] * p.rv[2];
  p.cu = s.c[0] - p.a * s.c[2];
  p.cv = s.c[1] - p.b * s.c[2];
  const T Qu = s.M[0] + p.a * (p.a * s.M[2] - T(2.0) * s.M[4]) +
               p.gamma_u * (T(2.0) * p.cu + p.gamma_u * s.s) +
               (p.ru[0] * p.wu[0] + p.ru[1] * p.wu[1] + p.ru[2] * p.wu[2]);
  const T Qv = s.M[1] + p.b * (p.b * s.M[2] - T(2.0) * s.M[5]) +
               p.gamma_v * (T(2.0) * p.cv + p.gamma_v * s.s) +
               (p.rv[0] * p.wv[0] + p.rv[1] * p.wv[1] + p.rv[2] * p.wv[2]);
  // Both are variances; rounding must not make them negative.
  p.Qu = at_least(Qu, T(0.0));
  p.Qv = at_least(Qv, T(0.0));
  return p;
}

// Cov(dY_x - a dY_z, dY_y - b dY_z).
PROSPECT_FORCE_INLINE double cross_covariance(const Point& p, const VisibilityKernelStage& s) {
  return s.M[3] - p.b * s.M[4] - p.a * s.M[5] + p.a * p.b * s.M[2] + p.gamma_u * p.cv +
         p.gamma_v * p.cu + p.gamma_u * p.gamma_v * s.s +
         (p.ru[0] * p.wv[0] + p.ru[1] * p.wv[1] + p.ru[2] * p.wv[2]);
}

// Adjoints of a point's intermediates, gathered before they are carried to the stage's quantities.
struct PointAdjoint {
  double X = 0, Y = 0, Z = 0, inverse_z = 0, a = 0, b = 0, gamma_u = 0, gamma_v = 0, yaw = 0;
};

// Carries adjoints of a, b, 1/Z, gamma_u, gamma_v and Y back to (X, Y, Z) and yaw.
PROSPECT_FORCE_INLINE void close_point(const Point& p, const VisibilityKernelConstants& c,
                                       PointAdjoint& q) {
  const double gx = q.gamma_u;
  const double gy = q.gamma_v;
  const double gz = -p.a * q.gamma_u - p.b * q.gamma_v;
  const double a = q.a - p.gz * q.gamma_u;
  const double b = q.b - p.gz * q.gamma_v;
  const double inverse_z = q.inverse_z + a * p.X + b * p.Y;
  // Up to near_depth, 1/Z is constant; the gate has made all adjoints zero there.
  q.X += a * p.inverse_z + (c.up[1] * gz - c.up[2] * gy);
  q.Y += b * p.inverse_z + (c.up[2] * gx - c.up[0] * gz);
  q.Z += -inverse_z * p.inverse_z * p.inverse_z + (c.up[0] * gy - c.up[1] * gx);
  q.yaw += q.X * p.gx + q.Y * p.gy + q.Z * p.gz;
}

// Phi(upper) - Phi(lower) and, in double precision, the densities at both. In single precision it
// is taken on the side of the smaller tail, where Phi has relative accuracy: the prior that the
// information is added to is small, so that its determinant feels a landmark whose pi is 1e-8.
template <typename T>
PROSPECT_FORCE_INLINE void interval(T lower, T upper, T& probability,
                                    [[maybe_unused]] T& density_lower,
                                    [[maybe_unused]] T& density_upper) {
  T from, to;
  if constexpr (std::is_same_v<T, float>) {
    const T middle = lower + upper;
    T density;
    normal_in_range(normal_distribution_detail::select_negative(middle, upper, -lower), to,
                    density);
    normal_in_range(normal_distribution_detail::select_negative(middle, lower, -upper), from,
                    density);
  } else {
    normal_in_range(upper, to, density_upper);
    normal_in_range(lower, from, density_lower);
  }
  probability = to - from;
}

// P_cell = (6 + m) / (6 + 4 m + m^2).
template <typename T>
PROSPECT_FORCE_INLINE T cell_probability(T m) {
  return (T(6.0) + m) / (T(6.0) + m * (T(4.0) + m));
}

template <typename T>
using BlockResult =
    std::conditional_t<std::is_same_v<T, double>, VisibilityBlockResult, VisibilityScoreResult>;

// What is worked out of a block's landmarks, a lane each.
template <typename T>
struct alignas(64) LanesOf {
  static constexpr int kLanes = VisibilityBlockOf<T>::kLanes;
  // The image rectangle in standard deviations of the landmark's image, and their inverses.
  T t1[kLanes], t0[kLanes], s1[kLanes], s0[kLanes], rsu[kLanes], rsv[kLanes];
  T depth[kLanes], range[kLanes], squared_range[kLanes], cos_view[kLanes];
  T alive[kLanes];  // above 0 exactly where pi is not identically zero
  // Probabilities along u and v, with densities at their ends, and of range and view.
  T Pu[kLanes], Pv[kLanes], P5[kLanes], ft1[kLanes], ft0[kLanes], fs1[kLanes], fs0[kLanes];
  T e1[kLanes], e2[kLanes], e3[kLanes], e4[kLanes], e5[kLanes];  // e^-a of the logistic factors
};

// The geometry of a block; false if its pi are all zero.
template <typename T>
PROSPECT_FORCE_INLINE bool project(const VisibilityBlockOf<T>& l, const T* __restrict open,
                                   const VisibilityKernelConstantsOf<T>& c,
                                   const VisibilityKernelStageOf<T>& s, LanesOf<T>& lane) {
  constexpr int kLanes = VisibilityBlockOf<T>::kLanes;
  constexpr T one = 1.0;
  const T farthest = c.r_max + kLogisticTail<T> / c.inverse_r_max_width;
  for (int j = 0; j < kLanes; ++j) {
    lane.alive[j] = s.R[6] * (l.x[j] - s.sensor[0]) + s.R[7] * (l.y[j] - s.sensor[1]) +
                    s.R[8] * (l.z[j] - s.sensor[2]) - c.near_depth;
  }
  bool any = false;
  for (int j = 0; j < kLanes; ++j) any |= lane.alive[j] > T(0.0);
  if (!any) return false;
  for (int j = 0; j < kLanes; ++j) {
    const PointOf<T> p = point(l, j, c, s);
    const T ku = c.fx * p.inverse_z;
    const T kv = c.fy * p.inverse_z;
    const T noise = c.pixel_variance + c.border_variance;
    // One division for both: dividing is most of this loop.
    const T su = std::sqrt(ku * ku * p.Qu + noise);
    const T sv = std::sqrt(kv * kv * p.Qv + noise);
    const T both = one / (su * sv);
    lane.rsu[j] = both * sv;
    lane.rsv[j] = both * su;
    const T u = c.fx * p.a;
    const T v = c.fy * p.b;
    constexpr T tail = kTail<T>;
    lane.t1[j] = clamp((c.u_max - u) * lane.rsu[j], -tail, tail);
    lane.t0[j] = clamp((c.u_min + c.fx_baseline * p.inverse_z - u) * lane.rsu[j], -tail, tail);
    lane.s1[j] = clamp((c.v_max - v) * lane.rsv[j], -tail, tail);
    lane.s0[j] = clamp((c.v_min - v) * lane.rsv[j], -tail, tail);
    lane.depth[j] = p.Z;
    lane.squared_range[j] = p.X * p.X + p.Y * p.Y + p.Z * p.Z;
    lane.cos_view[j] = -(p.dx * l.nx[j] + p.dy * l.ny[j] + p.dz * l.nz[j]);  // times the range
    // Positive exactly where pi is not identically zero. P_unoccluded is C1 and >= 0: where it is
    // 0, so are its derivatives.
    lane.alive[j] = at_least(p.Z - c.near_depth, T(0.0)) * at_least(farthest - p.Z, T(0.0)) *
                    ((lane.t1[j] - lane.t0[j]) * (lane.s1[j] - lane.s0[j])) *
                    (l.survival[j] * open[j]);
  }
  any = false;
  for (int j = 0; j < kLanes; ++j) any |= lane.alive[j] > T(0.0);
  return any;
}

// pi of a block's landmarks.
template <typename T>
PROSPECT_FORCE_INLINE void probabilities(const VisibilityBlockOf<T>& l, const T* __restrict open,
                                         const VisibilityKernelConstantsOf<T>& c, LanesOf<T>& lane,
                                         T* __restrict pi_of) {
  constexpr int kLanes = VisibilityBlockOf<T>::kLanes;
  constexpr T one = 1.0;
  for (int j = 0; j < kLanes; ++j) {
    interval(lane.t0[j], lane.t1[j], lane.Pu[j], lane.ft0[j], lane.ft1[j]);
    interval(lane.s0[j], lane.s1[j], lane.Pv[j], lane.fs0[j], lane.fs1[j]);
  }
  for (int j = 0; j < kLanes; ++j) {
    lane.range[j] = std::sqrt(at_least(lane.squared_range[j], c.near_depth * c.near_depth));
    lane.cos_view[j] /= lane.range[j];
    const T scale = lane.range[j] * l.inverse_creation_range[j];
    constexpr T L = kLogisticTail<T>;
    lane.e1[j] =
        exponential_in_range(clamp((c.r_min - lane.depth[j]) * c.inverse_r_min_width, -L, L));
    lane.e2[j] =
        exponential_in_range(clamp((lane.depth[j] - c.r_max) * c.inverse_r_max_width, -L, L));
    lane.e3[j] = exponential_in_range(clamp((c.scale_min - scale) * c.inverse_scale_width, -L, L));
    lane.e4[j] = exponential_in_range(clamp((scale - c.scale_max) * c.inverse_scale_width, -L, L));
    lane.e5[j] =
        exponential_in_range(clamp((c.cos_view - lane.cos_view[j]) * c.inverse_cos_width, -L, L));
    lane.P5[j] = one / ((one + lane.e1[j]) * (one + lane.e2[j]) *
                        ((one + lane.e3[j]) * (one + lane.e4[j])) * (one + lane.e5[j]));
    const T t = clamp(lane.depth[j] / c.near_depth - one, T(0.0), one);
    const T gate = t * t * t * (T(10.0) + t * (T(6.0) * t - T(15.0)));
    const T kept = l.survival[j] * cell_probability(l.per_cell[j] * lane.depth[j] * lane.depth[j]);
    const T pi = kept * open[j] * gate * lane.P5[j] * (lane.Pu[j] * lane.Pv[j]);
    pi_of[j] = pi;
  }
}

// d pi of a block's landmarks, pi being known.
PROSPECT_FORCE_INLINE void slopes(const VisibilityBlock& l, const UnoccludedInput& open,
                                  const VisibilityKernelConstants& c,
                                  const VisibilityKernelStage& s, const LanesOf<double>& lane,
                                  VisibilityBlockResult& __restrict out) {
  for (int j = 0; j < kLanes; ++j) {
    const Point p = point(l, j, c, s);
    const double t = clamp(lane.depth[j] / c.near_depth - 1.0, 0.0, 1.0);
    const double gate = t * t * t * (10.0 + t * (6.0 * t - 15.0));
    const double gate_slope = 30.0 * t * t * (1.0 - t) * (1.0 - t) / c.near_depth;
    const double m = l.per_cell[j] * lane.depth[j] * lane.depth[j];
    const double kept = l.survival[j] * cell_probability(m);
    const double before_gate = kept * lane.P5[j] * (lane.Pu[j] * lane.Pv[j]);
    const double factor = kept * open.probability[j] * gate * lane.P5[j];
    const double pi = out.pi[j];
    PointAdjoint q;

    // Gate, range and view. d log sigma(x) = (1 - sigma(x)) dx; 1 / (1 + e) by products.
    const double p12 = (1.0 + lane.e1[j]) * (1.0 + lane.e2[j]);
    const double p34 = (1.0 + lane.e3[j]) * (1.0 + lane.e4[j]);
    const double p5 = 1.0 + lane.e5[j];
    const double w = pi * lane.P5[j];
    const double w12 = w * p34 * p5;
    const double d_scale = w * p12 * p5 *
                           (lane.e3[j] * (1.0 + lane.e4[j]) - lane.e4[j] * (1.0 + lane.e3[j])) *
                           c.inverse_scale_width;
    q.Z += w12 * (lane.e1[j] * (1.0 + lane.e2[j]) * c.inverse_r_min_width -
                  lane.e2[j] * (1.0 + lane.e1[j]) * c.inverse_r_max_width);
    q.Z += before_gate * open.probability[j] * gate_slope;
    // d log P_cell / dm = -(18 + 12 m + m^2) / ((6 + m) (6 + 4 m + m^2)).
    q.Z -= 2.0 * pi * l.per_cell[j] * lane.depth[j] * (18.0 + m * (12.0 + m)) /
           ((6.0 + m) * (6.0 + m * (4.0 + m)));
    const double d_cos = w * p12 * p34 * lane.e5[j] * c.inverse_cos_width;
    const double inverse_r = 1.0 / lane.range[j];
    const double d_range =
        d_scale * l.inverse_creation_range[j] - d_cos * lane.cos_view[j] * inverse_r;
    q.X += d_range * p.X * inverse_r;
    q.Y += d_range * p.Y * inverse_r;
    q.Z += d_range * p.Z * inverse_r;
    const double d_view = d_cos * inverse_r;
    const double d_open = before_gate * gate;
    out.d[vd::kSensor + 0][j] = d_view * l.nx[j] + d_open * open.d_x[j];
    out.d[vd::kSensor + 1][j] = d_view * l.ny[j] + d_open * open.d_y[j];
    out.d[vd::kSensor + 2][j] = d_view * l.nz[j] + d_open * open.d_z[j];

    // Image rectangle.
    const double Au1 = factor * lane.Pv[j] * lane.ft1[j] * lane.rsu[j];
    const double Au0 = factor * lane.Pv[j] * lane.ft0[j] * lane.rsu[j];
    const double Av1 = factor * lane.Pu[j] * lane.fs1[j] * lane.rsv[j];
    const double Av0 = factor * lane.Pu[j] * lane.fs0[j] * lane.rsv[j];
    const double Su = -0.5 * lane.rsu[j] * (Au1 * lane.t1[j] - Au0 * lane.t0[j]);
    const double Sv = -0.5 * lane.rsv[j] * (Av1 * lane.s1[j] - Av0 * lane.s0[j]);
    const double fu2 = c.fx * c.fx * p.inverse_z;
    const double fv2 = c.fy * c.fy * p.inverse_z;
    q.inverse_z += Au0 * -c.fx_baseline + 2.0 * (Su * fu2 * p.Qu + Sv * fv2 * p.Qv);
    const double Qu = Su * fu2 * p.inverse_z;
    const double Qv = Sv * fv2 * p.inverse_z;
    const double wu_z = p.wu[0] * s.R[6] + p.wu[1] * s.R[7] + p.wu[2] * s.R[8];
    const double wv_z = p.wv[0] * s.R[6] + p.wv[1] * s.R[7] + p.wv[2] * s.R[8];
    q.a += -c.fx * (Au1 - Au0) + 2.0 * Qu * (p.a * s.M[2] - s.M[4] - p.gamma_u * s.c[2] - wu_z);
    q.b += -c.fy * (Av1 - Av0) + 2.0 * Qv * (p.b * s.M[2] - s.M[5] - p.gamma_v * s.c[2] - wv_z);
    q.gamma_u += 2.0 * Qu * (p.cu + p.gamma_u * s.s);
    q.gamma_v += 2.0 * Qv * (p.cv + p.gamma_v * s.s);
    // Sigma_i turns in C as the base turns.
    q.yaw += 2.0 * Qu * (p.wu[1] * p.ru[0] - p.wu[0] * p.ru[1]) +
             2.0 * Qv * (p.wv[1] * p.rv[0] - p.wv[0] * p.rv[1]);
    out.d[vd::kM + 0][j] = Qu;
    out.d[vd::kM + 1][j] = Qv;
    out.d[vd::kM + 2][j] = p.a * p.a * Qu + p.b * p.b * Qv;
    out.d[vd::kM + 3][j] = 0.0;
    out.d[vd::kM + 4][j] = -2.0 * p.a * Qu;
    out.d[vd::kM + 5][j] = -2.0 * p.b * Qv;
    out.d[vd::kC + 0][j] = 2.0 * p.gamma_u * Qu;
    out.d[vd::kC + 1][j] = 2.0 * p.gamma_v * Qv;
    out.d[vd::kC + 2][j] = -2.0 * (p.a * p.gamma_u * Qu + p.b * p.gamma_v * Qv);
    out.d[vd::kS][j] = p.gamma_u * p.gamma_u * Qu + p.gamma_v * p.gamma_v * Qv;
    close_point(p, c, q);
    out.d[vd::kCamera + 0][j] = q.X;
    out.d[vd::kCamera + 1][j] = q.Y;
    out.d[vd::kCamera + 2][j] = q.Z;
    out.d[vd::kYaw][j] = q.yaw;
  }
}

template <typename T, bool kGradient>
PROSPECT_FORCE_INLINE void evaluate_body(const VisibilityBlockOf<T>* __restrict blocks,
                                         int num_blocks, const VisibilityKernelConstants& constants,
                                         const VisibilityKernelStage& stage,
                                         const UnoccludedInputOf<T>& unoccluded,
                                         BlockResult<T>* __restrict results, VisibilitySums& sums) {
  constexpr int kLanes = VisibilityBlockOf<T>::kLanes;
  // Copies, so that the compiler need not fear that results overwrite them.
  const auto c = converted_numbers<VisibilityKernelConstantsOf, T>(constants);
  const auto s = converted_numbers<VisibilityKernelStageOf, T>(stage);
  alignas(64) T count[kLanes] = {}, variance[kLanes] = {};
  alignas(64) [[maybe_unused]] double d_count[vd::kCount][8] = {}, d_variance[vd::kCount][8] = {};
  LanesOf<T> lane;

  for (int block = 0; block < num_blocks; ++block) {
    const VisibilityBlockOf<T>& l = blocks[block];
    BlockResult<T>& out = results[block];
    const T* open = unoccluded.probability + block * kLanes;
    out.alive = project(l, open, c, s, lane);
    if (!out.alive) {
      for (int j = 0; j < kLanes; ++j) out.pi[j] = T(0.0);
      continue;
    }
    probabilities(l, open, c, lane, out.pi);
    for (int j = 0; j < kLanes; ++j) {
      count[j] += l.multiplicity[j] * out.pi[j];
      variance[j] += l.multiplicity[j] * out.pi[j] * (T(1.0) - out.pi[j]);
    }
    if constexpr (kGradient) {
      const int first = block * kLanes;
      slopes(l, {open, unoccluded.d_x + first, unoccluded.d_y + first, unoccluded.d_z + first}, c,
             s, lane, out);
      for (int m = 0; m < vd::kCount; ++m) {
        for (int j = 0; j < kLanes; ++j) {
          const double d = l.multiplicity[j] * out.d[m][j];
          d_count[m][j] += d;
          d_variance[m][j] += (1.0 - 2.0 * out.pi[j]) * d;
        }
      }
    }
  }

  sums.count = 0.0;
  sums.variance = 0.0;
  for (int j = 0; j < kLanes; ++j) {
    sums.count += static_cast<double>(count[j]);
    sums.variance += static_cast<double>(variance[j]);
  }
  if constexpr (kGradient) {
    for (int m = 0; m < vd::kCount; ++m) {
      sums.d_count[m] = 0.0;
      sums.d_variance[m] = 0.0;
      for (int j = 0; j < kLanes; ++j) {
        sums.d_count[m] += d_count[m][j];
        sums.d_variance[m] += d_variance[m][j];
      }
    }
  }
}

// The two rows of H = dPi/d(displacement, rotation of the camera in C), and the inverse of S:
//   S^-1 = (Svv, -Suv; -Suv, Suu) / D.
struct Measurement {
  double hu[6], hv[6];
  double qu, qv, quv;  // S without the pixel noise
  double inverse_det;
  double alpha, beta, zeta;  // entries uu, uv, vv of S^-1
};

PROSPECT_FORCE_INLINE Measurement measurement(const Point& p, const VisibilityKernelConstants& c,
                                              const VisibilityKernelStage& s) {
  Measurement m;
  m.hu[0] = -c.fx * p.inverse_z;
  m.hu[1] = 0.0;
  m.hu[2] = c.fx * p.a * p.inverse_z;
  m.hu[3] = c.fx * p.a * p.b;
  m.hu[4] = -c.fx * (1.0 + p.a * p.a);
  m.hu[5] = c.fx * p.b;
  m.hv[0] = 0.0;
  m.hv[1] = -c.fy * p.inverse_z;
  m.hv[2] = c.fy * p.b * p.inverse_z;
  m.hv[3] = c.fy * (1.0 + p.b * p.b);
  m.hv[4] = -c.fy * p.a * p.b;
  m.hv[5] = -c.fy * p.a;
  const double ku = c.fx * p.inverse_z;
  const double kv = c.fy * p.inverse_z;
  m.qu = ku * ku * p.Qu;
  m.qv = kv * kv * p.Qv;
  m.quv = ku * kv * cross_covariance(p, s);
  // det(sigma^2 I + q) without cancellation against sigma^4.
  const double v = c.pixel_variance;
  const double minor = m.qu * m.qv - m.quv * m.quv;
  m.inverse_det = 1.0 / (v * v + v * (m.qu + m.qv) + at_least(minor, 0.0));
  m.alpha = (m.qv + v) * m.inverse_det;
  m.beta = -m.quv * m.inverse_det;
  m.zeta = (m.qu + v) * m.inverse_det;
  return m;
}

// pi_i of the eight landmarks of a block; null: none of them is seen.
PROSPECT_FORCE_INLINE const double* visible_of(const VisibilityBlockResult* results, int block) {
  return results[block].alive ? results[block].pi : nullptr;
}
PROSPECT_FORCE_INLINE const float* visible_of(const VisibilityScoreResult* results, int block) {
  constexpr int kBlocks = VisibilityScoreBlock::kLanes / kLanes;
  const VisibilityScoreResult& r = results[block / kBlocks];
  return r.alive ? r.pi + std::ptrdiff_t{block % kBlocks} * kLanes : nullptr;
}

template <typename Result>
PROSPECT_FORCE_INLINE void information_body(const VisibilityBlock* __restrict blocks,
                                            int num_blocks,
                                            const VisibilityKernelConstants& constants,
                                            const VisibilityKernelStage& stage,
                                            const Result* __restrict results, double* information) {
  const VisibilityKernelConstants c = constants;
  const VisibilityKernelStage s = stage;
  alignas(64) double sum[21][8] = {};
  for (int block = 0; block < num_blocks; ++block) {
    const auto* const pi = visible_of(results, block);
    if (pi == nullptr) continue;
    const VisibilityBlock& l = blocks[block];
    for (int j = 0; j < kLanes; ++j) {
      const Measurement m = measurement(point(l, j, c, s), c, s);
      const double weight = l.multiplicity[j] * static_cast<double>(pi[j]);
      const double alpha = weight * m.alpha;
      const double beta = weight * m.beta;
      const double zeta = weight * m.zeta;
      int n = 0;
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i) {
        const double gu = alpha * m.hu[i] + beta * m.hv[i];
        const double gv = beta * m.hu[i] + zeta * m.hv[i];
#pragma GCC unroll 6
        for (int k = i; k < 6; ++k) sum[n++][j] += gu * m.hu[k] + gv * m.hv[k];
      }
    }
  }
  int n = 0;
  for (int i = 0; i < 6; ++i) {
    for (int k = i; k < 6; ++k, ++n) {
      double total = 0.0;
      for (int j = 0; j < kLanes; ++j) total += sum[n][j];
      information[6 * i + k] = total;
      information[6 * k + i] = total;
    }
  }
}

PROSPECT_FORCE_INLINE void information_gradient_body(
    const VisibilityBlock* __restrict blocks, int num_blocks,
    const VisibilityKernelConstants& constants, const VisibilityKernelStage& stage,
    const VisibilityBlockResult* __restrict results, const double* P, double* __restrict d) {
  const VisibilityKernelConstants c = constants;
  const VisibilityKernelStage s = stage;
  double weight[36];
  for (int i = 0; i < 36; ++i) weight[i] = P[i];
  alignas(64) double sum[vd::kCount][8] = {};
  alignas(64) double own[vd::kCount][8];
  alignas(64) double d_pi[8];
  for (int block = 0; block < num_blocks; ++block) {
    if (!results[block].alive) continue;
    const VisibilityBlock& l = blocks[block];
    const VisibilityBlockResult& r = results[block];
    for (int j = 0; j < kLanes; ++j) {
      const Point p = point(l, j, c, s);
      const Measurement m = measurement(p, c, s);
      double Pu[6], Pv[6];  // P h_u, P h_v
      double uu = 0.0, uv = 0.0, vv = 0.0;
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i) {
        Pu[i] = 0.0;
        Pv[i] = 0.0;
#pragma GCC unroll 6
        for (int k = 0; k < 6; ++k) {
          Pu[i] += weight[6 * i + k] * m.hu[k];
          Pv[i] += weight[6 * i + k] * m.hv[k];
        }
        uu += m.hu[i] * Pu[i];
        uv += m.hu[i] * Pv[i];
        vv += m.hv[i] * Pv[i];
      }
      // T = <P, H^T S^-1 H> = <W, S^-1>, W = (uu, uv; uv, vv);  dT/dS = -S^-1 W S^-1 = -E.
      const double pi = l.multiplicity[j] * r.pi[j];
      d_pi[j] = l.multiplicity[j] * (m.alpha * uu + 2.0 * m.beta * uv + m.zeta * vv);
      const double Wu0 = uu * m.alpha + uv * m.beta, Wu1 = uu * m.beta + uv * m.zeta;
      const double Wv0 = uv * m.alpha + vv * m.beta, Wv1 = uv * m.beta + vv * m.zeta;
      const double d_qu = -pi * (m.alpha * Wu0 + m.beta * Wv0);
      const double d_qv = -pi * (m.beta * Wu1 + m.zeta * Wv1);
      const double d_quv = -2.0 * pi * (m.alpha * Wu1 + m.beta * Wv1);

      PointAdjoint q;
      // dT/dh_u = 2 (alpha P h_u + beta P h_v), dT/dh_v likewise.
      double hu[6], hv[6];
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i) {
        hu[i] = 2.0 * pi * (m.alpha * Pu[i] + m.beta * Pv[i]);
        hv[i] = 2.0 * pi * (m.beta * Pu[i] + m.zeta * Pv[i]);
      }
      q.inverse_z = c.fx * (-hu[0] + p.a * hu[2]) + c.fy * (-hv[1] + p.b * hv[2]);
      q.a = c.fx * (p.inverse_z * hu[2] + p.b * hu[3] - 2.0 * p.a * hu[4]) -
            c.fy * (p.b * hv[4] + hv[5]);
      q.b = c.fx * (p.a * hu[3] + hu[5]) +
            c.fy * (p.inverse_z * hv[2] + 2.0 * p.b * hv[3] - p.a * hv[4]);

      // q_u = ku^2 Q_u, q_v = kv^2 Q_v, q_uv = ku kv Q_uv with k = f / Z.
      const double ku = c.fx * p.inverse_z;
      const double kv = c.fy * p.inverse_z;
      const double Quv = cross_covariance(p, s);
      q.inverse_z +=
          2.0 * (d_qu * c.fx * ku * p.Qu + d_qv * c.fy * kv * p.Qv + d_quv * c.fx * kv * Quv);
      const double Qu = d_qu * ku * ku;
      const double Qv = d_qv * kv * kv;
      const double X = d_quv * ku * kv;  // adjoint of Q_uv
      const double wu_z = p.wu[0] * s.R[6] + p.wu[1] * s.R[7] + p.wu[2] * s.R[8];
      const double wv_z = p.wv[0] * s.R[6] + p.wv[1] * s.R[7] + p.wv[2] * s.R[8];
      q.a += 2.0 * Qu * (p.a * s.M[2] - s.M[4] - p.gamma_u * s.c[2] - wu_z) +
             X * (p.b * s.M[2] - s.M[5] - p.gamma_v * s.c[2] - wv_z);
      q.b += 2.0 * Qv * (p.b * s.M[2] - s.M[5] - p.gamma_v * s.c[2] - wv_z) +
             X * (p.a * s.M[2] - s.M[4] - p.gamma_u * s.c[2] - wu_z);
      q.gamma_u = 2.0 * Qu * (p.cu + p.gamma_u * s.s) + X * (p.cv + p.gamma_v * s.s);
      q.gamma_v = 2.0 * Qv * (p.cv + p.gamma_v * s.s) + X * (p.cu + p.gamma_u * s.s);
      q.yaw = 2.0 * Qu * (p.wu[1] * p.ru[0] - p.wu[0] * p.ru[1]) +
              2.0 * Qv * (p.wv[1] * p.rv[0] - p.wv[0] * p.rv[1]) +
              X * (p.wv[1] * p.ru[0] - p.wv[0] * p.ru[1] + p.wu[1] * p.rv[0] - p.wu[0] * p.rv[1]);
      own[vd::kM + 0][j] = Qu;
      own[vd::kM + 1][j] = Qv;
      own[vd::kM + 2][j] = p.a * p.a * Qu + p.b * p.b * Qv + p.a * p.b * X;
      own[vd::kM + 3][j] = X;
      own[vd::kM + 4][j] = -2.0 * p.a * Qu - p.b * X;
      own[vd::kM + 5][j] = -2.0 * p.b * Qv - p.a * X;
      own[vd::kC + 0][j] = 2.0 * p.gamma_u * Qu + p.gamma_v * X;
      own[vd::kC + 1][j] = 2.0 * p.gamma_v * Qv + p.gamma_u * X;
      own[vd::kC + 2][j] = -2.0 * (p.a * p.gamma_u * Qu + p.b * p.gamma_v * Qv) -
                           (p.b * p.gamma_u + p.a * p.gamma_v) * X;
      own[vd::kS][j] =
          p.gamma_u * p.gamma_u * Qu + p.gamma_v * p.gamma_v * Qv + p.gamma_u * p.gamma_v * X;
      close_point(p, c, q);
      own[vd::kCamera + 0][j] = q.X;
      own[vd::kCamera + 1][j] = q.Y;
      own[vd::kCamera + 2][j] = q.Z;
      own[vd::kSensor + 0][j] = 0.0;
      own[vd::kSensor + 1][j] = 0.0;
      own[vd::kSensor + 2][j] = 0.0;
      own[vd::kYaw][j] = q.yaw;
    }
    for (int m = 0; m < vd::kCount; ++m) {
      for (int j = 0; j < kLanes; ++j) sum[m][j] += own[m][j] + d_pi[j] * r.d[m][j];
    }
  }
  for (int m = 0; m < vd::kCount; ++m) {
    d[m] = 0.0;
    for (int j = 0; j < kLanes; ++j) d[m] += sum[m][j];
  }
}

#define PROSPECT_VISIBILITY_KERNEL(SUFFIX, TARGET)                                               \
  TARGET void evaluate_##SUFFIX(                                                                 \
      const VisibilityBlock* blocks, int num_blocks, const VisibilityKernelConstants& constants, \
      const VisibilityKernelStage& stage, const UnoccludedInput& unoccluded,                     \
      VisibilityBlockResult* results, VisibilitySums& sums) {                                    \
    if (unoccluded.d_x != nullptr) {                                                             \
      evaluate_body<double, true>(blocks, num_blocks, constants, stage, unoccluded, results,     \
                                  sums);                                                         \
    } else {                                                                                     \
      evaluate_body<double, false>(blocks, num_blocks, constants, stage, unoccluded, results,    \
                                   sums);                                                        \
    }                                                                                            \
  }                                                                                              \
  TARGET void score_##SUFFIX(const VisibilityScoreBlock* blocks, int num_blocks,                 \
                             const VisibilityKernelConstants& constants,                         \
                             const VisibilityKernelStage& stage, const float* unoccluded,        \
                             VisibilityScoreResult* results, VisibilitySums& sums) {             \
    evaluate_body<float, false>(blocks, num_blocks, constants, stage, {unoccluded}, results,     \
                                sums);                                                           \
  }                                                                                              \
  TARGET void information_##SUFFIX(const VisibilityBlock* blocks, int num_blocks,                \
                                   const VisibilityKernelConstants& constants,                   \
                                   const VisibilityKernelStage& stage,                           \
                                   const VisibilityBlockResult* results, double* information) {  \
    information_body(blocks, num_blocks, constants, stage, results, information);                \
  }                                                                                              \
  TARGET void score_information_##SUFFIX(                                                        \
      const VisibilityBlock* blocks, int num_blocks, const VisibilityKernelConstants& constants, \
      const VisibilityKernelStage& stage, const VisibilityScoreResult* results,                  \
      double* information) {                                                                     \
    information_body(blocks, num_blocks, constants, stage, results, information);                \
  }                                                                                              \
  TARGET void information_gradient_##SUFFIX(                                                     \
      const VisibilityBlock* blocks, int num_blocks, const VisibilityKernelConstants& constants, \
      const VisibilityKernelStage& stage, const VisibilityBlockResult* results, const double* P, \
      double* d) {                                                                               \
    information_gradient_body(blocks, num_blocks, constants, stage, results, P, d);              \
  }

PROSPECT_VISIBILITY_KERNEL(generic, )
#if defined(__x86_64__)
PROSPECT_VISIBILITY_KERNEL(avx2, PROSPECT_TARGET_AVX2)
PROSPECT_VISIBILITY_KERNEL(avx512, PROSPECT_TARGET_AVX512)
#endif
#undef PROSPECT_VISIBILITY_KERNEL

}  // namespace

std::vector<VisibilityKernel> available_visibility_kernels() {
  std::vector<VisibilityKernel> kernels;
  for (const InstructionSet set : available_instruction_sets()) {
    switch (set) {
#if defined(__x86_64__)
      case InstructionSet::kAvx2:
        kernels.push_back({name(set), evaluate_avx2, score_avx2, information_avx2,
                           score_information_avx2, information_gradient_avx2});
        break;
      case InstructionSet::kAvx512:
        kernels.push_back({name(set), evaluate_avx512, score_avx512, information_avx512,
                           score_information_avx512, information_gradient_avx512});
        break;
#endif
      default:
        kernels.push_back({name(set), evaluate_generic, score_generic, information_generic,
                           score_information_generic, information_gradient_generic});
    }
  }
  return kernels;
}

VisibilityKernel best_visibility_kernel() { return available_visibility_kernels().back(); }

}  // namespace prospect
