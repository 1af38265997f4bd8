// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "models/mixed_bits.h"

namespace prospect {

/// Random numbers in a row from one hash: the same with every library.
class HashedDraws {
 public:
  explicit HashedDraws(std::uint64_t seed) : state_(seed) {}

  double uniform() { return unit_interval(state_ = mixed_bits(state_)); }  ///< in [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Mean 0, variance 1, at most 3.5: the sum of four uniform numbers.
  double normal() {
    double sum = -2.0;
    for (int n = 0; n < 4; ++n) sum += uniform();
    return std::sqrt(3.0) * sum;
  }

 private:
  std::uint64_t state_;
};

}  // namespace prospect
