// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/still_view.h"

#include <algorithm>
#include <cmath>

namespace prospect {
namespace {

constexpr int kColumns = 8, kRows = 6;
constexpr double kLeastContrast = 3.0;           // grey levels
constexpr double kStill = 0.95, kChanged = 0.8;  // correlation

}  // namespace

StillView still_view(const PyramidLevel& before, const PyramidLevel& now) {
  StillView view;
  if (before.width != now.width || before.height != now.height) return view;
  for (int part = 0; part < kColumns * kRows; ++part) {
    const int column = part % kColumns, row = part / kColumns;
    const int u0 = column * now.width / kColumns, u1 = (column + 1) * now.width / kColumns;
    const int v0 = row * now.height / kRows, v1 = (row + 1) * now.height / kRows;
    double n = 0, aa = 0, bb = 0, ab = 0;
    for (int v = v0; v < v1; ++v) {
      double a = 0, b = 0;
      for (int u = u0; u < u1; ++u) {
        a += before.row(v)[u];
        b += now.row(v)[u];
      }
      a /= std::max(1, u1 - u0);
      b /= std::max(1, u1 - u0);
      for (int u = u0; u < u1; ++u) {
        const double x = before.row(v)[u] - a, y = now.row(v)[u] - b;
        n += 1;
        aa += x * x;
        bb += y * y;
        ab += x * y;
      }
    }
    if (n < 2) continue;
    const double va = aa / n, vb = bb / n;
    constexpr double kLeast = kLeastContrast * kLeastContrast;
    if (va < kLeast && vb < kLeast) continue;
    const double correlation = ab / n / std::sqrt(std::max(va * vb, 1e-9));
    view.still += correlation >= kStill;
    view.changed += correlation < kChanged;
  }
  return view;
}

}  // namespace prospect
