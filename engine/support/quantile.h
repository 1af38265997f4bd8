// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace prospect {

/// The smallest value that at least a share q of the values does not exceed (nearest rank), q in
/// [0, 1], at 0 the smallest; no interpolation, so infinite values are as good as any. Not a number
/// without values.
double quantile(std::vector<double> values, double q);

}  // namespace prospect
