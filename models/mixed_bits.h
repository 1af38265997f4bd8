// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace prospect {

/// The output function of SplitMix64 (Steele, Lea and Flood, 2014) as a hash: for what is random,
/// but a function of a place or a number alone.
inline std::uint64_t mixed_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// A number in [0, 1) of such bits.
inline double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace prospect
