// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/frontier_utility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/maps/free_line.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {

FrontierUtility::FrontierUtility(const FrontierUtilityOptions& options) : options_(options) {
  constexpr const char* kOwner = "frontier utility";
  const auto& o = options_;
  check_knobs(kOwner, o);
  check_positive(kOwner, "sensor_range", o.sensor_range);
  check_parameter(o.view_margin < o.sensor_range, kOwner, "view_margin", o.view_margin,
                  "less than sensor_range");
  check_parameter(o.sensor_fov > 0.0 && o.sensor_fov <= 2.0 * std::numbers::pi + 1e-9, kOwner,
                  "sensor_fov", o.sensor_fov, "more than 0, up to 2 pi");
  check_parameter(o.fov_margin >= 0.0 && 2.0 * o.fov_margin < o.sensor_fov, kOwner, "fov_margin",
                  o.fov_margin, "0 to less than half of sensor_fov");
}

void FrontierUtility::map_changed(const GridFrame& frame, const std::vector<Cell>& newly_known,
                                  const std::vector<Cell>& changed, const PausePoint& pause) {
  if (confidence_.data.empty() || !(frame.resolution == confidence_.frame.resolution)) {
    confidence_ = Grid<float>(frame, 1.0F, pause);
    range_ = Grid<float>(frame, static_cast<float>(options_.sensor_range), pause);
    flips_ = Grid<std::uint8_t>(frame, 0, pause);
    given_up_ = Grid<std::uint8_t>(frame, 0, pause);
    return;
  }
  if (!(frame == confidence_.frame)) {
    confidence_.widen(frame, 1.0F, pause);
    range_.widen(frame, static_cast<float>(options_.sensor_range), pause);
    flips_.widen(frame, std::uint8_t{0}, pause);
    given_up_.widen(frame, std::uint8_t{0}, pause);
  }
  const int reach = options_.renewal_cells;
  std::size_t visited = 0;
  const auto visit_near = [&](Cell c, const auto& visit) {
    if (++visited % 128 == 0) pause();
    for (int j = std::max(c.j - reach, frame.j0);
         j <= std::min(c.j + reach, frame.j0 + frame.height - 1); ++j) {
      for (int i = std::max(c.i - reach, frame.i0);
           i <= std::min(c.i + reach, frame.i0 + frame.width - 1); ++i) {
        visit(static_cast<std::size_t>(frame.index({i, j})));
      }
    }
  };
  for (const Cell c : newly_known) {
    visit_near(c, [&](std::size_t at) {
      confidence_.data[at] = 1.0F;
      range_.data[at] = static_cast<float>(options_.sensor_range);
      flips_.data[at] = 0;
      given_up_.data[at] = 0;
    });
  }
  for (const Cell c : changed) {
    visit_near(c, [&](std::size_t at) {
      constexpr std::uint8_t kMost = 20;
      const float renewed = std::ldexp(1.0F, -static_cast<int>(flips_.data[at]) - 1);
      if (confidence_.data[at] >= renewed || flips_.data[at] >= kMost) return;
      confidence_.data[at] = renewed;
      ++flips_.data[at];
    });
  }
}

void FrontierUtility::follow(const PlaceMoves& moves) {
  confidence_ = moved(confidence_, moves, 1.0F);
  range_ = moved(range_, moves, static_cast<float>(options_.sensor_range));
  given_up_ = moved(given_up_, moves, std::uint8_t{0});
  flips_ = moved(flips_, moves, std::uint8_t{0});
}

void FrontierUtility::observation(const Grid<std::uint8_t>& see_through,
                                  const std::vector<Frontier>& frontiers, const Pose& pose,
                                  double stamp, std::optional<Cell> seen_from_here,
                                  const PausePoint& pause) {
  const Eigen::Vector2d eye = pose.position.head<2>();
  if (!eye.allFinite() || !std::isfinite(pose.yaw) || !std::isfinite(stamp)) return;
  if (last_observation_ && stamp >= *last_observation_ &&
      stamp - *last_observation_ < options_.observation_interval - 1e-9) {
    return;
  }
  last_observation_ = stamp;
  const double range = options_.sensor_range - options_.view_margin;
  const double half = 0.5 * options_.sensor_fov - options_.fov_margin;
  const Eigen::Vector2d ahead(std::cos(pose.yaw), std::sin(pose.yaw));
  for (const Frontier& frontier : frontiers) {
    pause();
    for (const Cell c : frontier.cells) {
      const Eigen::Vector2d to = see_through.frame.center(c) - eye;
      if (to.squaredNorm() > range * range) continue;
      const double bearing = std::atan2(ahead.x() * to.y() - ahead.y() * to.x(), ahead.dot(to));
      if (std::abs(bearing) > half) continue;
      if (seen_from_here != c && !line_of_sight(see_through, eye, see_through.frame.center(c))) {
        continue;
      }
      if (!confidence_.frame.contains(c)) continue;
      const double weight = std::clamp(2.0 - 2.0 * to.norm() / options_.sensor_range, 0.0, 1.0);
      confidence_[c] *= static_cast<float>(std::pow(options_.failed_observation, weight));
      const double nearer = std::max(options_.nearest, options_.nearer * to.norm());
      range_[c] = std::min(range_[c], static_cast<float>(nearer));
    }
  }
}

void FrontierUtility::visit_failed(Cell target, const std::vector<Cell>& cells, double resolution) {
  for (const Cell c : cells) {
    if (resolution * std::hypot(c.i - target.i, c.j - target.j) > options_.visit_radius) continue;
    if (!confidence_.frame.contains(c)) continue;
    confidence_[c] *= static_cast<float>(options_.failed_visit);
    given_up_[c] = 1;
  }
}

void FrontierUtility::view_ranges(const Frontier& frontier, std::vector<float>& ranges) const {
  float best = 0.0F;
  for (const Cell c : frontier.cells) best = std::max(best, confidence_.get(c, 1.0F));
  const float least = static_cast<float>(options_.least_confidence) * best;
  ranges.resize(frontier.cells.size());
  for (std::size_t n = 0; n < ranges.size(); ++n) {
    const Cell c = frontier.cells[n];
    const bool counts = confidence_.get(c, 1.0F) >= least;
    ranges[n] = counts ? range_.get(c, static_cast<float>(options_.sensor_range)) : 0.0F;
  }
}

void FrontierUtility::measure(const Traversability& traversability,
                              std::vector<Frontier>& frontiers, const PausePoint& pause) {
  const double r = traversability.frame().resolution;
  constexpr double kSwept = 1.0;  // [rad] that a robot turns while it looks, at least
  const double view =
      0.5 * options_.sensor_range * options_.sensor_range * std::max(options_.sensor_fov, kSwept);
  for (Frontier& f : frontiers) {
    pause();
    f.expected_gain = f.area = 0.0;
    f.confidence = 1.0;
    f.given_up = false;
    if (!f.active) continue;
    double confidence = 0.0;
    for (const Cell c : f.cells) {
      confidence += static_cast<double>(confidence_.get(c, 1.0F));
      f.given_up = f.given_up || given_up_.get(c, 0) != 0;
    }
    confidence /= static_cast<double>(f.cells.size());
    f.confidence = confidence;
    f.expected_gain = std::min(view, r * r * count(traversability, f, pause));
    f.area = yield(f.expected_gain) * confidence * f.expected_gain;
  }
}

std::size_t FrontierUtility::size_class(double expected_gain) {
  std::size_t k = 0;
  for (double limit = 0.5; k < 4 && expected_gain >= limit; limit *= 2.0) ++k;
  return k;
}

void FrontierUtility::learn(double expected_gain, double expected, double shown) {
  constexpr double kNewest = 0.2;
  if (!(expected > 0.0) || !std::isfinite(shown)) return;
  double& y = yields_[size_class(expected_gain)];
  y += kNewest * (std::clamp(shown / expected, 0.05, 1.0) - y);
}

int FrontierUtility::count(const Traversability& traversability, const Frontier& frontier,
                           const PausePoint& pause) {
  const double r = traversability.frame().resolution;
  const double opening = std::min(options_.opening, traversability.clearance_limit());
  const int steps = static_cast<int>(std::floor(options_.depth / r + 1e-9));
  int i0 = frontier.cells.front().i, i1 = i0;
  for (const Cell c : frontier.cells) {
    i0 = std::min(i0, c.i);
    i1 = std::max(i1, c.i);
  }
  const int j0 = frontier.cells.front().j, j1 = frontier.cells.back().j;  // in scan order
  visited_.frame = {r, i0 - steps, j0 - steps, i1 - i0 + 1 + 2 * steps, j1 - j0 + 1 + 2 * steps};
  assign_in_pieces(visited_.data, static_cast<std::size_t>(visited_.frame.size()), std::uint8_t{0},
                   pause);
  queue_.clear();

  const auto visit = [&](Cell c) {
    std::uint8_t& visited = visited_[c];
    if (visited != 0) return;
    visited = 1;
    // Beyond the map everything is unknown and clear.
    if (traversability.state(c) == CellState::kUnknown && traversability.clearance(c) >= opening) {
      queue_.push_back(c);
    }
  };
  for (const Cell c : frontier.cells) visit(c);
  std::size_t next = 0;
  for (int step = 0; step < steps && next < queue_.size(); ++step) {
    for (const std::size_t end = queue_.size(); next < end; ++next) {
      if (next % 256 == 0) pause();
      const Cell c = queue_[next];
      visit({c.i + 1, c.j});
      visit({c.i - 1, c.j});
      visit({c.i, c.j + 1});
      visit({c.i, c.j - 1});
    }
  }
  return static_cast<int>(queue_.size());
}

void describe(Knobs& knobs, FrontierUtilityOptions& o) {
  knobs.number("depth", o.depth, {0.0, 10.0}, "m", "how far behind a frontier its area counts");
  knobs.number("opening", o.opening, {0.0, 1.0}, "m", "clearance of unknown ground that counts");
  knobs.number("failed_observation", o.failed_observation, {0.01, 0.99}, "1",
               "factor on the confidence in a cell that an observation did not resolve");
  knobs.number("failed_visit", o.failed_visit, {0.01, 0.99}, "1",
               "the same near a target that was given up");
  knobs.number("visit_radius", o.visit_radius, {0.01, 100.0}, "m",
               "around the target, in which a visit counts");
  knobs.number("observation_interval", o.observation_interval, {0.0, 100.0}, "s",
               "steps closer in time than this count as one observation");
  knobs.number("view_margin", o.view_margin, {0.0, 10.0}, "m",
               "a cell counts as in view this much within the sensor's range");
  knobs.number("fov_margin", o.fov_margin, {0.0, 3.0}, "rad",
               "of the field of view, left out at either side");
  knobs.integer("renewal_cells", o.renewal_cells, {0, 50}, "1",
                "a change of the map this near renews the confidence in a cell");
  knobs.number("least_confidence", o.least_confidence, {0.01, 0.99}, "1",
               "share of the best cell's confidence below which one is not led to");
  knobs.number("nearer", o.nearer, {0.01, 0.99}, "1",
               "share of an observation's distance within which the next one must be");
  knobs.number("nearest", o.nearest, {0.01, 10.0}, "m", "that no observation must be nearer than");
}

}  // namespace prospect
