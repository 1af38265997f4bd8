// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/cost_to_go.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace prospect {
namespace {

/// Values (and first and second derivatives) of the four cubic B-splines that reach t in [0, 1).
struct Basis {
  double w[4], d[4], h[4];
};

template <int kOrder>
Basis basis(double t) {
  Basis b;
  const double s = 1.0 - t;
  b.w[0] = s * s * s / 6.0;
  b.w[1] = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
  b.w[2] = (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0;
  b.w[3] = t * t * t / 6.0;
  if constexpr (kOrder >= 1) {
    b.d[0] = -0.5 * s * s;
    b.d[1] = 1.5 * t * t - 2.0 * t;
    b.d[2] = -1.5 * s * s + 2.0 * s;
    b.d[3] = 0.5 * t * t;
  }
  if constexpr (kOrder >= 2) {
    b.h[0] = s;
    b.h[1] = 3.0 * t - 2.0;
    b.h[2] = 3.0 * s - 2.0;
    b.h[3] = t;
  }
  return b;
}

}  // namespace

CostToGo::CostToGo()
    : seconds_(GridFrame{0.1, 0, 0, 1, 1}, 0.0), reached_(GridFrame{0.1, 0, 0, 1, 1}, 0) {}

CostToGo::CostToGo(Grid<double> seconds, Grid<std::uint8_t> reached, double v_max)
    : seconds_(std::move(seconds)), reached_(std::move(reached)), v_max_(v_max) {
  const GridFrame& f = seconds_.frame;
  if (f.width < 1 || f.height < 1 || !(f.resolution > 0.0) || !(f == reached_.frame) ||
      seconds_.data.size() != static_cast<std::size_t>(f.size()) ||
      reached_.data.size() != seconds_.data.size()) {
    throw std::invalid_argument(
        "cost-to-go: frames of values and reached cells; expected the same, not empty");
  }
  if (!(v_max > 0.0) || !std::isfinite(v_max)) {
    throw std::invalid_argument("cost-to-go: v_max = " + std::to_string(v_max) +
                                "; expected more than 0");
  }
  lowest_ = seconds_.data.front();
  for (const double v : seconds_.data) {
    if (!std::isfinite(v)) throw std::invalid_argument("cost-to-go: a value is not finite");
    lowest_ = std::min(lowest_, v);
  }
}

template <int kOrder>
void CostToGo::evaluate(double x, double y, double* out) const {
  const GridFrame& f = seconds_.frame;
  const double inverse = 1.0 / f.resolution;
  double u = x * inverse - 0.5 - f.i0;
  double v = y * inverse - 0.5 - f.j0;
  if (!std::isfinite(u) || !std::isfinite(v)) {
    std::fill(out,
              out + (kOrder == 0   ? 1
                     : kOrder == 1 ? 3
                                   : 6),
              std::numeric_limits<double>::quiet_NaN());
    return;
  }
  // Past three cells beyond the rim all coefficients are the rim's: nothing changes farther out.
  u = std::clamp(u, -3.0, f.width + 2.0);
  v = std::clamp(v, -3.0, f.height + 2.0);
  const int i = static_cast<int>(std::floor(u));
  const int j = static_cast<int>(std::floor(v));
  const Basis bx = basis<kOrder>(u - i);
  const Basis by = basis<kOrder>(v - j);
  int column[4];
  for (int a = 0; a < 4; ++a) column[a] = std::clamp(i - 1 + a, 0, f.width - 1);
  double value = 0.0, gx = 0.0, gy = 0.0, hxx = 0.0, hxy = 0.0, hyy = 0.0;
  for (int b = 0; b < 4; ++b) {
    const double* row =
        seconds_.data.data() +
        static_cast<std::ptrdiff_t>(std::clamp(j - 1 + b, 0, f.height - 1)) * f.width;
    double w = 0.0, d = 0.0, h = 0.0;
    for (int a = 0; a < 4; ++a) {
      const double c = row[column[a]];
      w += bx.w[a] * c;
      if constexpr (kOrder >= 1) d += bx.d[a] * c;
      if constexpr (kOrder >= 2) h += bx.h[a] * c;
    }
    value += by.w[b] * w;
    if constexpr (kOrder >= 1) {
      gx += by.w[b] * d;
      gy += by.d[b] * w;
    }
    if constexpr (kOrder >= 2) {
      hxx += by.w[b] * h;
      hxy += by.d[b] * d;
      hyy += by.h[b] * w;
    }
  }
  out[0] = value;
  if constexpr (kOrder >= 1) {
    out[1] = gx * inverse;
    out[2] = gy * inverse;
  }
  if constexpr (kOrder >= 2) {
    out[3] = hxx * inverse * inverse;
    out[4] = hxy * inverse * inverse;
    out[5] = hyy * inverse * inverse;
  }
}

double CostToGo::value(double x, double y) const {
  double out[1];
  evaluate<0>(x, y, out);
  return out[0];
}

double CostToGo::value(const Eigen::Vector2d& p, Eigen::Vector2d& gradient) const {
  double out[3];
  evaluate<1>(p.x(), p.y(), out);
  gradient << out[1], out[2];
  return out[0];
}

double CostToGo::value(const Eigen::Vector2d& p, Eigen::Vector2d& gradient,
                       Eigen::Matrix2d& hessian) const {
  double out[6];
  evaluate<2>(p.x(), p.y(), out);
  gradient << out[1], out[2];
  hessian << out[3], out[4], out[4], out[5];
  return out[0];
}

std::vector<Eigen::Vector2d> CostToGo::descend(const Eigen::Vector2d& start,
                                               double max_length) const {
  std::vector<Eigen::Vector2d> path;
  if (!start.allFinite() || start.cwiseAbs().maxCoeff() > 1e8 * seconds_.frame.resolution) {
    return path;
  }
  const GridFrame& f = seconds_.frame;
  const double step = 0.5 * f.resolution;
  double length = 0.0;
  path.push_back(start);
  const auto go = [&](const Eigen::Vector2d& to) {
    const Eigen::Vector2d from = path.back();
    const double distance = (to - from).norm();
    const int pieces = std::max(1, static_cast<int>(std::ceil(distance / step - 1e-9)));
    for (int k = 1; k <= pieces && length < max_length; ++k) {
      path.push_back(from + (to - from) * (static_cast<double>(k) / pieces));
      length += distance / pieces;
    }
  };

  Cell cell = f.cell(start.x(), start.y());
  if (!reached(cell)) {
    double least = std::numeric_limits<double>::infinity();
    Cell nearest = cell;
    for (int k = 0; k < f.size(); ++k) {
      if (reached_.data[static_cast<std::size_t>(k)] == 0) continue;
      const double d = (f.center(f.at(k)) - start).squaredNorm();
      if (d < least) {
        least = d;
        nearest = f.at(k);
      }
    }
    if (!std::isfinite(least)) return path;
    go(f.center(nearest));
    cell = nearest;
  }
  // Steps along the gradient must get below every V on the path so far, steps over cells below
  // every cell taken so: it cannot run in a circle.
  double lowest = std::numeric_limits<double>::infinity();
  double lowest_cell = std::numeric_limits<double>::infinity();
  while (length < max_length) {
    const Eigen::Vector2d p = path.back();
    Eigen::Vector2d gradient;
    lowest = std::min(lowest, value(p, gradient));
    const double slope = gradient.norm();
    if (slope > 1e-9) {
      const Eigen::Vector2d q = p - gradient * (step / slope);
      const Cell next = f.cell(q.x(), q.y());
      const bool straight = next.i == cell.i || next.j == cell.j ||
                            (reached({next.i, cell.j}) && reached({cell.i, next.j}));
      if (reached(next) && straight && value(q) < lowest - 1e-9) {
        go(q);
        cell = next;
        continue;
      }
    }
    lowest_cell = std::min(lowest_cell, seconds_[cell]);
    Cell best = cell;
    double steepest = 0.0;
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        const Cell n{cell.i + di, cell.j + dj};
        if ((di == 0 && dj == 0) || !reached(n) || seconds_[n] >= lowest_cell) continue;
        if (di != 0 && dj != 0 && (!reached({n.i, cell.j}) || !reached({cell.i, n.j}))) continue;
        const double fall = (seconds_[cell] - seconds_[n]) / std::hypot(di, dj);
        if (fall > steepest) {
          steepest = fall;
          best = n;
        }
      }
    }
    if (best == cell) break;
    go(f.center(best));
    cell = best;
  }
  return path;
}

}  // namespace prospect
