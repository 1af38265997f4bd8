// SPDX-License-Identifier: Apache-2.0
// The descriptions of options, in a library of their own: reading a configuration builds nothing
// that acts on them.

#include <cmath>
#include <cstdio>

#include "models/knobs.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {
namespace {

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

}  // namespace

std::string range_misfit(const OccupancyMapperOptions& o) {
  const double r = o.resolution, most = kMostRangeVoxels * r;
  if (o.max_range >= r && o.max_range <= most) return "";
  return "max_range is " + text(o.max_range) + " m, " + text(o.max_range / r) +
         " voxels at a resolution of " + text(r) + " m; expected 1 to " +
         std::to_string(kMostRangeVoxels) + " voxels: " + text(r) + " to " + text(most) +
         " m, or a resolution from " + text(o.max_range / kMostRangeVoxels) + " to " +
         text(o.max_range) + " m";
}

std::string layers_misfit(const OccupancyMapperOptions& o) {
  const double r = o.resolution, height = o.z_max - o.z_min, layers = std::ceil(height / r);
  if (layers <= kMostLayers) return "";
  return "z_min " + text(o.z_min) + " m and z_max " + text(o.z_max) + " m are " + text(layers) +
         " layers at a resolution of " + text(r) + " m; expected at most " +
         std::to_string(kMostLayers) + ": " + text(kMostLayers * r) +
         " m from one to the other, or a resolution of at least " + text(height / kMostLayers) +
         " m";
}

void describe(Knobs& knobs, OccupancyMapperOptions& o) {
  knobs.number("resolution", o.resolution, {0.01, 1.0}, "m", "side of a voxel of the map");
  knobs.number("z_min", o.z_min, {-400.0, 400.0}, "m", "voxels below are not kept");
  knobs.number("z_max", o.z_max, {-400.0, 400.0}, "m", "voxels above are not kept");
  knobs.require(o.z_max > o.z_min, "z_max", "z_max <= z_min; expected more");
  knobs.number("step", o.slice.step, {0.0, 1000.0}, "m",
               "drop of the floor that the robot drives down; deeper is no ground");
  knobs.number("probability_hit", o.probability_hit, {0.5, 0.999}, "1",
               "that a voxel is occupied in which a ray ended");
  knobs.number("probability_miss", o.probability_miss, {0.001, 0.5}, "1",
               "that a voxel is occupied which a ray passed");
  knobs.number("probability_min", o.probability_min, {1e-6, 0.499}, "1",
               "least that a voxel keeps");
  knobs.number("probability_max", o.probability_max, {0.501, 0.999999}, "1",
               "most that a voxel keeps");
  knobs.number("offset_constant", o.offset_constant, {0.0, 1.0}, "m",
               "behind the measured point, where a hit is entered");
  knobs.number("offset_quadratic", o.offset_quadratic, {0.0, 1.0}, "1/m",
               "the same, times the squared range");
  knobs.number("core", o.core, {0.01, 1.0}, "1",
               "how near to the axis of a voxel a ray clears it, in voxels");
  knobs.boolean("slopes", o.slopes, "ramps and thresholds are ground where they join the floor");
}

}  // namespace prospect
