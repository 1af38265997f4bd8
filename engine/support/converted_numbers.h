// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>

namespace prospect {

/// The same numbers in another type, Of<double> to Of<T>, where Of has numbers of one type for
/// members and nothing else: what a kernel that is compiled for several types is given.
template <template <typename> class Of, typename T>
[[gnu::always_inline]] inline Of<T> converted_numbers(const Of<double>& from) {
  constexpr std::size_t n = sizeof(from) / sizeof(double);
  const auto numbers = std::bit_cast<std::array<double, n>>(from);
  std::array<T, n> to;
  for (std::size_t i = 0; i < n; ++i) to[i] = static_cast<T>(numbers[i]);
  return std::bit_cast<Of<T>>(to);
}

}  // namespace prospect
