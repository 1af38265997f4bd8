// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/noise_stream.h"

#include "models/mixed_bits.h"

namespace prospect {

std::uint64_t stream_seed(std::uint64_t seed, NoiseStream stream) {
  return mixed_bits(seed + static_cast<std::uint64_t>(stream) * 0x9E3779B97F4A7C15ULL);
}

}  // namespace prospect
