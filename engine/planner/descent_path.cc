// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/descent_path.h"

#include <algorithm>
#include <cmath>

namespace prospect {

DescentPath::DescentPath(const CostToGo& cost_to_go, const Eigen::Vector2d& from, double length)
    : points_(cost_to_go.descend(from, length)) {
  if (points_.empty()) points_.push_back(from);
}

void DescentPath::centre(const ClearanceField& clearance, double z, double enough, double most) {
  constexpr double kStep = 0.01;  // [m]
  const std::vector<Eigen::Vector2d> raw = points_;
  for (std::size_t i = 1; i < raw.size(); ++i) {
    const Eigen::Vector2d along = raw[std::min(i + 1, raw.size() - 1)] - raw[i - 1];
    if (along.norm() < 1e-6) continue;
    const Eigen::Vector2d sideways = Eigen::Vector2d(-along.y(), along.x()).normalized();
    const auto at = [&](double s) {
      const Eigen::Vector2d p = raw[i] + s * sideways;
      return Eigen::Vector3d(p.x(), p.y(), z);
    };
    Eigen::Vector3d gradient;
    double d = clearance.distance(at(0.0), &gradient);
    const double side = gradient.head<2>().dot(sideways) < 0.0 ? -kStep : kStep;
    double gone = 0.0;
    while (d < enough && std::abs(gone + side) <= most + 1e-9) {
      const double next = clearance.distance(at(gone + side));
      if (!(next > d)) break;
      d = next;
      gone += side;
    }
    points_[i] = at(gone).head<2>();
  }
}

double DescentPath::heading(const Eigen::Vector2d& p, double lookahead, double otherwise) const {
  std::size_t at = 0;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    if ((points_[i] - p).squaredNorm() < (points_[at] - p).squaredNorm()) at = i;
  }
  double left = lookahead;
  while (at + 1 < points_.size() && left > 0.0) {
    left -= (points_[at + 1] - points_[at]).norm();
    ++at;
  }
  const Eigen::Vector2d to = points_[at] - p;
  return to.norm() < std::min(0.15, 0.5 * lookahead) ? otherwise : std::atan2(to.y(), to.x());
}

}  // namespace prospect
