#pragma once

#include <optional>
#include <string>
#include <vector>

namespace prospect {

struct Configuration;
struct World;

/// What the command line says of how a world is read.
struct WorldArguments {
  std::vector<double> start;  ///< x [m], y [m], yaw [deg]; empty: as configured
  /// [m] height of the storey in the world's file; none: as configured
  std::optional<double> floor;
  double resolution = 0.0;              ///< [m] WorldOptions::voxel_size; 0: as configured
  std::string unknown;                  ///< "free", "solid"; empty: as configured
  std::string up;                       ///< "x", "y", "z"; empty: as configured
  std::optional<double> ground_margin;  ///< [m] WorldOptions::ground_margin; none: as configured
};

/// Above what the configuration says.
void set_world(const WorldArguments& arguments, Configuration& configuration);
/// One line on standard error of what the world's source holds besides, if anything.
void tell_left_out(const World& world);

}  // namespace prospect
