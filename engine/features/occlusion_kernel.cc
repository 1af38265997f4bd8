// SPDX-License-Identifier: Apache-2.0
#include "engine/features/occlusion_kernel.h"

namespace prospect {
namespace {

template <typename T, bool kGradient, bool kVertical, bool kFirst>
PROSPECT_FORCE_INLINE void add_plane(const OcclusionPlane& p, int n, T* __restrict out,
                                     [[maybe_unused]] T* __restrict out_x,
                                     [[maybe_unused]] T* __restrict out_y,
                                     [[maybe_unused]] T* __restrict out_z) {
  const float* __restrict r0 = p.rows[0];
  const float* __restrict r1 = p.rows[1];
  const float* __restrict r2 = p.rows[2];
  const float* __restrict r3 = p.rows[3];
  const float* __restrict r4 = p.rows[4];
  const float* __restrict r5 = p.rows[5];
  const float* __restrict r6 = p.rows[6];
  const float* __restrict r7 = p.rows[7];
  const float* __restrict r8 = p.rows[8];
  const T x0 = T(p.x[0]), x1 = T(p.x[1]), x2 = T(p.x[2]);
  const T y0 = T(p.y[0]), y1 = T(p.y[1]), y2 = T(p.y[2]);
  const T z = T(p.z);
  [[maybe_unused]] const double e0 = p.dx[0], e1 = p.dx[1], e2 = p.dx[2];
  [[maybe_unused]] const double f0 = p.dy[0], f1 = p.dy[1], f2 = p.dy[2];
  [[maybe_unused]] const double dz = p.dz;
  for (int i = 0; i < n; ++i) {
    const T a0 = r0[i], a1 = r1[i], a2 = r2[i];
    const T b0 = r3[i], b1 = r4[i], b2 = r5[i];
    const T c0 = r6[i], c1 = r7[i], c2 = r8[i];
    const T a = x0 * a0 + x1 * a1 + x2 * a2;
    const T b = x0 * b0 + x1 * b1 + x2 * b2;
    const T c = x0 * c0 + x1 * c1 + x2 * c2;
    const T plane = y0 * a + y1 * b + y2 * c;
    const T value = z * plane;
    out[i] = kFirst ? value : out[i] + value;
    if constexpr (kGradient) {
      const T slope_x =
          z * (y0 * (e0 * a0 + e1 * a1 + e2 * a2) + y1 * (e0 * b0 + e1 * b1 + e2 * b2) +
               y2 * (e0 * c0 + e1 * c1 + e2 * c2));
      const T slope_y = z * (f0 * a + f1 * b + f2 * c);
      out_x[i] = kFirst ? slope_x : out_x[i] + slope_x;
      out_y[i] = kFirst ? slope_y : out_y[i] + slope_y;
      if constexpr (kVertical) {
        const T slope_z = dz * plane;
        out_z[i] = kFirst ? slope_z : out_z[i] + slope_z;
      }
    }
  }
}

template <bool kFirst>
PROSPECT_FORCE_INLINE void add_plane(const OcclusionPlane& p, int n, double* out, double* d_x,
                                     double* d_y, double* d_z) {
  if (!d_x) return add_plane<double, false, false, kFirst>(p, n, out, nullptr, nullptr, nullptr);
  if (!d_z) return add_plane<double, true, false, kFirst>(p, n, out, d_x, d_y, nullptr);
  add_plane<double, true, true, kFirst>(p, n, out, d_x, d_y, d_z);
}

#define PROSPECT_OCCLUSION_KERNEL(SUFFIX, TARGET)                                        \
  TARGET void evaluate_##SUFFIX(const OcclusionPlane& p, int n, bool first, double* out, \
                                double* d_x, double* d_y, double* d_z) {                 \
    if (first) {                                                                         \
      add_plane<true>(p, n, out, d_x, d_y, d_z);                                         \
    } else {                                                                             \
      add_plane<false>(p, n, out, d_x, d_y, d_z);                                        \
    }                                                                                    \
  }                                                                                      \
  TARGET void score_##SUFFIX(const OcclusionPlane& p, int n, bool first, float* out) {   \
    if (first) {                                                                         \
      add_plane<float, false, false, true>(p, n, out, nullptr, nullptr, nullptr);        \
    } else {                                                                             \
      add_plane<float, false, false, false>(p, n, out, nullptr, nullptr, nullptr);       \
    }                                                                                    \
  }

PROSPECT_OCCLUSION_KERNEL(generic, )
#if defined(__x86_64__)
PROSPECT_OCCLUSION_KERNEL(avx2, PROSPECT_TARGET_AVX2)
PROSPECT_OCCLUSION_KERNEL(avx512, PROSPECT_TARGET_AVX512)
#endif
#undef PROSPECT_OCCLUSION_KERNEL

}  // namespace

OcclusionKernel occlusion_kernel([[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return evaluate_avx512;
  if (set == InstructionSet::kAvx2) return evaluate_avx2;
#endif
  return evaluate_generic;
}

OcclusionScoreKernel occlusion_score_kernel([[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return score_avx512;
  if (set == InstructionSet::kAvx2) return score_avx2;
#endif
  return score_generic;
}

}  // namespace prospect
