#include "engine/descent_path.h"

#include <cmath>

namespace prospect {

DescentPath::DescentPath(const CostToGo& cost_to_go, const Eigen::Vector2d& from, double length)
    : points_(cost_to_go.descend(from, length)) {
  if (points_.empty()) points_.push_back(from);
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
  return to.norm() < 0.15 ? otherwise : std::atan2(to.y(), to.x());
}

}  // namespace prospect
