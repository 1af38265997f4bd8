#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace prospect {

/// The smallest value that at least a share q of the values does not exceed (nearest rank), q in
/// (0, 1]; no interpolation, so infinite values are as good as any. Not a number without values.
inline double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(q * static_cast<double>(values.size()) - 1e-9);
  const auto index = static_cast<std::size_t>(std::max(1.0, rank)) - 1;
  return values[std::min(index, values.size() - 1)];
}

}  // namespace prospect
