// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/image_shift.h"

#include <algorithm>
#include <cmath>

namespace prospect {

std::optional<Eigen::Vector2d> image_shift(const PyramidLevel& a, const PyramidLevel& b,
                                           double min_correlation) {
  if (a.width != b.width || a.height != b.height) return std::nullopt;
  const int reach_u = static_cast<int>(0.45 * a.width), reach_v = static_cast<int>(0.30 * a.height);
  double best = min_correlation;
  std::optional<Eigen::Vector2d> shift;
  for (int dv = -reach_v; dv <= reach_v; ++dv) {
    for (int du = -reach_u; du <= reach_u; ++du) {
      const int u0 = std::max(0, -du), u1 = std::min(a.width, a.width - du);
      const int v0 = std::max(0, -dv), v1 = std::min(a.height, a.height - dv);
      double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
      for (int v = v0; v < v1; ++v) {
        const float* row_a = a.row(v);
        const float* row_b = b.row(v + dv) + du;
        float ra = 0, rb = 0, raa = 0, rbb = 0, rab = 0;
        for (int u = u0; u < u1; ++u) {
          const float x = row_a[u], y = row_b[u];
          ra += x;
          rb += y;
          raa += x * x;
          rbb += y * y;
          rab += x * y;
        }
        sa += ra;
        sb += rb;
        saa += raa;
        sbb += rbb;
        sab += rab;
      }
      const double n = static_cast<double>(u1 - u0) * (v1 - v0);
      const double va = saa - sa * sa / n, vb = sbb - sb * sb / n;
      if (!(va > n && vb > n)) continue;  // less than one grey level: nothing to see
      const double correlation = (sab - sa * sb / n) / std::sqrt(va * vb);
      if (correlation > best) {
        best = correlation;
        shift = Eigen::Vector2d(du, dv);
      }
    }
  }
  return shift;
}

}  // namespace prospect
