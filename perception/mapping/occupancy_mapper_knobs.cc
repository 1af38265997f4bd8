// The descriptions of options, in a library of their own: reading a configuration builds nothing
// that acts on them.

#include "models/knobs.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

void describe(Knobs& knobs, OccupancyMapperOptions& o) {
  knobs.number("z_min", o.z_min, {-400.0, 400.0}, "m", "voxels below are not kept");
  knobs.number("z_max", o.z_max, {-400.0, 400.0}, "m", "voxels above are not kept");
  knobs.require(o.z_max > o.z_min, "z_max", "z_max <= z_min; expected more");
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
}

}  // namespace prospect
