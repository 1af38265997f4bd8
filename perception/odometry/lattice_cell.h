// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace prospect {

/// The cell that holds a position (finite), of the lattice of cubes of side `size` with a corner at
/// the origin, as one number. Cells 2^21 sides apart share theirs.
inline std::uint64_t lattice_cell(const Eigen::Vector3d& position, double size) {
  std::uint64_t key = 0;
  for (int i = 0; i < 3; ++i) {
    const auto cell = static_cast<std::int64_t>(std::floor(position[i] / size));
    key = key << 21 | (static_cast<std::uint64_t>(cell) & 0x1FFFFF);
  }
  return key;
}

}  // namespace prospect
