// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/cost_to_go_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/maps/free_line.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kNoSource = std::numeric_limits<float>::infinity();

/// Both neighbours of a cell count only if they differ by less than r f (1 - this). Exactly at r f
/// the two-sided solution equals the higher neighbour; rounding could then make a cell depend on
/// one that is not lower than itself, and the solution would no longer be unique. The value changes
/// by a relative 5e-17.
constexpr double kStrictness = 1e-8;

constexpr double kAnchorRadius = 1.0;  // [m]

}  // namespace

CostToGoField::CostToGoField(const CostToGoOptions& options) : options_(options) {
  const auto& o = options_;
  check_parameter(o.v_max > 0.0 && o.v_max < 1e3, "cost-to-go", "v_max", o.v_max,
                  "more than 0, below 1000 m/s");
  check_knobs("cost-to-go", o);
  check_parameter(o.features_required > 0.0 && o.features_required < 1e9, "cost-to-go",
                  "features_required", o.features_required, "more than 0");
}

void CostToGoField::relayout(const Traversability& traversability, const PausePoint& pause) {
  const GridFrame& frame = traversability.frame();
  for (std::vector<int>* list : {&touched_, &front_, &raised_}) {
    // Long ones would be moved as they grow, without a pause.
    list->reserve(static_cast<std::size_t>(frame.size()));
  }
  entries_.reserve(static_cast<std::size_t>(frame.size()));
  if (fresh_ || traversability.restarted()) {
    frame_ = frame;
    d_ = Grid<double>(frame, kInfinity, pause).data;
    slowness_ = Grid<float>(frame, 0.0F, pause).data;
    source_ = Grid<float>(frame, kNoSource, pause).data;
    in_front_ = Grid<std::uint8_t>(frame, 0, pause).data;
    pending_bucket_ = Grid<int>(frame, -1, pause).data;
    front_.clear();
    touched_.clear();
    return;
  }
  if (frame == frame_) return;
  const GridFrame old = frame_;
  const auto move = [&](auto& data, auto value) {
    auto wide = Grid<std::decay_t<decltype(value)>>(frame, value, pause).data;
    for (int j = 0; j < old.height; ++j) {
      pause();
      const auto from = data.begin() + static_cast<std::ptrdiff_t>(j) * old.width;
      std::copy(from, from + old.width, wide.begin() + frame.index({old.i0, old.j0 + j}));
    }
    data = std::move(wide);
  };
  move(d_, kInfinity);
  move(slowness_, 0.0F);
  move(source_, kNoSource);
  move(in_front_, std::uint8_t{0});
  pending_bucket_ = Grid<int>(frame, -1, pause).data;
  for (std::size_t n = 0; n < front_.size(); ++n) {
    if (n % 1024 == 0) pause();
    front_[n] = frame.index(old.at(front_[n]));
  }
  frame_ = frame;
}

template <typename Sources>
void CostToGoField::refresh(int index, Cell c, const Traversability& traversability,
                            const Sources& sources, const Grid<float>* features) {
  const auto at = static_cast<std::size_t>(index);
  const double r = frame_.resolution;
  double slowness = r * static_cast<double>(traversability.factor(c));
  if (features != nullptr && options_.lambda > 0.0) {
    // A count that is not a number says nothing: as none.
    double count = static_cast<double>(features->get(c, std::numeric_limits<float>::infinity()));
    if (!(count > 0.0)) count = 0.0;
    slowness *= 1.0 + options_.localization_price(count);
  }
  const auto s = static_cast<float>(slowness);
  const float source = sources.source(c);
  if (s == slowness_[at] && source == source_[at]) return;
  slowness_[at] = s;
  source_[at] = source;
  touched_.push_back(index);
}

// The upwind solution at a cell given its neighbours: min(source, F).
double CostToGoField::solve_cell(int index) const {
  const auto at = static_cast<std::size_t>(index);
  const auto stride = static_cast<std::size_t>(frame_.width);
  const double step = static_cast<double>(slowness_[at]);
  if (step == 0.0) return kInfinity;
  const double x = std::min(d_[at - 1], d_[at + 1]);
  const double y = std::min(d_[at - stride], d_[at + stride]);
  const double low = std::min(x, y);
  double value = low + step;
  const double gap = std::max(x, y) - low;  // NaN if both are infinite: then not less
  if (gap < step * (1.0 - kStrictness)) {
    value = 0.5 * (x + y + std::sqrt(2.0 * step * step - gap * gap));
  }
  return std::min(value, static_cast<double>(source_[at]));
}

void CostToGoField::to_front(int index) {
  std::uint8_t& in = in_front_[static_cast<std::size_t>(index)];
  if (in != 0) return;
  in = 1;
  front_.push_back(index);
}

void CostToGoField::invalidate(int index) {
  d_[static_cast<std::size_t>(index)] = kInfinity;
  to_front(index);
  raised_.push_back(index);
}

// Leaves only values that the cells around still bear out: a cell whose equation, or a cell that it
// depended on, changed so that its value must rise loses it, and so in turn do those that depended
// on it. Support comes from strictly lower cells, so it cannot run in a circle. What remains are
// upper bounds.
void CostToGoField::repair_support(const PausePoint& pause) {
  raised_.clear();
  const int stride = frame_.width;
  const auto evaluate = [&](int index) {
    if (++evaluations_ % 256 == 0) pause();
    return solve_cell(index);
  };
  for (const int index : touched_) {
    const auto at = static_cast<std::size_t>(index);
    const double value = evaluate(index);
    if (value > d_[at]) {
      invalidate(index);
    } else if (value < d_[at]) {
      to_front(index);
    }
  }
  touched_.clear();
  while (!raised_.empty()) {
    const int index = raised_.back();
    raised_.pop_back();
    for (const int n : {index - 1, index + 1, index - stride, index + stride}) {
      const auto at = static_cast<std::size_t>(n);
      if (d_[at] == kInfinity) continue;
      if (evaluate(n) > d_[at]) invalidate(n);
    }
  }
}

void CostToGoField::push(int index, double key) {
  const auto at = static_cast<std::size_t>(index);
  const int bucket =
      std::max(bucket_, static_cast<int>(std::min((key - key_base_) / key_width_, 1e8)));
  // An earlier entry will solve the cell again, and enter it anew if that is too soon.
  if (pending_bucket_[at] >= 0 && pending_bucket_[at] <= bucket) return;
  pending_bucket_[at] = bucket;
  if (static_cast<std::size_t>(bucket) >= bucket_head_.size()) {
    bucket_head_.resize(static_cast<std::size_t>(bucket) + 64, -1);
  }
  int& head = bucket_head_[static_cast<std::size_t>(bucket)];
  entries_.push_back({index, head});
  head = static_cast<int>(entries_.size()) - 1;
}

// Label-correcting march over buckets of half a cell: cells of one bucket are solved in any order
// and again where that was too early; the solution is unique, so the order leaves no trace.
void CostToGoField::march(const PausePoint& pause) {
  const int stride = frame_.width;
  entries_.clear();
  bucket_head_.clear();
  bucket_ = 0;
  key_width_ = 0.5 * frame_.resolution;
  key_base_ = kInfinity;
  std::vector<int>& front = front_;
  std::vector<double>& keys = front_keys_;
  keys.clear();
  const auto evaluate = [&](int index) {
    if (++evaluations_ % 256 == 0) pause();
    return solve_cell(index);
  };
  for (const int index : front) {
    const double value = evaluate(index);
    keys.push_back(value == d_[static_cast<std::size_t>(index)] ? kInfinity : value);
    key_base_ = std::min(key_base_, keys.back());
    in_front_[static_cast<std::size_t>(index)] = 0;
  }
  for (std::size_t k = 0; k < front.size(); ++k) {
    if (k % 256 == 0) pause();
    if (keys[k] != kInfinity) push(front[k], keys[k]);
  }
  front.clear();

  settled_ = kInfinity;
  const bool anchored = frame_.contains(anchor_);
  const auto anchor = static_cast<std::size_t>(anchored ? frame_.index(anchor_) : 0);
  for (bucket_ = 0; bucket_ < static_cast<int>(bucket_head_.size()); ++bucket_) {
    const double low = key_base_ + bucket_ * key_width_;
    // Everything below `low` is settled.
    if (anchored && d_[anchor] < low && d_[anchor] + options_.stop_beyond < low) break;
    while (true) {
      const int entry = bucket_head_[static_cast<std::size_t>(bucket_)];
      if (entry < 0) break;
      bucket_head_[static_cast<std::size_t>(bucket_)] =
          entries_[static_cast<std::size_t>(entry)].next;
      const int index = entries_[static_cast<std::size_t>(entry)].cell;
      const auto at = static_cast<std::size_t>(index);
      if (pending_bucket_[at] != bucket_) continue;
      pending_bucket_[at] = -1;
      const double value = evaluate(index);
      if (value == d_[at]) continue;
      if (value >= low + 2.0 * key_width_ && value < kInfinity) {
        push(index, value);
        continue;
      }
      d_[at] = value;
      for (const int n : {index - 1, index + 1, index - stride, index + stride}) {
        const auto next = static_cast<std::size_t>(n);
        if (slowness_[next] == 0.0F || d_[next] < value) continue;
        const double changed = evaluate(n);
        if (changed != d_[next]) push(n, changed);
      }
    }
  }
  for (; bucket_ < static_cast<int>(bucket_head_.size()); ++bucket_) {
    pause();
    for (int entry = bucket_head_[static_cast<std::size_t>(bucket_)]; entry >= 0;
         entry = entries_[static_cast<std::size_t>(entry)].next) {
      const int index = entries_[static_cast<std::size_t>(entry)].cell;
      if (pending_bucket_[static_cast<std::size_t>(index)] != bucket_) continue;
      pending_bucket_[static_cast<std::size_t>(index)] = -1;
      to_front(index);
    }
  }
  if (anchored && d_[anchor] < kInfinity) settled_ = d_[anchor] + options_.stop_beyond;
}

bool CostToGoField::reached(int index) const {
  const double d = d_[static_cast<std::size_t>(index)];
  return d < kInfinity && d <= settled_;
}

// Nearest by distance between centres, first in scan order among equals, joined to the robot by a
// line without occupied cells: the passable cell nearest to a robot close to a wall may lie behind
// it.
void CostToGoField::find_anchor(const Traversability& traversability, bool reached_only) {
  const int reach = static_cast<int>(std::ceil(kAnchorRadius / frame_.resolution));
  std::int64_t least = static_cast<std::int64_t>(reach) * reach + 1;
  Cell best = reached_only ? anchor_ : robot_;
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      const std::int64_t distance = std::int64_t{di} * di + std::int64_t{dj} * dj;
      const Cell c{robot_.i + di, robot_.j + dj};
      if (distance >= least || !traversability.passable(c)) continue;
      if (reached_only && !reached(frame_.index(c))) continue;
      const bool open = visit_line(frame_, frame_.center(robot_), frame_.center(c), [&](Cell on) {
        return on == robot_ || traversability.state(on) != CellState::kOccupied;
      });
      if (!open) continue;
      least = distance;
      best = c;
    }
  }
  anchor_ = best;
}

template <typename Sources>
void CostToGoField::update_from(const Traversability& traversability, const Sources& sources,
                                Cell robot, const Grid<float>* features, const PausePoint& pause) {
  evaluations_ = 0;
  const bool all = fresh_ || traversability.restarted();
  relayout(traversability, pause);
  fresh_ = false;
  robot_ = robot;
  // The outermost cells are never passable, and solve_cell() needs all four neighbours.
  const GridFrame inner{frame_.resolution, frame_.i0 + 1, frame_.j0 + 1, frame_.width - 2,
                        frame_.height - 2};
  const auto refresh_within = [&](const GridFrame& part, const GridFrame& but) {
    const GridFrame cells = intersection(inner, part);
    for (int n = 0; n < cells.size(); ++n) {
      if (n % 1024 == 0) pause();
      const Cell c = cells.at(n);
      if (but.contains(c)) continue;
      refresh(frame_.index(c), c, traversability, sources, features);
    }
  };
  const GridFrame none{frame_.resolution, 0, 0, 0, 0};
  const GridFrame priced = features != nullptr && options_.lambda > 0.0 ? features->frame : none;
  if (all) {
    refresh_within(frame_, none);
  } else {
    std::size_t refreshed = 0;
    for (const Cell c : traversability.changed_factors()) {
      if (++refreshed % 1024 == 0) pause();
      refresh(frame_.index(c), c, traversability, sources, features);
    }
    for (const Cell c : sources.changed_sources()) {
      if (++refreshed % 1024 == 0) pause();
      refresh(frame_.index(c), c, traversability, sources, features);
    }
    refresh_within(priced_, priced);
    refresh_within(priced, none);
  }
  priced_ = priced;
  find_anchor(traversability, false);
  repair_support(pause);
  march(pause);
  if (!anchor_reached()) find_anchor(traversability, true);
}

void CostToGoField::update(const Traversability& traversability, const FrontierDetector& frontiers,
                           Cell robot, const Grid<float>* features, const PausePoint& pause) {
  update_from(traversability, frontiers, robot, features, pause);
}

void CostToGoField::update(const Traversability& traversability, const GoalSources& goal,
                           Cell robot, const PausePoint& pause) {
  update_from(traversability, goal, robot, nullptr, pause);
}

void CostToGoField::solve_from_scratch(const Traversability& traversability,
                                       const GoalSources& goal, Cell robot,
                                       const PausePoint& pause) {
  fresh_ = true;
  update(traversability, goal, robot, pause);
}

void CostToGoField::solve_from_scratch(const Traversability& traversability,
                                       const AreaSources& area, Cell robot,
                                       const PausePoint& pause) {
  fresh_ = true;
  update_from(traversability, area, robot, nullptr, pause);
}

void CostToGoField::solve_from_scratch(const Traversability& traversability,
                                       const FrontierDetector& frontiers, Cell robot,
                                       const Grid<float>* features) {
  fresh_ = true;
  update(traversability, frontiers, robot, features);
}

double CostToGoField::value(Cell c) const {
  if (!frame_.contains(c) || !reached(frame_.index(c))) return kInfinity;
  return d_[static_cast<std::size_t>(frame_.index(c))];
}

Cell CostToGoField::downhill(Cell c) const {
  Cell best = c;
  for (int dj = -1; dj <= 1; ++dj) {
    for (int di = -1; di <= 1; ++di) {
      const Cell n{c.i + di, c.j + dj};
      if (value(n) < value(best)) best = n;
    }
  }
  return best;
}

bool CostToGoField::anchor_reached() const {
  return frame_.contains(anchor_) && reached(frame_.index(anchor_));
}

Cell CostToGoField::source_of_anchor() const {
  int index = frame_.index(anchor_);
  const int stride = frame_.width;
  while (d_[static_cast<std::size_t>(index)] <
         static_cast<double>(source_[static_cast<std::size_t>(index)])) {
    int best = index;
    for (const int n : {index - 1, index + 1, index - stride, index + stride}) {
      if (d_[static_cast<std::size_t>(n)] < d_[static_cast<std::size_t>(best)]) best = n;
    }
    if (best == index) break;
    index = best;
  }
  return frame_.at(index);
}

std::shared_ptr<const CostToGo> CostToGoField::window() const {
  const int radius =
      std::max(1, static_cast<int>(std::ceil(options_.window_radius / frame_.resolution)));
  const int width = 2 * radius + 1;
  const GridFrame window{frame_.resolution, robot_.i - radius, robot_.j - radius, width, width};
  Grid<double> values(window, 0.0);
  Grid<std::uint8_t> is_reached(window, 0);
  // Offset to the nearest reached cell, by two sweeps over the eight neighbours.
  constexpr int kFar = 20000;
  struct Offset {
    int x, y;
    std::int64_t square() const {
      return static_cast<std::int64_t>(x) * x + static_cast<std::int64_t>(y) * y;
    }
  };
  std::vector<Offset> nearest(static_cast<std::size_t>(window.size()), Offset{kFar, kFar});
  bool any = false;
  for (int j = 0; j < width; ++j) {
    for (int i = 0; i < width; ++i) {
      const Cell c{window.i0 + i, window.j0 + j};
      if (!frame_.contains(c) || !reached(frame_.index(c))) continue;
      const auto at = static_cast<std::size_t>(j * width + i);
      values.data[at] = d_[static_cast<std::size_t>(frame_.index(c))];
      is_reached.data[at] = 1;
      nearest[at] = {0, 0};
      any = true;
    }
  }
  if (any) {
    const auto try_from = [&](int i, int j, int di, int dj) {
      if (i + di < 0 || i + di >= width || j + dj < 0 || j + dj >= width) return;
      Offset& mine = nearest[static_cast<std::size_t>(j * width + i)];
      const Offset theirs = nearest[static_cast<std::size_t>((j + dj) * width + i + di)];
      const Offset candidate{theirs.x + di, theirs.y + dj};
      if (candidate.square() < mine.square()) mine = candidate;
    };
    for (int j = 0; j < width; ++j) {
      for (int i = 0; i < width; ++i) {
        try_from(i, j, -1, 0);
        for (int di = -1; di <= 1; ++di) try_from(i, j, di, -1);
      }
      for (int i = width - 1; i >= 0; --i) try_from(i, j, 1, 0);
    }
    for (int j = width - 1; j >= 0; --j) {
      for (int i = width - 1; i >= 0; --i) {
        try_from(i, j, 1, 0);
        for (int di = -1; di <= 1; ++di) try_from(i, j, di, 1);
      }
      for (int i = 0; i < width; ++i) try_from(i, j, -1, 0);
    }
    for (int j = 0; j < width; ++j) {
      for (int i = 0; i < width; ++i) {
        const auto at = static_cast<std::size_t>(j * width + i);
        if (is_reached.data[at] != 0) continue;
        const Offset o = nearest[at];
        values.data[at] =
            values.data[static_cast<std::size_t>((j + o.y) * width + i + o.x)] +
            options_.fill_slope * frame_.resolution * std::sqrt(static_cast<double>(o.square()));
      }
    }
  }
  for (double& v : values.data) v /= options_.v_max;
  return std::make_shared<const CostToGo>(std::move(values), std::move(is_reached), options_.v_max);
}

void describe(Knobs& knobs, CostToGoOptions& o) {
  knobs.number("stop_beyond", o.stop_beyond, {0.0, 1e6}, "m",
               "the cost-to-go is computed this far beyond the robot's");
  knobs.number("fill_slope", o.fill_slope, {0.0, 1e3}, "1",
               "rise of the cost-to-go per metre into what cannot be reached");
  knobs.number("window_radius", o.window_radius, {0.1, 100.0}, "m",
               "half side of the window around the robot that plans see of it");
  knobs.number("lambda", o.lambda, {0.0, 1000.0}, "1",
               "price of paths on which no feature is seen; 0: none, as with w_l = 0");
}

}  // namespace prospect
