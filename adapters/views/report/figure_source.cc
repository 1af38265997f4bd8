// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/figure_source.h"

#include <octomap/OcTree.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/octree_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/views/report/step_table.h"
#include "engine/maps/map_projection.h"
#include "models/robot_shape.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

ColoredPath read_path(const StepTable& table, PathColor by) {
  ColoredPath path;
  path.by = by;
  const std::vector<double> x = table.numbers("estimated_x"), y = table.numbers("estimated_y");
  for (std::size_t k = 0; k < x.size(); ++k) path.points.emplace_back(x[k], y[k]);
  if (by == PathColor::kFeatures) path.values = table.numbers("tracked_features");
  if (by == PathColor::kError) path.values = table.numbers("localization_error");
  if (by == PathColor::kSpeed) {
    const std::vector<double> forward = table.numbers("command_v"),
                              sideways = table.numbers("command_vy");
    for (std::size_t k = 0; k < forward.size(); ++k) {
      path.values.push_back(std::hypot(forward[k], sideways[k]));
    }
  }
  if (by == PathColor::kMode) path.modes = table.words("mode");
  return path;
}

/// Height of the robot's base when it started, of the first row of a trajectory (TUM).
double start_height(const std::string& file) {
  std::ifstream stream(file);
  std::string row;
  double time = 0.0, x = 0.0, y = 0.0, z = 0.0;
  if (!std::getline(stream, row) || !(std::istringstream(row) >> time >> x >> y >> z) ||
      !std::isfinite(z)) {
    fail(file + ":1", "no pose; expected time x y z qx qy qz qw");
  }
  return z;
}

GroundMap read_map(const fs::path& folder, const Registries& registries) {
  const Configuration configuration =
      read_configuration((folder / "config.yaml").string(), registries);
  const double z = start_height((folder / "trajectory_estimated.tum").string());
  const VerticalExtent extent = vertical_extent(configuration.robot.shape);
  const HeightSlice slice{z + extent.z_min, z + extent.z_max};
  const std::string file = (folder / "map.bt").string();
  const std::unique_ptr<octomap::OcTree> octree = read_octree(file);
  try {
    return project(voxels_from_octree(*octree, slice.z_min, slice.z_max), slice);
  } catch (const std::invalid_argument& error) {
    fail(file, error.what());
  }
}

}  // namespace

FigureSource read_figure_source(const std::string& folder, std::optional<PathColor> path_by,
                                bool map_needed, const Registries& registries) {
  std::error_code error;
  if (!fs::exists(folder, error)) fail(folder, "no such folder; expected that of a run");
  if (!fs::is_directory(folder, error)) fail(folder, "is no folder; expected that of a run");
  FigureSource source;
  // Also where only the map is wanted: it tells a run's folder from any other.
  const StepTable table = StepTable::read((fs::path(folder) / "steps.csv").string());
  if (path_by) source.path = read_path(table, *path_by);
  const fs::path map = fs::path(folder) / "map.bt";
  if (fs::exists(map, error)) {
    source.map = read_map(folder, registries);
  } else if (map_needed) {
    fail(map.string(), "no such file; expected the map of a run that came to its end");
  }
  return source;
}

}  // namespace prospect
