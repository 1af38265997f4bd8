// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <random>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "engine/maps/grid.h"
#include "models/types.h"

namespace prospect {

/// A drive from place to place over the columns on which the robot has ample room.
class Tour {
 public:
  Tour(Grid<std::uint8_t> places, std::uint64_t seed)
      : places_(std::move(places)), generator_(static_cast<std::uint32_t>(seed)) {
    for (int n = 0; n < places_.frame.size(); ++n) {
      if (places_.data[static_cast<std::size_t>(n)] != 0) cells_.push_back(n);
    }
    if (cells_.empty()) throw InputError("a tour: no room to drive in");
  }

  Twist command(const Pose& pose) {
    if (way_.data.empty() || distance(pose) < 0.3 || ++waited_ > kPatience) next_place();
    const double best = distance(pose);
    if (best < nearest_ - 0.02) {
      nearest_ = best;
      waited_ = 0;
    }
    const Eigen::Vector2d ahead = aim(pose) - pose.position.head<2>();
    const double turn = std::remainder(std::atan2(ahead.y(), ahead.x()) - pose.yaw, 2.0 * M_PI);
    const double w = std::clamp(2.0 * turn, -kTurn, kTurn);
    const double v = kSpeed * std::pow(std::max(0.0, std::cos(turn)), 4);
    speed_ += std::clamp(v - speed_, -0.05, 0.05);
    turning_ += std::clamp(w - turning_, -0.2, 0.2);
    Twist twist;
    twist.linear.x() = speed_;
    twist.yaw_rate = turning_;
    return twist;
  }

 private:
  static constexpr double kSpeed = 0.5, kTurn = 0.8;  // [m/s], [rad/s]
  static constexpr int kPatience = 80;                // commands without coming nearer
  static constexpr float kFar = 1e9f;

  void next_place() {
    const auto drawn = static_cast<std::size_t>(generator_()) % cells_.size();
    flood(cells_[drawn]);
    nearest_ = kFar;
    waited_ = 0;
  }
  /// Ways to a cell over places, by the eight neighbours [m].
  void flood(int target) {
    way_.frame = places_.frame;
    way_.data.assign(places_.data.size(), kFar);
    using Entry = std::pair<float, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    way_.data[static_cast<std::size_t>(target)] = 0.0f;
    open.push({0.0f, target});
    while (!open.empty()) {
      const auto [d, n] = open.top();
      open.pop();
      if (d > way_.data[static_cast<std::size_t>(n)]) continue;
      const Cell c = places_.frame.at(n);
      for (int di = -1; di <= 1; ++di) {
        for (int dj = -1; dj <= 1; ++dj) {
          const Cell to{c.i + di, c.j + dj};
          if (!places_.frame.contains(to)) continue;
          const auto m = static_cast<std::size_t>(places_.frame.index(to));
          if (places_.data[m] == 0) continue;
          const auto further =
              static_cast<float>(d + places_.frame.resolution * std::hypot(di, dj));
          if (further >= way_.data[m] - 1e-6f) continue;
          way_.data[m] = further;
          open.push({further, static_cast<int>(m)});
        }
      }
    }
  }
  /// The place nearest to a pose.
  Cell at(const Pose& pose) const {
    const Cell here = places_.frame.cell(pose.position.x(), pose.position.y());
    for (int ring = 0; ring < 20; ++ring) {
      Cell best{};
      double nearest = kFar;
      for (int i = here.i - ring; i <= here.i + ring; ++i) {
        for (int j = here.j - ring; j <= here.j + ring; ++j) {
          const Cell c{i, j};
          if (!places_.frame.contains(c)) continue;
          if (places_.data[static_cast<std::size_t>(places_.frame.index(c))] == 0) continue;
          const double d = (places_.frame.center(c) - pose.position.head<2>()).norm();
          if (d >= nearest) continue;
          nearest = d;
          best = c;
        }
      }
      if (nearest < kFar) return best;
    }
    return here;
  }
  float way(const Cell& c) const {
    return places_.frame.contains(c) ? way_.data[static_cast<std::size_t>(places_.frame.index(c))]
                                     : kFar;
  }
  double distance(const Pose& pose) const { return way(at(pose)); }
  /// Half a metre down the way.
  Eigen::Vector2d aim(const Pose& pose) const {
    Cell c = at(pose);
    double gone = 0.0;
    while (gone < 0.5 && way(c) > 0.0f) {
      Cell best = c;
      for (int di = -1; di <= 1; ++di) {
        for (int dj = -1; dj <= 1; ++dj) {
          const Cell to{c.i + di, c.j + dj};
          if (way(to) < way(best)) best = to;
        }
      }
      if (best.i == c.i && best.j == c.j) break;
      gone += way(c) - way(best);
      c = best;
    }
    return places_.frame.center(c);
  }

  Grid<std::uint8_t> places_;
  std::vector<int> cells_;
  std::mt19937 generator_;
  Grid<float> way_;
  double nearest_ = kFar;
  int waited_ = 0;
  double speed_ = 0.0, turning_ = 0.0;
};

}  // namespace prospect
