#pragma once

#include <cstdint>
#include <string>

namespace prospect {

/// A floor plan drawn from a seed, as a world file (YAML, docs/reference/worlds.md): two or three
/// rows of three or four rooms, doors along a random spanning tree and a few more, furniture along
/// the walls that leaves doors free, textures from posters to white walls. The same seed gives the
/// same text on every machine.
std::string random_floor_plan(std::uint64_t seed);

}  // namespace prospect
