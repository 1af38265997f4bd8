// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/builtin_worlds.h"

#include <array>

namespace prospect {
namespace {

struct BuiltinWorld {
  const char* name;
  const char* summary;
  const char* text;
};

constexpr const char* kOffice =
    R"(# Eight rooms on a corridor, 195 m^2 of floor less the furniture: an office as people leave it, with
# things on the walls and on the desks. Three walls, the fridge and a screen are blank.
name: office
resolution: 0.1          # [m]
wall_height: 2.5         # [m]
wall_thickness: 0.2      # [m]

textures:                # features per m^2 of surface
  books: 80
  posters: 60
  brick: 40
  carpet: 35
  wood: 30
  painted: 25            # a wall with its sockets, signs and pictures
  tiles: 25
  white: 0

rooms:                   # box: x_min, y_min, x_max, y_max [m]
  - {name: corridor, box: [0, 4.4, 20, 6.2], walls: painted, east: posters, west: brick, floor: carpet}
  - {name: office 1, box: [0, 0, 5.4, 4.2], walls: painted, south: brick, floor: carpet}
  - {name: office 2, box: [5.6, 0, 10, 4.2], walls: brick, floor: carpet}
  - {name: store, box: [10.2, 0, 14.4, 4.2], walls: painted, north: white, floor: tiles}
  - {name: office 3, box: [14.6, 0, 20, 4.2], walls: painted, east: posters, floor: wood}
  - {name: meeting room, box: [0, 6.4, 6.4, 10.4], walls: posters, floor: carpet}
  - {name: office 4, box: [6.6, 6.4, 11, 10.4], walls: painted, north: brick, floor: wood}
  - {name: kitchen, box: [11.2, 6.4, 15, 10.4], walls: painted, west: white, floor: tiles}
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
  - {name: chair, box: [1.0, 0.8, 1.5, 1.3], z: [0, 0.9], texture: carpet}
  - {name: desk, box: [4.2, 0.2, 5.4, 1.0], z: [0, 0.8], texture: wood}
  - {name: shelf, box: [0, 3.8, 1.4, 4.2], z: [0, 2.0], texture: books}
  - {name: cabinet, box: [5.0, 2.4, 5.4, 3.6], z: [0, 1.6], texture: wood}
  - {name: desk, box: [5.6, 1.6, 7.2, 2.4], z: [0, 0.8], texture: wood}
  - {name: chair, box: [6.2, 1.1, 6.7, 1.6], z: [0, 0.9], texture: carpet}
  - {name: shelf, box: [7.4, 0, 8.8, 0.4], z: [0, 2.0], texture: books}
  - {name: cabinet, box: [9.4, 0, 10, 1.6], z: [0, 1.2], texture: wood}
  - {name: rack, box: [10.2, 0, 10.8, 4.2], z: [0, 2.0], texture: posters}
  - {name: boxes, box: [12.0, 0, 13.2, 0.9], z: [0, 1.0], texture: posters}
  - {name: rack, box: [13.8, 0, 14.4, 3.0], z: [0, 2.0], texture: wood}
  - {name: desk, box: [15.4, 0.4, 17.0, 1.2], z: [0, 0.8], texture: wood}
  - {name: chair, box: [15.9, 1.2, 16.4, 1.7], z: [0, 0.9], texture: carpet}
  - {name: desk, box: [18.4, 0.4, 20, 1.2], z: [0, 0.8], texture: wood}
  - {name: chair, box: [19.0, 1.2, 19.5, 1.7], z: [0, 0.9], texture: carpet}
  - {name: cabinet, box: [14.6, 2.0, 15.0, 3.4], z: [0, 1.6], texture: wood}
  - {name: shelf, box: [19.6, 2.4, 20, 4.0], z: [0, 2.0], texture: books}
  - {name: table, box: [1.8, 7.8, 4.4, 9.0], z: [0, 0.8], texture: wood}
  - {name: chair, box: [2.2, 7.3, 2.7, 7.8], z: [0, 0.9], texture: carpet}
  - {name: chair, box: [3.5, 7.3, 4.0, 7.8], z: [0, 0.9], texture: carpet}
  - {name: chair, box: [2.2, 9.0, 2.7, 9.5], z: [0, 0.9], texture: carpet}
  - {name: chair, box: [3.5, 9.0, 4.0, 9.5], z: [0, 0.9], texture: carpet}
  - {name: screen, box: [0, 7.6, 0.2, 9.2], z: [0, 2.0], texture: white}
  - {name: sideboard, box: [5.9, 8.6, 6.4, 10.2], z: [0, 0.9], texture: wood}
  - {name: desk, box: [6.6, 8.8, 7.4, 10.4], z: [0, 0.8], texture: wood}
  - {name: chair, box: [7.4, 9.3, 7.9, 9.8], z: [0, 0.9], texture: carpet}
  - {name: desk, box: [10.2, 7.4, 11, 9.0], z: [0, 0.8], texture: wood}
  - {name: chair, box: [9.7, 8.0, 10.2, 8.5], z: [0, 0.9], texture: carpet}
  - {name: shelf, box: [8.4, 10.0, 10.0, 10.4], z: [0, 2.0], texture: books}
  - {name: kitchen unit, box: [11.8, 9.8, 15, 10.4], z: [0, 0.9], texture: tiles}
  - {name: fridge, box: [11.2, 9.8, 11.8, 10.4], z: [0, 1.8], texture: white}
  - {name: table, box: [13.4, 7.2, 14.4, 8.2], z: [0, 0.8], texture: wood}
  - {name: chair, box: [13.6, 8.2, 14.1, 8.7], z: [0, 0.9], texture: carpet}
  - {name: desk, box: [18.2, 8.6, 20, 9.4], z: [0, 0.8], texture: wood}
  - {name: chair, box: [18.8, 8.1, 19.3, 8.6], z: [0, 0.9], texture: carpet}
  - {name: plant, box: [15.2, 10.0, 15.6, 10.4], z: [0, 1.5], texture: posters}
  - {name: bench, box: [9.8, 4.4, 11.2, 4.8], z: [0, 0.5], texture: wood}
  - {name: copier, box: [6.2, 5.7, 7.0, 6.2], z: [0, 1.1], texture: tiles}
  - {name: notice board, box: [13.4, 6.1, 14.6, 6.2], z: [1.0, 1.8], texture: posters}
  - {name: plant, box: [14.0, 4.4, 14.4, 4.8], z: [0, 1.5], texture: posters}

start: [1.0, 5.3, 0.0]   # x, y [m], yaw [rad]
)";

constexpr const char* kOfficeBare =
    R"(# The rooms of `office` with little in them and walls from posters to plain white: hard to see by.
name: office_bare
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

constexpr std::array<BuiltinWorld, 4> kBuiltinWorlds = {{
    {"office", "eight furnished rooms on a corridor", kOffice},
    {"office_bare", "the same rooms half empty, many walls without texture", kOfficeBare},
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
