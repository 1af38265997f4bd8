#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace prospect {

struct Configuration;
class Progress;
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
/// A world by name or path, for a mission of this configuration. One line on standard error says
/// what its source holds besides, if anything. Throws as load_world().
std::shared_ptr<const World> loaded_world(const std::string& name,
                                          const Configuration& configuration, Progress& progress);

}  // namespace prospect
