// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/image_shift.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace prospect {

namespace {

/// Sums over the pixels of two images that lie on each other.
struct Overlap {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  /// Normalised correlation; -1 where there is less than one grey level to see.
  double correlation() const {
    const double va = aa - a * a / n, vb = bb - b * b / n;
    return va > n && vb > n ? (ab - a * b / n) / std::sqrt(va * vb) : -1.0;
  }
};

/// Pixel (u, v) of `a` on (u + du, v + dv) of `b`.
template <bool kPart>
Overlap overlap(const PyramidLevel& a, const PyramidLevel& b, int du, int dv,
                const std::vector<char>& part) {
  const int u0 = std::max(0, -du), u1 = std::min(a.width, a.width - du);
  const int v0 = std::max(0, -dv), v1 = std::min(a.height, a.height - dv);
  Overlap sum;
  for (int v = v0; v < v1; ++v) {
    const float* row_a = a.row(v);
    const float* row_b = b.row(v + dv) + du;
    float n = 0, ra = 0, rb = 0, raa = 0, rbb = 0, rab = 0;
    for (int u = u0; u < u1; ++u) {
      if (kPart && !part[static_cast<std::size_t>(v) * a.width + u]) continue;
      const float x = row_a[u], y = row_b[u];
      n += 1;
      ra += x;
      rb += y;
      raa += x * x;
      rbb += y * y;
      rab += x * y;
    }
    sum.n += n;
    sum.a += ra;
    sum.b += rb;
    sum.aa += raa;
    sum.bb += rbb;
    sum.ab += rab;
  }
  return sum;
}

}  // namespace

std::optional<Eigen::Vector2d> image_shift(const PyramidLevel& a, const PyramidLevel& b,
                                           double min_correlation, const std::vector<char>& part) {
  if (a.width != b.width || a.height != b.height) return std::nullopt;
  const int reach_u = static_cast<int>(0.45 * a.width), reach_v = static_cast<int>(0.30 * a.height);
  double best = min_correlation;
  std::optional<Eigen::Vector2d> shift;
  for (int dv = -reach_v; dv <= reach_v; ++dv) {
    for (int du = -reach_u; du <= reach_u; ++du) {
      const Overlap sum =
          part.empty() ? overlap<false>(a, b, du, dv, part) : overlap<true>(a, b, du, dv, part);
      if (sum.correlation() > best) {
        best = sum.correlation();
        shift = Eigen::Vector2d(du, dv);
      }
    }
  }
  return shift;
}

}  // namespace prospect
