// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "adapters/formats/ros/map_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "engine/maps/grid.h"

namespace prospect {

/// A ground map that grows, as messages: the whole of it now and then, and in between the rectangle
/// that has changed.
class LoggedMap {
 public:
  /// whole_every [s]: below.
  explicit LoggedMap(double whole_every = 10.0) : whole_every_(whole_every) {}

  /// The cells of a map, [-1 unknown, 0 free, 100 occupied] by rows.
  struct Cells {
    GridFrame frame;
    std::vector<std::int8_t> values;
  };
  struct Messages {
    bool whole = false;  ///< `cells` are all of the map, else of a part of it
    Cells cells;
    GridFrame map;  ///< the frame of all of it
  };
  /// `changes` in cells of side `resolution` [m]. None: nothing is to be said. The whole map comes
  /// first, whenever it outgrows its frame, and every `whole_every` seconds.
  std::optional<Messages> change(double time, double resolution,
                                 const std::vector<std::pair<Cell, CellState>>& changes);

 private:
  double whole_every_;
  std::optional<Grid<CellState>> map_;
  double whole_at_ = 0.0;
};

/// The messages; `cells` outlives them.
ros::OccupancyGrid whole_map(const LoggedMap::Cells& cells, std::int64_t ns);
ros::OccupancyGridUpdate part_of_map(const LoggedMap::Messages& change, std::int64_t ns);

/// A map that is read back, and what has changed in it.
class ReadMap {
 public:
  /// A grid whose corner is no cell's, is turned or has no size is passed over: false.
  bool whole(const ros::OccupancyGrid& grid);
  /// A rectangle that is not within the map is passed over: false.
  bool part(const ros::OccupancyGridUpdate& update);
  /// Cells whose state differs from what it was when this was asked before.
  std::vector<std::pair<Cell, CellState>> changes();

 private:
  Grid<CellState> map_{GridFrame{0.1, 0, 0, 0, 0}, CellState::kUnknown};
  Grid<CellState> before_ = map_;
};

}  // namespace prospect
