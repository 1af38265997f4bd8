// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "models/mixed_bits.h"

namespace prospect {

/// The random numbers of one image: a function of (seed, frame, camera, pixel) alone, so images do
/// not depend on which were taken before. Immutable.
class PixelNoise {
 public:
  PixelNoise(std::uint64_t seed, std::uint64_t frame, std::uint64_t camera) {
    const std::uint64_t key = mixed_bits(mixed_bits(mixed_bits(seed) ^ frame) ^ camera);
    low_ = static_cast<std::uint32_t>(key);
    high_ = static_cast<std::uint32_t>(key >> 32);
  }
  /// 32 random bits of a pixel: an integer hash in two rounds, keyed before each.
  std::uint32_t bits(std::uint32_t pixel) const {
    std::uint32_t h = pixel * 0x9e3779b9u + low_;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = ((h ^ (h >> 15)) + high_) * 0x846ca68bu;
    return h ^ (h >> 16);
  }
  /// Mean 0, variance 1, at most 3.5: the sum of four uniform bytes.
  float gaussian(std::uint32_t pixel) const {
    const std::uint32_t a = bits(pixel);
    const auto sum =
        static_cast<int>((a & 255u) + ((a >> 8) & 255u) + ((a >> 16) & 255u) + (a >> 24));
    return static_cast<float>(sum - 510) * (1.0f / 147.8f);
  }

 private:
  std::uint32_t low_, high_;
};

}  // namespace prospect
