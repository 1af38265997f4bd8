// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/retreat.h"

#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace prospect {

void RetreatTrail::note(const Eigen::Vector2d& position, int tracked, double spacing) {
  if (!position.allFinite()) return;
  if (!places_.empty() && (places_.back() - position).norm() < spacing) return;
  places_.push_back(position);
  tracked_ = tracked;
}

void RetreatTrail::follow(const PlaceMoves& moves) {
  for (Eigen::Vector2d& place : places_) place = moves.now(place);
}

std::shared_ptr<const CostToGo> RetreatTrail::cost_to_go(const Traversability& traversability,
                                                         const Eigen::Vector2d& robot, double v_max,
                                                         double away, double reach) const {
  if (!robot.allFinite()) return nullptr;
  return cost_to_go(factors_around(robot, traversability, reach), robot, v_max, away);
}

Grid<float> RetreatTrail::factors_around(const Eigen::Vector2d& robot,
                                         const Traversability& traversability, double reach) {
  const GridFrame& whole = traversability.frame();
  Grid<float> factors(frame_around(whole.cell(robot.x(), robot.y()), reach, whole.resolution),
                      0.0F);
  for (int n = 0; n < factors.frame.size(); ++n) {
    factors.data[static_cast<std::size_t>(n)] = traversability.factor(factors.frame.at(n));
  }
  return factors;
}

std::shared_ptr<const CostToGo> RetreatTrail::cost_to_go(const Grid<float>& factors,
                                                         const Eigen::Vector2d& robot, double v_max,
                                                         double away,
                                                         const PausePoint& pause) const {
  if (!robot.allFinite() || places_.empty()) return nullptr;
  const GridFrame& frame = factors.frame;
  const double r = frame.resolution;
  Grid<double> cost(frame, std::numeric_limits<double>::infinity());

  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto seed = [&](bool far_only) {
    for (const Eigen::Vector2d& p : places_) {
      const Cell c = frame.cell(p.x(), p.y());
      if (!frame.contains(c) || (far_only && (p - robot).norm() < away)) continue;
      if (cost[c] == 0.0) continue;
      cost[c] = 0.0;
      open.emplace(0.0, frame.index(c));
    }
  };
  seed(true);
  if (open.empty()) seed(false);
  if (open.empty()) return nullptr;

  std::size_t taken = 0;
  while (!open.empty()) {
    if (++taken % 64 == 0) pause();
    const auto [value, index] = open.top();
    open.pop();
    const Cell c = frame.at(index);
    if (value > cost[c]) continue;
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        const Cell n{c.i + di, c.j + dj};
        if ((di == 0 && dj == 0) || !frame.contains(n)) continue;
        const float factor = factors[n];
        const double step = r * (di != 0 && dj != 0 ? M_SQRT2 : 1.0) *
                            (factor > 0.0F ? static_cast<double>(factor) : 3.0);
        if (value + step < cost[n]) {
          cost[n] = value + step;
          open.emplace(cost[n], frame.index(n));
        }
      }
    }
  }
  for (double& value : cost.data) value /= v_max;
  return std::make_shared<const CostToGo>(std::move(cost), Grid<std::uint8_t>(frame, 1), v_max);
}

}  // namespace prospect
