// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/image_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace prospect {

double image_noise(const ImageView& image) {
  constexpr double kRounding = 0.2887;       // 1 / sqrt(12)
  constexpr double kLowerQuartile = 0.3186;  // of |x|, x ~ N(0, 1)
  constexpr int kStep = 3;
  std::array<int, 16 * 255 + 1> count{};
  int all = 0;
  for (int v = 1; v + 1 < image.height; v += kStep) {
    const std::uint8_t *above = image.row(v - 1), *here = image.row(v), *below = image.row(v + 1);
    for (int u = 1; u + 1 < image.width; u += kStep) {
      const int top = above[u - 1] - 2 * above[u] + above[u + 1];
      const int middle = here[u - 1] - 2 * here[u] + here[u + 1];
      const int bottom = below[u - 1] - 2 * below[u] + below[u + 1];
      ++count[static_cast<std::size_t>(std::abs(top - 2 * middle + bottom))];
      ++all;
    }
  }
  // |L| is a whole number: n stands for all from n - 1/2 to n + 1/2.
  double below = 0.0;
  const double wanted = 0.25 * all;
  std::size_t n = 0;
  while (n + 1 < count.size() && below + count[n] < wanted) below += count[n++];
  if (all == 0 || count[n] == 0) return kRounding;
  const double from = n == 0 ? 0.0 : n - 0.5, width = n == 0 ? 0.5 : 1.0;
  const double quartile = from + width * (wanted - below) / count[n];
  return std::max(kRounding, quartile / kLowerQuartile / 6.0);
}

}  // namespace prospect
