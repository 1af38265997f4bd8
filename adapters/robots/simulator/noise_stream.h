// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace prospect {

/// One well-mixed seed for each source of noise (SplitMix64), so that switching one off leaves the
/// others' draws as they were.
enum class NoiseStream : std::uint64_t {
  kActuation,
  kDepth,
  kFeatures,
  kOdometry,
  kPoints,
  kTexture,
  kImages,
  kWheels,
  kTrueStereo,  // of a rig, as all below
  kTrueDepth,
  kStereoMount,
  kDepthMount,
  kLight,
  kDirt,
  kPeople,
  kImu
};
std::uint64_t stream_seed(std::uint64_t seed, NoiseStream stream);

}  // namespace prospect
