// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/log/map_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "adapters/missions/log/step_messages.h"

namespace prospect {
namespace {

constexpr int kMargin = 32;  // [cells] that a map grows by at once

std::int8_t value_of(CellState state) {
  return state == CellState::kUnknown ? -1 : state == CellState::kFree ? 0 : 100;
}
CellState state_of(std::int8_t value) {
  return value < 0 ? CellState::kUnknown : value < 50 ? CellState::kFree : CellState::kOccupied;
}

GridFrame frame_of(const std::vector<std::pair<Cell, CellState>>& changes, double resolution) {
  int i0 = std::numeric_limits<int>::max(), j0 = i0;
  int i1 = std::numeric_limits<int>::lowest(), j1 = i1;
  for (const auto& [c, state] : changes) {
    i0 = std::min(i0, c.i);
    j0 = std::min(j0, c.j);
    i1 = std::max(i1, c.i);
    j1 = std::max(j1, c.j);
  }
  return {resolution, i0, j0, i1 - i0 + 1, j1 - j0 + 1};
}

bool holds(const GridFrame& frame, const GridFrame& part) {
  return part.i0 >= frame.i0 && part.j0 >= frame.j0 &&
         part.i0 + part.width <= frame.i0 + frame.width &&
         part.j0 + part.height <= frame.j0 + frame.height;
}

LoggedMap::Cells cells_of(const Grid<CellState>& map, const GridFrame& part) {
  LoggedMap::Cells cells{part, {}};
  cells.values.reserve(static_cast<std::size_t>(part.size()));
  for (int k = 0; k < part.size(); ++k) cells.values.push_back(value_of(map[part.at(k)]));
  return cells;
}

}  // namespace

std::optional<LoggedMap::Messages> LoggedMap::change(
    double time, double resolution, const std::vector<std::pair<Cell, CellState>>& changes) {
  if (changes.empty()) return std::nullopt;
  const GridFrame changed = frame_of(changes, resolution);
  bool whole = !map_ || time - whole_at_ >= whole_every_;
  if (!map_ || !holds(map_->frame, changed)) {
    GridFrame wider = changed;
    if (map_) {
      const GridFrame& had = map_->frame;
      const int i1 = std::max(had.i0 + had.width, changed.i0 + changed.width);
      const int j1 = std::max(had.j0 + had.height, changed.j0 + changed.height);
      wider.i0 = std::min(had.i0, changed.i0);
      wider.j0 = std::min(had.j0, changed.j0);
      wider.width = i1 - wider.i0;
      wider.height = j1 - wider.j0;
    }
    wider = {resolution, wider.i0 - kMargin, wider.j0 - kMargin, wider.width + 2 * kMargin,
             wider.height + 2 * kMargin};
    if (map_) {
      map_->widen(wider, CellState::kUnknown);
    } else {
      map_.emplace(wider, CellState::kUnknown);
    }
    whole = true;
  }
  for (const auto& [c, state] : changes) (*map_)[c] = state;
  if (whole) whole_at_ = time;
  return Messages{whole, cells_of(*map_, whole ? map_->frame : changed), map_->frame};
}

ros::OccupancyGrid whole_map(const LoggedMap::Cells& cells, std::int64_t ns) {
  ros::OccupancyGrid grid;
  grid.header = {stamp_at(ns), kMapFrame};
  grid.info.map_load_time = stamp_at(ns);
  const GridFrame& frame = cells.frame;
  grid.info.resolution = static_cast<float>(frame.resolution);
  grid.info.width = static_cast<std::uint32_t>(frame.width);
  grid.info.height = static_cast<std::uint32_t>(frame.height);
  grid.info.origin.position = {frame.i0 * frame.resolution, frame.j0 * frame.resolution, 0.0};
  grid.data = std::span(cells.values);
  return grid;
}

ros::OccupancyGridUpdate part_of_map(const LoggedMap::Messages& change, std::int64_t ns) {
  const GridFrame& part = change.cells.frame;
  ros::OccupancyGridUpdate update;
  update.header = {stamp_at(ns), kMapFrame};
  update.x = part.i0 - change.map.i0;
  update.y = part.j0 - change.map.j0;
  update.width = static_cast<std::uint32_t>(part.width);
  update.height = static_cast<std::uint32_t>(part.height);
  update.data = std::span(change.cells.values);
  return update;
}

bool ReadMap::whole(const ros::OccupancyGrid& grid) {
  const double r = grid.info.resolution;
  const std::uint64_t cells = std::uint64_t{grid.info.width} * grid.info.height;
  const ros::Point& corner = grid.info.origin.position;
  const double i = std::round(corner.x / r), j = std::round(corner.y / r);
  if (!(r > 0.0) || !(std::abs(i) < 1e8 && std::abs(j) < 1e8) || grid.info.width > 100'000 ||
      grid.info.height > 100'000 || cells != grid.data.size() ||
      !(grid.info.origin.orientation.w > 0.999) || std::abs(i * r - corner.x) > 0.1 * r ||
      std::abs(j * r - corner.y) > 0.1 * r) {
    return false;
  }
  map_ = Grid<CellState>(
      GridFrame{r, static_cast<int>(i), static_cast<int>(j), static_cast<int>(grid.info.width),
                static_cast<int>(grid.info.height)},
      CellState::kUnknown);
  std::transform(grid.data.begin(), grid.data.end(), map_.data.begin(), state_of);
  return true;
}

bool ReadMap::part(const ros::OccupancyGridUpdate& update) {
  const auto within = [](std::int32_t from, std::uint32_t size, int all) {
    return from >= 0 && std::int64_t{from} + size <= all;
  };
  if (!within(update.x, update.width, map_.frame.width) ||
      !within(update.y, update.height, map_.frame.height) ||
      std::uint64_t{update.width} * update.height != update.data.size()) {
    return false;
  }
  for (std::size_t k = 0; k < update.data.size(); ++k) {
    const Cell c{map_.frame.i0 + update.x + static_cast<int>(k % update.width),
                 map_.frame.j0 + update.y + static_cast<int>(k / update.width)};
    map_[c] = state_of(update.data[k]);
  }
  return true;
}

std::vector<std::pair<Cell, CellState>> ReadMap::changes() {
  std::vector<std::pair<Cell, CellState>> changed;
  for (int k = 0; k < map_.frame.size(); ++k) {
    const Cell c = map_.frame.at(k);
    const CellState state = map_.data[static_cast<std::size_t>(k)];
    if (before_.get(c, CellState::kUnknown) != state) changed.emplace_back(c, state);
  }
  before_ = map_;
  return changed;
}

}  // namespace prospect
