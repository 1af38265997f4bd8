#include "engine/frontier_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <unordered_set>

#include "engine/free_line.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

std::uint64_t address(int i, int j) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(j)) << 32) |
         static_cast<std::uint32_t>(i);
}

double distance(Cell a, Cell b, double resolution) {
  return resolution * std::hypot(static_cast<double>(a.i) - b.i, static_cast<double>(a.j) - b.j);
}

}  // namespace

FrontierMemory::FrontierMemory(const FrontierMemoryOptions& options)
    : options_(options), progress_(options.progress), retry_area_(options.retry_area) {
  const auto& o = options_;
  const auto positive = [](const char* name, double value) {
    check_parameter(value > 0.0 && value < 1e6, "frontier memory", name, value,
                    "more than 0, below 1e6");
  };
  check_parameter(o.hysteresis >= 0.0 && o.hysteresis < 1e3, "frontier memory", "hysteresis",
                  o.hysteresis, "0 to 1000 m");
  positive("target_radius", o.target_radius);
  check_parameter(o.failed_looks >= 1 && o.failed_looks <= 1000000, "frontier memory",
                  "failed_looks", o.failed_looks, "1 to 1000000");
  check_parameter(o.look_interval >= 0.0 && o.look_interval < 1e3, "frontier memory",
                  "look_interval", o.look_interval, "0 to 1000 s");
  positive("sensor_range", o.sensor_range);
  check_parameter(o.range_margin >= 0.0 && o.range_margin < o.sensor_range, "frontier memory",
                  "range_margin", o.range_margin, "0 to less than sensor_range");
  check_parameter(o.sensor_fov > 0.0 && o.sensor_fov <= 2.0 * std::numbers::pi + 1e-9,
                  "frontier memory", "sensor_fov", o.sensor_fov, "more than 0, up to 2 pi");
  check_parameter(o.fov_margin >= 0.0 && 2.0 * o.fov_margin < o.sensor_fov, "frontier memory",
                  "fov_margin", o.fov_margin, "0 to less than half of sensor_fov");
  check_parameter(o.reactivations >= 0 && o.reactivations <= 1000000, "frontier memory",
                  "reactivations", o.reactivations, "0 to 1000000");
  check_parameter(o.reactivation_cells >= 0 && o.reactivation_cells <= 50, "frontier memory",
                  "reactivation_cells", o.reactivation_cells, "0 to 50");
  check_parameter(o.retries >= 0 && o.retries <= 1000, "frontier memory", "retries", o.retries,
                  "0 to 1000");
  positive("retry_area", o.retry_area);
  check_parameter(o.loss_retries >= 0 && o.loss_retries <= 1000, "frontier memory", "loss_retries",
                  o.loss_retries, "0 to 1000");
  check_parameter(o.loss_retries_here >= 0 && o.loss_retries_here <= 1000, "frontier memory",
                  "loss_retries_here", o.loss_retries_here, "0 to 1000");
  positive("loss_radius", o.loss_radius);
}

void FrontierMemory::map_changed(const std::vector<Cell>& newly_known,
                                 const std::vector<Cell>& changed) {
  if (looks_.empty() || changed.empty()) return;
  std::unordered_set<std::uint64_t> known, all;
  for (const Cell c : newly_known) known.insert(address(c.i, c.j));
  for (const Cell c : changed) all.insert(address(c.i, c.j));
  const int reach = options_.reactivation_cells;
  const auto near = [reach](Cell c, const std::unordered_set<std::uint64_t>& cells) {
    if (cells.empty()) return false;
    for (int dj = -reach; dj <= reach; ++dj) {
      for (int di = -reach; di <= reach; ++di) {
        if (cells.contains(address(c.i + di, c.j + dj))) return true;
      }
    }
    return false;
  };
  for (auto it = looks_.begin(); it != looks_.end();) {
    const Cell c{it->first.second, it->first.first};
    Look& look = it->second;
    if (near(c, known)) {
      suppressed_count_ -= look.suppressed;
      it = looks_.erase(it);
      continue;
    }
    if (look.forgiven < options_.reactivations && near(c, all)) {
      suppressed_count_ -= look.suppressed;
      look = {0, false, look.forgiven + look.suppressed};
    }
    ++it;
  }
}

void FrontierMemory::look(const Grid<std::uint8_t>& see_through,
                          const std::vector<Frontier>& frontiers, const Pose& pose, double stamp) {
  const Eigen::Vector2d eye = pose.position.head<2>();
  if (!eye.allFinite() || !std::isfinite(pose.yaw) || !std::isfinite(stamp)) return;
  if (last_look_ && stamp >= *last_look_ && stamp - *last_look_ < options_.look_interval - 1e-9) {
    return;
  }
  last_look_ = stamp;
  const double range = options_.sensor_range - options_.range_margin;
  const double half = 0.5 * options_.sensor_fov - options_.fov_margin;
  const Eigen::Vector2d ahead(std::cos(pose.yaw), std::sin(pose.yaw));
  for (const Frontier& frontier : frontiers) {
    for (const Cell c : frontier.cells) {
      const Eigen::Vector2d to = see_through.frame.center(c) - eye;
      if (to.squaredNorm() > range * range) continue;
      const double bearing = std::atan2(ahead.x() * to.y() - ahead.y() * to.x(), ahead.dot(to));
      if (std::abs(bearing) > half) continue;
      if (!line_of_sight(see_through, eye, see_through.frame.center(c))) continue;
      Look& seen = looks_[{c.j, c.i}];
      if (++seen.failed >= options_.failed_looks && !seen.suppressed) {
        seen.suppressed = true;
        ++suppressed_count_;
      }
    }
  }
}

void FrontierMemory::forgive() {
  looks_.clear();
  suppressed_count_ = 0;
}

void FrontierMemory::suppress_about(Cell target, const std::vector<Cell>& cells,
                                    double resolution) {
  for (const Cell c : cells) {
    if (distance(c, target, resolution) > options_.target_radius) continue;
    Look& look = looks_[{c.j, c.i}];
    if (!look.suppressed) ++suppressed_count_;
    look.suppressed = true;
  }
}

void FrontierMemory::put_off_target(const std::vector<Frontier>& frontiers, const GridFrame& frame,
                                    const Eigen::Vector2d& position) {
  const int current = current_target(frontiers, frame);
  if (current < 0) return;
  suppress_about(*target_, frontiers[static_cast<std::size_t>(current)].cells, frame.resolution);
  target_.reset();
  progress_.target_dropped();
  const auto here = std::count_if(losses_.begin(), losses_.end(), [&](const Eigen::Vector2d& p) {
    return (p - position).norm() <= options_.loss_radius;
  });
  if (retries_used_ > 0 && static_cast<int>(losses_.size()) < options_.loss_retries &&
      here < options_.loss_retries_here) {
    --retries_used_;
    losses_.push_back(position);
  }
}

bool FrontierMemory::suppressed(Cell c) const {
  const auto it = looks_.find({c.j, c.i});
  return it != looks_.end() && it->second.suppressed;
}

void FrontierMemory::suppression(const GridFrame& frame, Grid<std::uint8_t>& out) const {
  out.frame = frame;
  out.data.assign(static_cast<std::size_t>(frame.size()), 0);
  for (const auto& [key, look] : looks_) {
    const Cell c{key.second, key.first};
    if (look.suppressed && frame.contains(c)) out[c] = 1;
  }
}

int FrontierMemory::current_target(const std::vector<Frontier>& frontiers,
                                   const GridFrame& frame) const {
  int best = -1;
  if (!target_) return best;
  double least = options_.target_radius + 1e-9;
  for (std::size_t k = 0; k < frontiers.size(); ++k) {
    for (const Cell c : frontiers[k].cells) {
      const double d = distance(c, *target_, frame.resolution);
      if (d >= least) continue;
      least = d;
      best = static_cast<int>(k);
    }
  }
  return best;
}

FrontierMemory::Verdict FrontierMemory::judge(const std::vector<Frontier>& frontiers,
                                              const GridFrame& frame,
                                              std::optional<std::pair<int, Cell>> target,
                                              const Eigen::Vector2d& position, double value,
                                              double explored, double stamp) {
  progress_.begin(stamp, position, explored, value);
  if (!retry_explored_) retry_explored_ = explored;
  if (explored - *retry_explored_ >= retry_area_) {
    retry_explored_ = explored;
    if (retries_used_ > 0) retry_area_ *= 2.0;
    retries_used_ = 0;
    losses_.clear();
  }

  if (!target) {
    target_.reset();
    progress_.no_target();
    // Cells not seen to fail have nothing to be forgiven: without suppressed ones a retry would be
    // the same question again.
    if (suppressed_count_ == 0 || retries_used_ >= options_.retries) return Verdict::kNothingLeft;
    forgive();
    ++retries_used_;
    return Verdict::kAskAgain;
  }

  const Cell cell = target->second;
  const bool same = target_ && distance(cell, *target_, frame.resolution) <= options_.target_radius;
  target_ = cell;
  progress_.update(same, position, value, explored);
  if (!progress_.hopeless()) return Verdict::kPursue;

  progress_.given_up(explored);
  ++given_up_;
  target_.reset();
  const auto k = static_cast<std::size_t>(target->first);
  if (k >= frontiers.size()) return Verdict::kPursue;
  suppress_about(cell, frontiers[k].cells, frame.resolution);
  return Verdict::kAskAgain;
}

}  // namespace prospect
