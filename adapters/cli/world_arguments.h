#pragma once

#include <optional>
#include <string>
#include <vector>

namespace prospect {

struct Configuration;

/// What the command line says of how a world is read.
struct WorldArguments {
  std::vector<double> start;  ///< x [m], y [m], yaw [deg]; empty: as configured
  /// [m] height of the storey in the world's file; none: as configured
  std::optional<double> floor;
  double resolution = 0.0;              ///< [m] WorldOptions::voxel_size; 0: as configured
  std::string unknown;                  ///< "free", "solid"; empty: as configured
  std::optional<double> ground_margin;  ///< [m] WorldOptions::ground_margin; none: as configured
};

/// Above what the configuration says.
void set_world(const WorldArguments& arguments, Configuration& configuration);

}  // namespace prospect
