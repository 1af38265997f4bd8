// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/texture_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace prospect {
namespace {

constexpr float kFarthest = 2e5f;   // repeats of a texture; floats tell no more
constexpr float kSteepest = 1e10f;  // squared length of a footprint [texels^2]
constexpr int kMaxTaps = 4;         // along the longer axis of a footprint
constexpr float kHalfAndRounding = 128.5f;

// std::floor of numbers that fit an int; without SSE 4.1 it is a call.
PROSPECT_FORCE_INLINE float whole_below(float x) {
  const auto whole = static_cast<float>(static_cast<std::int32_t>(x));
  return whole > x ? whole - 1.0f : whole;
}

// log2 of a positive number, linear between powers of two: the same everywhere, and near enough for
// a level of detail.
PROSPECT_FORCE_INLINE float rough_log2(float x) {
  return static_cast<float>(std::bit_cast<std::int32_t>(x)) * 0x1p-23f - 127.0f;
}

// A place within a level: of its upper left texel, and how far from it towards the others, in
// 256ths: whole numbers are quicker here than floating point.
struct Place {
  std::int32_t at, right, below;
};

// Of 0 <= u, v <= 1, in the level `l`.
PROSPECT_FORCE_INLINE Place place_of(const TexturePyramid::Texels& t, std::int32_t l, float u,
                                     float v) {
  // Within the padded level: texel (0, 0) is at (1, 1), and its centre half a texel further.
  const auto x = static_cast<std::int32_t>(u * t.columns[l] + kHalfAndRounding);
  const auto y = static_cast<std::int32_t>(v * t.rows[l] + kHalfAndRounding);
  return {t.offset[l] + (y >> 8) * t.stride[l] + (x >> 8), x & 255, y & 255};
}

// The four texels there, bytes from the lowest on: upper left, upper right, lower left, lower
// right.
PROSPECT_FORCE_INLINE std::uint32_t four_at(const TexturePyramid::Texels& t, std::int32_t l,
                                            std::int32_t at) {
  const std::uint8_t* upper = t.grey + at;
  const std::uint8_t* lower = upper + t.stride[l];
  return static_cast<std::uint32_t>(upper[0] | upper[1] << 8 | lower[0] << 16) |
         static_cast<std::uint32_t>(lower[1]) << 24;
}

PROSPECT_FORCE_INLINE float between(std::uint32_t four, std::int32_t right, std::int32_t below) {
  const auto at = [&](int n) { return static_cast<std::int32_t>((four >> n) & 255u); };
  const std::int32_t upper = at(0) * (256 - right) + at(8) * right;
  const std::int32_t lower = at(16) * (256 - right) + at(24) * right;
  return static_cast<float>(upper * (256 - below) + lower * below) * 0x1p-16f;
}

// Where to look: for each pixel, taps along (ds, dt) about (s, t), between two levels.
struct Footprints {
  alignas(64) float s[kPacketPixels], t[kPacketPixels];
  alignas(64) float ds[kPacketPixels], dt[kPacketPixels];
  alignas(64) float fraction[kPacketPixels], taps[kPacketPixels];
  alignas(64) std::int32_t fine[kPacketPixels], coarse[kPacketPixels];
};

PROSPECT_FORCE_INLINE void find_footprints(const TexturedView& view, const float* us,
                                           const float* vs, float size, Footprints& out) {
  const float wz = view.inverse_depth[0], wy = view.inverse_depth[1], w0 = view.inverse_depth[2];
  const float s_u = view.s[0], s_v = view.s[1], s_0 = view.s[2];
  const float t_u = view.t[0], t_v = view.t[1], t_0 = view.t[2];
  const float w = view.width, h = view.height;
  const std::int32_t last = view.texels.levels - 1;
  const auto last_level = static_cast<float>(last);
  for (int n = 0; n < kPacketPixels; ++n) {
    const float u = us[n], v = vs[n];
    const float z = 1.0f / (wz * u + wy * v + w0), step = size * z;
    const float s = (s_u * u + s_v * v + s_0) * z, t = (t_u * u + t_v * v + t_0) * z;
    // Derivatives of the texture coordinates by the pixel's, times the size; the footprint's axes.
    const float su = (s_u - s * wz) * step, sv = (s_v - s * wy) * step;
    const float tu = (t_u - t * wz) * step, tv = (t_v - t * wy) * step;
    const float along_u = su * su * w * w + tu * tu * h * h;
    const float along_v = sv * sv * w * w + tv * tv * h * h;
    const float major = along_u > along_v ? along_u : along_v;  // squared
    const float lesser = along_u > along_v ? along_v : along_u;
    const bool sound = (std::abs(s) < kFarthest) & (std::abs(t) < kFarthest) & (major < kSteepest);
    const float minor = lesser > 1.0f ? lesser : 1.0f;
    float taps = 1.0f;
    for (int k = 1; k < kMaxTaps; ++k) {
      taps += major > minor * static_cast<float>(k) * static_cast<float>(k) ? 1.0f : 0.0f;
    }
    taps = sound ? taps : 1.0f;
    const float magnified = sound ? major / (taps * taps) : 1.0f;
    float level = 0.5f * rough_log2(magnified);
    level = level > 0.0f ? level : 0.0f;
    level = sound & (level < last_level) ? level : last_level;
    const auto fine = static_cast<std::int32_t>(level);
    out.s[n] = sound ? s : 0.0f;
    out.t[n] = sound ? t : 0.0f;
    const float ds = along_u > along_v ? su : sv, dt = along_u > along_v ? tu : tv;
    out.ds[n] = sound ? ds : 0.0f;
    out.dt[n] = sound ? dt : 0.0f;
    out.fine[n] = fine;
    out.coarse[n] = fine < last ? fine + 1 : last;
    out.fraction[n] = level - static_cast<float>(fine);
    out.taps[n] = taps;
  }
}

// Look-ups of all pixels in one level. Reading bytes is no work for vectors; all else is.
PROSPECT_FORCE_INLINE void look_up(const TexturePyramid::Texels& texels, const std::int32_t* level,
                                   const float* s, const float* t, float* grey) {
  alignas(64) std::int32_t at[kPacketPixels], right[kPacketPixels], below[kPacketPixels];
  alignas(64) std::uint32_t four[kPacketPixels];
  for (int n = 0; n < kPacketPixels; ++n) {
    const Place place = place_of(texels, level[n], s[n], t[n]);
    at[n] = place.at;
    right[n] = place.right;
    below[n] = place.below;
  }
  for (int n = 0; n < kPacketPixels; ++n) four[n] = four_at(texels, level[n], at[n]);
  for (int n = 0; n < kPacketPixels; ++n) grey[n] = between(four[n], right[n], below[n]);
}

PROSPECT_FORCE_INLINE void grey_body(const TexturedView& view, const float* us, const float* vs,
                                     float size, float* grey) {
  Footprints at;
  find_footprints(view, us, vs, size, at);
  float most = 1.0f;
  for (int n = 0; n < kPacketPixels; ++n) most = at.taps[n] > most ? at.taps[n] : most;
  alignas(64) float sum[kPacketPixels] = {};
  const TexturePyramid::Texels texels = view.texels;
  alignas(64) float s[kPacketPixels], t[kPacketPixels], a[kPacketPixels], b[kPacketPixels];
  for (float k = 0.0f; k < most; k += 1.0f) {
    for (int n = 0; n < kPacketPixels; ++n) {
      const float offset = (k + 0.5f) * (1.0f / at.taps[n]) - 0.5f;
      const float along_s = at.s[n] + offset * at.ds[n], along_t = at.t[n] + offset * at.dt[n];
      s[n] = along_s - whole_below(along_s);
      t[n] = along_t - whole_below(along_t);
    }
    look_up(texels, at.fine, s, t, a);
    look_up(texels, at.coarse, s, t, b);
    for (int n = 0; n < kPacketPixels; ++n) {
      const float value = a[n] + at.fraction[n] * (b[n] - a[n]);
      sum[n] += static_cast<float>(k < at.taps[n]) * value;
    }
  }
  for (int n = 0; n < kPacketPixels; ++n) {
    grey[n] = view.shade * (sum[n] * (1.0f / at.taps[n]));
  }
}

#define PROSPECT_TEXTURE_KERNEL(SUFFIX, TARGET)                                                   \
  TARGET void grey_##SUFFIX(const TexturedView& view, const float* u, const float* v, float size, \
                            float* grey) {                                                        \
    grey_body(view, u, v, size, grey);                                                            \
  }
PROSPECT_TEXTURE_KERNEL(generic, )
#if defined(__x86_64__)
PROSPECT_TEXTURE_KERNEL(avx2, PROSPECT_TARGET_AVX2)
PROSPECT_TEXTURE_KERNEL(avx512, PROSPECT_TARGET_AVX512)
#endif
#undef PROSPECT_TEXTURE_KERNEL

}  // namespace

TextureKernel texture_kernel([[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return grey_avx512;
  if (set == InstructionSet::kAvx2) return grey_avx2;
#endif
  return grey_generic;
}

float mean_along(const TexturePyramid::Texels& texels, float level, float u, float v, float du,
                 float dv, int taps) {
  const std::int32_t last = texels.levels - 1;
  const bool below = level < static_cast<float>(last);
  const std::int32_t fine = below ? static_cast<std::int32_t>(level) : last;
  const float fraction = below ? level - static_cast<float>(fine) : 0.0f;
  const float share = 1.0f / static_cast<float>(taps);
  float sum = 0.0f;
  const auto bilinear = [&](std::int32_t l, float s, float t) {
    const Place place = place_of(texels, l, s, t);
    return between(four_at(texels, l, place.at), place.right, place.below);
  };
  for (int k = 0; k < taps; ++k) {
    const float offset = (static_cast<float>(k) + 0.5f) * share - 0.5f;
    const float s = u + offset * du, t = v + offset * dv;
    const float a = bilinear(fine, s - whole_below(s), t - whole_below(t));
    const float b = bilinear(std::min(fine + 1, last), s - whole_below(s), t - whole_below(t));
    sum += a + fraction * (b - a);
  }
  return sum * share;
}

}  // namespace prospect
