// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace prospect {

/// Rooms of a floor plan, 2 to 40 each.
struct FloorPlanSize {
  int columns = 0;
  int rows = 0;
};

/// A floor plan drawn from a seed, as a world file (YAML, docs/reference/worlds.md): rows of rooms,
/// three or four by two or three unless `size` says otherwise, doors along a random spanning tree
/// and a few more, furniture along the walls that leaves doors free, textures from posters to white
/// walls. The same seed and size give the same text on every machine.
enum class PlanFloor {
  kFlat,
  kDrops,  ///< the same plan, with a hole, a dock or a stair down in most rooms
  kRamps   ///< or with a platform in most, a ramp up to it, and thresholds in doors
};
std::string random_floor_plan(std::uint64_t seed, const std::optional<FloorPlanSize>& size = {},
                              PlanFloor floor = PlanFloor::kFlat);

/// "plan", "drops", "ramps".
std::string_view kind_of(PlanFloor floor);

/// "plan:SEED", or "plan:SEED:COLUMNSxROWS" where a size is given; of one with drops "drops:SEED",
/// with ramps "ramps:SEED".
std::string floor_plan_name(std::uint64_t seed, const std::optional<FloorPlanSize>& size = {},
                            PlanFloor floor = PlanFloor::kFlat);

}  // namespace prospect
