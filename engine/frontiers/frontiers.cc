// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/frontiers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "engine/maps/free_line.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr float kNoSource = std::numeric_limits<float>::infinity();
constexpr int kTile = GroundMap::kTile;

}  // namespace

double viewpoint_cost(double distance, const FrontierOptions& options) {
  return options.near_slope * std::min(distance, options.near_distance) +
         std::max(0.0, distance - options.near_distance);
}

void FrontierDetector::Rectangle::add(Cell c) {
  if (empty()) {
    *this = {c.i, c.j, c.i, c.j};
    return;
  }
  i0 = std::min(i0, c.i);
  j0 = std::min(j0, c.j);
  i1 = std::max(i1, c.i);
  j1 = std::max(j1, c.j);
}

bool FrontierDetector::Rectangle::meets(const Rectangle& o) const {
  return !empty() && !o.empty() && i0 <= o.i1 && o.i0 <= i1 && j0 <= o.j1 && o.j0 <= j1;
}

FrontierDetector::FrontierDetector(const FrontierOptions& options) : options_(options) {
  const auto& o = options_;
  check_knobs("frontiers", o);
  check_parameter(o.sensor_range > 0.0 && o.sensor_range <= 50.0, "frontiers", "sensor_range",
                  o.sensor_range, "more than 0, up to 50 m");
  check_parameter(o.range_margin >= 0.0 && o.range_margin < o.sensor_range, "frontiers",
                  "range_margin", o.range_margin, "0 to less than sensor_range");
}

std::size_t FrontierDetector::tile_of(Cell c) const {
  const GridFrame& f = label_.frame;
  return static_cast<std::size_t>((c.j - f.j0) / kTile * tiles_x() + (c.i - f.i0) / kTile);
}

void FrontierDetector::make_rays(double resolution) {
  if (resolution == rays_resolution_) return;
  rays_resolution_ = resolution;
  rays_.assign(static_cast<std::size_t>(options_.rays), {});
  const double reach = options_.sensor_range - options_.range_margin;
  const GridFrame unit{resolution, 0, 0, 1, 1};
  const Eigen::Vector2d from = unit.center({0, 0});
  for (int k = 0; k < options_.rays; ++k) {
    Ray& ray = rays_[static_cast<std::size_t>(k)];
    const double angle = 2.0 * std::numbers::pi * k / options_.rays;
    ray.angle = angle;
    const Eigen::Vector2d to = from + reach * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    visit_line(unit, from, to, [&](Cell c) {
      if (c == Cell{0, 0}) return true;
      const double distance = resolution * std::hypot(c.i, c.j);
      if (distance > reach) return false;
      ray.offsets.push_back(c);
      ray.distances.push_back(static_cast<float>(distance));
      ray.costs.push_back(static_cast<float>(viewpoint_cost(distance, options_)));
      return true;
    });
  }
}

void FrontierDetector::relayout(const Traversability& traversability, const PausePoint& pause) {
  const GridFrame& frame = traversability.frame();
  const bool restart = traversability.restarted() || label_.data.empty();
  make_rays(frame.resolution);
  if (restart) {
    label_ = Grid<int>(frame, -1, pause);
    passable_ = Grid<std::uint8_t>(frame, 0, pause);
    source_ = Grid<float>(frame, kNoSource, pause);
    frontiers_.clear();
    pieces_.clear();
    led_.clear();
    led_to_ = -1;
  } else if (frame == label_.frame) {
    return;
  } else {
    label_.widen(frame, -1, pause);
    passable_.widen(frame, std::uint8_t{0}, pause);
    source_.widen(frame, kNoSource, pause);
  }
  best_ = Grid<float>(frame, kNoSource, pause);
  best_index_ = Grid<int>(frame, -1, pause);
  piece_at_ = Grid<int>(frame, -1, pause);
  // Cells lie in the same tiles as before, but those are numbered anew.
  std::vector<std::vector<Cell>> old;
  old.swap(tile_cells_);
  const auto tiles = static_cast<std::size_t>(tiles_x() * (frame.height / kTile));
  tile_cells_.resize(tiles);
  moved_.assign(tiles, {});
  if (restart) return;
  for (auto& cells : old) {
    if (!cells.empty()) tile_cells_[tile_of(cells.front())] = std::move(cells);
  }
}

void FrontierDetector::update(const Traversability& traversability, const PausePoint& pause) {
  relayout(traversability, pause);
  find_cells(traversability, pause);
  cluster(pause);
}

void FrontierDetector::find_cells(const Traversability& traversability, const PausePoint& pause) {
  const GridFrame& f = label_.frame;
  std::size_t seen = 0;
  const auto pause_now_and_then = [&] {
    if (++seen % 1024 == 0) pause();
  };
  for (const Cell c : traversability.changed_states()) {
    pause_now_and_then();
    moved_[tile_of(c)].add(c);
  }
  for (const Cell c : traversability.changed_sights()) {
    pause_now_and_then();
    moved_[tile_of(c)].add(c);
  }
  for (const Cell c : traversability.changed_factors()) {
    pause_now_and_then();
    const std::uint8_t passable = traversability.passable(c);
    if (passable_[c] == passable) continue;
    passable_[c] = passable;
    moved_[tile_of(c)].add(c);
  }
  for (const Cell c : traversability.changed_headings()) {
    pause_now_and_then();
    moved_[tile_of(c)].add(c);
  }
  // A tile's frontier cells depend on its own cells and on the 4-neighbours of those.
  std::vector<std::uint8_t> again(tile_cells_.size(), 0);
  for (const Cell c : traversability.changed_states()) {
    pause_now_and_then();
    for (const Cell n :
         {c, Cell{c.i - 1, c.j}, Cell{c.i + 1, c.j}, Cell{c.i, c.j - 1}, Cell{c.i, c.j + 1}}) {
      if (f.contains(n)) again[tile_of(n)] = 1;
    }
  }
  for (std::size_t tile = 0; tile < again.size(); ++tile) {
    if (again[tile] == 0) continue;
    pause();
    std::vector<Cell>& cells = tile_cells_[tile];
    for (const Cell c : cells) label_[c] = -1;
    cells.clear();
    const int i0 = f.i0 + static_cast<int>(tile) % tiles_x() * kTile;
    const int j0 = f.j0 + static_cast<int>(tile) / tiles_x() * kTile;
    for (int j = j0; j < j0 + kTile; ++j) {
      for (int i = i0; i < i0 + kTile; ++i) {
        if (traversability.states()[{i, j}] != CellState::kUnknown) continue;
        const bool frontier = traversability.state({i - 1, j}) == CellState::kFree ||
                              traversability.state({i + 1, j}) == CellState::kFree ||
                              traversability.state({i, j - 1}) == CellState::kFree ||
                              traversability.state({i, j + 1}) == CellState::kFree;
        if (frontier) cells.push_back({i, j});
      }
    }
  }
}

void FrontierDetector::cluster(const PausePoint& pause) {
  const double r = label_.frame.resolution;
  std::size_t taken = 0;
  for (const auto& cells : tile_cells_) {
    if (++taken % 256 == 0) pause();
    for (const Cell c : cells) label_[c] = -2;
  }
  while (!frontiers_.empty()) {
    if (++taken % 64 == 0) pause();
    frontiers_.pop_back();
  }
  for (const auto& cells : tile_cells_) {
    for (const Cell seed : cells) {
      if (label_[seed] != -2) continue;
      pause();
      const int index = static_cast<int>(frontiers_.size());
      Frontier& frontier = frontiers_.emplace_back();
      label_[seed] = index;
      stack_.assign(1, seed);
      while (!stack_.empty()) {
        if (++taken % 256 == 0) pause();
        const Cell c = stack_.back();
        stack_.pop_back();
        frontier.cells.push_back(c);
        for (int dj = -1; dj <= 1; ++dj) {
          for (int di = -1; di <= 1; ++di) {
            const Cell n{c.i + di, c.j + dj};
            if (label_.get(n, -1) != -2) continue;
            label_[n] = index;
            stack_.push_back(n);
          }
        }
      }
      std::sort(frontier.cells.begin(), frontier.cells.end(), [&](Cell a, Cell b) {
        if (++taken % 1024 == 0) pause();
        return scan_less(a, b);
      });
      for (const Cell c : frontier.cells) frontier.centroid += label_.frame.center(c);
      const auto n = static_cast<double>(frontier.cells.size());
      frontier.centroid /= n;
      frontier.length = n * r;
    }
  }
}

void FrontierDetector::find_viewpoints(const Traversability& traversability,
                                       const ViewRanges& view_ranges, const PausePoint& pause) {
  const double r = label_.frame.resolution;
  const auto farthest = static_cast<float>(options_.sensor_range - options_.range_margin);
  std::deque<Piece> old;
  old.swap(pieces_);
  std::size_t compared = 0;
  for (std::size_t k = 0; k < old.size(); ++k) {
    if (k % 256 == 0) pause();
    piece_at_[old[k].cells.front()] = static_cast<int>(k);
  }

  struct Counted {
    Cell cell;
    float range;
  };
  std::vector<Counted> counted;
  std::vector<float> ranges;
  for (std::size_t k = 0; k < frontiers_.size(); ++k) {
    pause();
    Frontier& frontier = frontiers_[k];
    frontier.ignored_cells = 0;
    frontier.viewpoints = 0;
    frontier.active = false;
    ranges.assign(frontier.cells.size(), farthest);
    if (view_ranges) view_ranges(frontier, ranges);
    counted.clear();
    for (std::size_t n = 0; n < frontier.cells.size(); ++n) {
      if (!(ranges[n] > 0.0F)) {
        ++frontier.ignored_cells;
      } else {
        counted.push_back({frontier.cells[n], std::min(ranges[n], farthest)});
      }
    }
    // Half a cell of tolerance: lengths are sums of decimals.
    if (frontier.length < options_.min_length - 0.5 * r) continue;
    // Group by tile; the cells of one tile stay in scan order.
    std::stable_sort(counted.begin(), counted.end(), [&](const Counted& a, const Counted& b) {
      if (++compared % 1024 == 0) pause();
      return tile_of(a.cell) < tile_of(b.cell);
    });
    for (std::size_t begin = 0; begin < counted.size();) {
      Piece& piece = pieces_.emplace_back();
      piece.frontier = static_cast<int>(k);
      const std::size_t tile = tile_of(counted[begin].cell);
      for (; begin < counted.size() && tile_of(counted[begin].cell) == tile; ++begin) {
        piece.cells.push_back(counted[begin].cell);
        piece.ranges.push_back(counted[begin].range);
      }
    }
  }

  cells_cast_ = 0;
  for (Piece& piece : pieces_) {
    pause();
    const int k = piece_at_[piece.cells.front()];
    bool valid = k >= 0 && old[static_cast<std::size_t>(k)].cells == piece.cells &&
                 old[static_cast<std::size_t>(k)].ranges == piece.ranges;
    if (valid) {
      const Rectangle& t = old[static_cast<std::size_t>(k)].touched;
      const GridFrame& f = label_.frame;
      const int x0 = (t.i0 - f.i0) / kTile, x1 = (t.i1 - f.i0) / kTile;
      const int y0 = (t.j0 - f.j0) / kTile, y1 = (t.j1 - f.j0) / kTile;
      for (int y = y0; y <= y1 && valid; ++y) {
        for (int x = x0; x <= x1 && valid; ++x) {
          valid = !moved_[static_cast<std::size_t>(y * tiles_x() + x)].meets(t);
        }
      }
    }
    if (valid) {
      Piece& past = old[static_cast<std::size_t>(k)];
      piece.entries = std::move(past.entries);
      piece.touched = past.touched;
    } else {
      cast(traversability, piece, pause);
      cells_cast_ += static_cast<int>(piece.cells.size());
    }
    Frontier& frontier = frontiers_[static_cast<std::size_t>(piece.frontier)];
    frontier.viewpoints += static_cast<int>(piece.entries.size());
    frontier.active = frontier.viewpoints > 0;
  }
  while (!old.empty()) {
    if (old.size() % 64 == 0) pause();
    piece_at_[old.back().cells.front()] = -1;
    old.pop_back();
  }
  std::fill(moved_.begin(), moved_.end(), Rectangle{});
}

void FrontierDetector::cast(const Traversability& traversability, Piece& piece,
                            const PausePoint& pause) {
  const GridFrame& frame = label_.frame;
  const std::uint8_t* see_through = traversability.see_through().data.data();
  piece.entries.clear();
  piece.touched = {};
  marked_.clear();
  for (std::size_t n = 0; n < piece.cells.size(); ++n) {
    pause();
    const Cell cell = piece.cells[n];
    piece.touched.add(cell);
    for (const Ray& ray : rays_) {
      const HeadingMask facing = traversability.facing(ray.angle + std::numbers::pi);
      Cell last = cell;
      for (std::size_t step = 0; step < ray.offsets.size(); ++step) {
        const Cell c{cell.i + ray.offsets[step].i, cell.j + ray.offsets[step].j};
        if (!frame.contains(c) || ray.distances[step] > piece.ranges[n]) break;
        last = c;
        const auto at = static_cast<std::size_t>(frame.index(c));
        if (see_through[at] == 0) break;
        if (passable_.data[at] == 0 || !traversability.turns_to(at, facing)) continue;
        float& best = best_.data[at];
        if (best == kNoSource) marked_.push_back(c);
        if (ray.costs[step] < best) {
          best = ray.costs[step];
          best_index_.data[at] = static_cast<int>(n);
        }
      }
      // A ray is monotone in both coordinates, so its ends bound it.
      piece.touched.add(last);
    }
  }
  piece.entries.reserve(marked_.size());
  for (const Cell c : marked_) {
    piece.entries.push_back({c, best_[c], best_index_[c], 0.0F});
    best_[c] = kNoSource;
  }
}

void FrontierDetector::set_goal(int frontier, const ViewPrice& price, const PausePoint& pause) {
  std::size_t seen = 0;
  const auto pause_now_and_then = [&] {
    if (++seen % 256 == 0) pause();
  };
  changed_sources_.clear();
  marked_.clear();
  led_to_ = frontier;
  for (Piece& piece : pieces_) {
    pause_now_and_then();
    if (piece.frontier != frontier) continue;
    for (Entry& e : piece.entries) {
      pause_now_and_then();
      const Cell sees = piece.cells[static_cast<std::size_t>(e.sees)];
      e.price = price ? static_cast<float>(price(e.cell, sees)) : 0.0F;
      float& best = best_[e.cell];
      if (best == kNoSource) marked_.push_back(e.cell);
      best = std::min(best, e.cost + e.price);
    }
  }
  for (const Cell c : led_) {
    pause_now_and_then();
    if (best_[c] != kNoSource) continue;
    source_[c] = kNoSource;
    changed_sources_.push_back(c);
  }
  for (const Cell c : marked_) {
    pause_now_and_then();
    if (best_[c] != source_[c]) {
      source_[c] = best_[c];
      changed_sources_.push_back(c);
    }
    best_[c] = kNoSource;
  }
  led_.swap(marked_);
}

float FrontierDetector::source(Cell c) const { return source_.get(c, kNoSource); }

ViewpointSource FrontierDetector::source_at(Cell c) const {
  ViewpointSource best{c, kNoSource, {}, -1};
  for (const Piece& piece : pieces_) {
    if (piece.frontier != led_to_ || !piece.touched.contains(c)) continue;
    for (const Entry& e : piece.entries) {
      const float cost = e.cost + e.price;
      if (!(e.cell == c) || cost >= best.cost) continue;
      best = {c, cost, piece.cells[static_cast<std::size_t>(e.sees)], piece.frontier};
    }
  }
  return best;
}

std::vector<ViewpointSource> FrontierDetector::sources() const {
  std::vector<ViewpointSource> all;
  for (int k = 0; k < source_.frame.size(); ++k) {
    const Cell c = source_.frame.at(k);
    if (source_[c] != kNoSource) all.push_back(source_at(c));
  }
  return all;
}

void describe(Knobs& knobs, FrontierOptions& o) {
  knobs.number("min_length", o.min_length, {0.0, 10.0}, "m", "smallest cluster of frontier cells");
  knobs.number("range_margin", o.range_margin, {0.0, 10.0}, "m",
               "a viewpoint stands this much within the sensor's range");
  knobs.integer("rays", o.rays, {8, 1000}, "1", "directions tried from each frontier cell");
  knobs.number("near_distance", o.near_distance, {0.0, 50.0}, "m",
               "up to which an observation from farther off is cheap");
  knobs.number("near_slope", o.near_slope, {0.0, 1.0}, "1",
               "cost of a viewpoint per metre up to there; 1 beyond");
}

}  // namespace prospect
