#include "adapters/worlds/builtin_worlds.h"

#include <array>

namespace prospect {
namespace {

struct BuiltinWorld {
  const char* name;
  const char* summary;
  const char* text;
};

constexpr const char* kOffice =
    R"(# Eight rooms on a corridor, 195 m^2 of floor less the furniture. Texture from rich to none.
name: office
resolution: 0.1          # [m]
wall_height: 2.5         # [m]
wall_thickness: 0.2      # [m]

textures:                # features per m^2 of surface
  posters: 60
  brick: 40
  carpet: 35
  wood: 25
  plaster: 6
  tiles: 4
  white: 0

rooms:                   # box: x_min, y_min, x_max, y_max [m]
  - {name: corridor, box: [0, 4.4, 20, 6.2], walls: plaster, east: posters, west: brick, floor: carpet}
  - {name: office 1, box: [0, 0, 5.4, 4.2], walls: plaster, south: brick, floor: carpet}
  - {name: office 2, box: [5.6, 0, 10, 4.2], walls: brick, floor: carpet}
  - {name: store, box: [10.2, 0, 14.4, 4.2], walls: white, south: plaster, floor: tiles}
  - {name: office 3, box: [14.6, 0, 20, 4.2], walls: plaster, east: posters, floor: wood}
  - {name: meeting room, box: [0, 6.4, 6.4, 10.4], walls: posters, floor: carpet}
  - {name: office 4, box: [6.6, 6.4, 11, 10.4], walls: plaster, north: brick, floor: wood}
  - {name: kitchen, box: [11.2, 6.4, 15, 10.4], walls: white, north: plaster, floor: tiles}
  - {name: office 5, box: [15.2, 6.4, 20, 10.4], walls: brick, south: white, floor: carpet}

doors:
  - {box: [2.2, 4.1, 3.2, 4.5]}
  - {box: [7.4, 4.1, 8.4, 4.5]}
  - {box: [12.6, 4.1, 13.6, 4.5]}
  - {box: [17, 4.1, 18, 4.5]}
  - {box: [4.4, 6.1, 5.6, 6.5]}
  - {box: [8.2, 6.1, 9.2, 6.5]}
  - {box: [11.8, 6.1, 12.8, 6.5]}
  - {box: [16.2, 6.1, 17.2, 6.5]}

furniture:               # solid boxes; z: lower and upper end [m]
  - {name: desk, box: [0.2, 0.2, 1.0, 1.8], z: [0, 0.8], texture: wood}
  - {name: desk, box: [4.2, 0.2, 5.4, 1.0], z: [0, 0.8], texture: wood}
  - {name: shelf, box: [0, 3.8, 1.4, 4.2], z: [0, 2.0], texture: posters}
  - {name: desk, box: [5.6, 1.6, 7.2, 2.4], z: [0, 0.8], texture: wood}
  - {name: cabinet, box: [9.4, 0, 10, 1.6], z: [0, 1.2], texture: plaster}
  - {name: rack, box: [10.2, 0, 10.8, 4.2], z: [0, 2.0], texture: plaster}
  - {name: boxes, box: [12.0, 0, 13.2, 0.9], z: [0, 1.0], texture: posters}
  - {name: desk, box: [15.4, 0.4, 17.0, 1.2], z: [0, 0.8], texture: wood}
  - {name: desk, box: [18.4, 0.4, 20, 1.2], z: [0, 0.8], texture: wood}
  - {name: shelf, box: [19.6, 2.4, 20, 4.0], z: [0, 2.0], texture: posters}
  - {name: table, box: [1.8, 7.8, 4.4, 9.0], z: [0, 0.8], texture: wood}
  - {name: screen, box: [0, 7.6, 0.2, 9.2], z: [0, 2.0], texture: white}
  - {name: desk, box: [6.6, 8.8, 7.4, 10.4], z: [0, 0.8], texture: wood}
  - {name: desk, box: [10.2, 7.4, 11, 9.0], z: [0, 0.8], texture: wood}
  - {name: kitchen unit, box: [11.2, 9.8, 15, 10.4], z: [0, 0.9], texture: white}
  - {name: table, box: [13.4, 7.2, 14.4, 8.2], z: [0, 0.8], texture: wood}
  - {name: desk, box: [18.2, 8.6, 20, 9.4], z: [0, 0.8], texture: wood}
  - {name: plant, box: [15.2, 10.0, 15.6, 10.4], z: [0, 1.5], texture: posters}
  - {name: bench, box: [9.8, 4.4, 11.2, 4.8], z: [0, 0.5], texture: wood}

start: [1.0, 5.3, 0.0]   # x, y [m], yaw [rad]
)";

constexpr const char* kCorridor =
    R"(# Two rooms joined by a white shortcut of 10 m, without texture, and by a textured detour of 29 m.
name: corridor
resolution: 0.1          # [m]
wall_height: 2.5         # [m]
wall_thickness: 0.2      # [m]

textures:                # features per m^2 of surface
  brick: 40
  carpet: 35
  white: 0

rooms:                   # box: x_min, y_min, x_max, y_max [m]; rooms that touch are open to each other
  - {name: west room, box: [0, 0, 6, 6], walls: brick, floor: carpet}
  - {name: east room, box: [16, 0, 22, 6], walls: brick, floor: carpet}
  - {name: shortcut, box: [6, 2.3, 16, 3.7], walls: white, floor: white}
  - {name: detour west, box: [2, 6, 3.6, 9.6], walls: brick, floor: carpet}
  - {name: detour, box: [2, 9.6, 20, 11.2], walls: brick, floor: carpet}
  - {name: detour east, box: [18.4, 6, 20, 9.6], walls: brick, floor: carpet}

furniture:
  - {name: table, box: [3.6, 4.0, 5.0, 5.0], z: [0, 0.8], texture: brick}
  - {name: table, box: [17.2, 1.0, 18.4, 2.0], z: [0, 0.8], texture: brick}

start: [1.6, 3.0, 0.0]   # x, y [m], yaw [rad]
)";

constexpr const char* kLoop =
    R"(# A ring of corridors, 16 m x 12 m, about a closed block; alcoves; one side poor in texture.
name: loop
resolution: 0.1          # [m]
wall_height: 2.5         # [m]
wall_thickness: 0.2      # [m]

textures:                # features per m^2 of surface
  brick: 40
  carpet: 35
  plaster: 4

rooms:                   # box: x_min, y_min, x_max, y_max [m]; rooms that touch are open to each other
  - {name: south, box: [0, 0, 16, 2], walls: brick, floor: carpet}
  - {name: east, box: [14, 2, 16, 10], walls: brick, floor: carpet}
  - {name: north, box: [0, 10, 16, 12], walls: plaster, floor: plaster}
  - {name: west, box: [0, 2, 2, 10], walls: brick, floor: carpet}
  - {name: south alcove, box: [7, 2, 9, 4], walls: brick, floor: carpet}
  - {name: east alcove, box: [16, 5, 18, 7], walls: brick, floor: carpet}
  - {name: north alcove, box: [4, 12, 6, 14], walls: brick, floor: carpet}

furniture:
  - {name: crate, box: [11, 0, 12, 0.8], z: [0, 1.0], texture: brick}
  - {name: crate, box: [0, 6, 0.6, 7], z: [0, 1.0], texture: brick}

start: [1.0, 1.0, 0.0]   # x, y [m], yaw [rad]
)";

constexpr std::array<BuiltinWorld, 3> kBuiltinWorlds = {{
    {"office", "eight furnished rooms on a corridor, mixed texture", kOffice},
    {"corridor", "two rooms, a short way without texture, a long way with it", kCorridor},
    {"loop", "a ring of corridors with alcoves", kLoop},
}};

const BuiltinWorld* find(const std::string& name) {
  for (const BuiltinWorld& b : kBuiltinWorlds) {
    if (name == b.name) return &b;
  }
  return nullptr;
}

}  // namespace

std::vector<std::string> builtin_world_names() {
  std::vector<std::string> names;
  for (const BuiltinWorld& b : kBuiltinWorlds) names.emplace_back(b.name);
  return names;
}

std::string builtin_world_summary(const std::string& name) {
  const BuiltinWorld* b = find(name);
  return b == nullptr ? "" : b->summary;
}

std::string builtin_world_text(const std::string& name) {
  const BuiltinWorld* b = find(name);
  return b == nullptr ? "" : b->text;
}

}  // namespace prospect
