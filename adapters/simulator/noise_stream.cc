#include "adapters/simulator/noise_stream.h"

namespace prospect {

std::uint64_t stream_seed(std::uint64_t seed, NoiseStream stream) {
  std::uint64_t z = seed + (static_cast<std::uint64_t>(stream) + 1) * 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

}  // namespace prospect
