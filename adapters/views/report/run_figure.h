// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "adapters/views/report/drawing.h"
#include "engine/maps/grid.h"
#include "engine/maps/ground_map.h"
#include "models/types.h"

namespace prospect {

/// What the path of a figure is coloured by.
enum class PathColor { kPlain, kFeatures, kError, kSpeed, kMode };

/// A path and what each of its points is coloured by.
struct ColoredPath {
  std::vector<Eigen::Vector2d> points;  ///< estimated frame [m]; not finite: a gap
  PathColor by = PathColor::kPlain;
  std::vector<double> values;      ///< of a quantity: one a point; a line has the value of its end
  std::vector<std::string> modes;  ///< of kMode: one a point
};

/// The path over the map, as wide as one column of a page (252 pt), with start, end, a scale bar in
/// metres and a key to the colours. `map`: null where none was kept: the path alone.
Drawing path_figure(const GroundMap* map, const ColoredPath& path);

/// The map as the robot knew it: free and occupied cells.
Drawing map_figure(const GroundMap& map);

/// How a world was read, before a robot drives in it: what is free, occupied and unknown at the
/// heights of its body, what it could see of it from where it gets to (1 in `reachable`), the rim,
/// beyond which all is solid, and where it starts. `facts`: sentences below.
Drawing world_figure(const Grid<CellState>& read, const Grid<std::uint8_t>& reachable,
                     const Pose& start, const std::vector<std::string>& facts);

/// What stands for the colours of path and map in a page that may be dark
/// (adapters/views/page/page.css).
Drawing::PageColors figure_page_colors();

}  // namespace prospect
