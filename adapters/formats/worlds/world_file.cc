// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/world_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/strict_yaml.h"
#include "engine/maps/voxel_grid.h"

namespace prospect {
namespace {

constexpr double kFarthest = 1000.0;  // [m] from the origin
constexpr double kMostVoxels = 4e8;
constexpr std::size_t kMostTextures = 250;

/// Rectangle on the ground [m]; a column belongs to it if the column's centre lies inside.
struct Rectangle {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();
  bool contains(const Eigen::Vector2d& p) const {
    return (p.array() >= low.array()).all() && (p.array() < high.array()).all();
  }
};

enum Side { kNorth, kEast, kSouth, kWest, kSides };
constexpr const char* kSideNames[kSides] = {"north", "east", "south", "west"};

struct Room {
  Rectangle box;
  std::uint8_t walls[kSides] = {};
  std::uint8_t floor = 0;
};
struct Door {
  Rectangle box;
  double height = 0.0;
};
struct Furniture {
  Rectangle box;
  double z_min = 0.0, z_max = 0.0;
  std::uint8_t texture = 0;
};

/// Where the floor of rooms and doors lies lower: a hole, a dock, a step of a stair down.
struct Drop {
  Rectangle box;
  double depth = 0.0;                     // [m]
  std::optional<std::uint8_t> texture{};  // none: the room's floor
};

/// Where it lies higher: a ramp, a threshold, a platform.
struct Ramp {
  Slope slope;
  std::optional<std::uint8_t> texture{};  // none: the room's floor
};

struct Textures {
  std::vector<std::string> names;
  std::vector<double> densities;
  std::uint8_t index(const std::string& name) const {
    const auto at = std::find(names.begin(), names.end(), name);
    return static_cast<std::uint8_t>(at == names.end() ? 0 : at - names.begin());
  }
};

Rectangle read_box(YamlMap& map) {
  const std::size_t before = map.problem_count();
  const std::vector<double> v = map.required_numbers("box", 4, -kFarthest, kFarthest, "m",
                                                     "x_min, y_min, x_max, y_max on the ground");
  if (map.problem_count() == before && !(v[0] < v[2] && v[1] < v[3])) {
    map.problem("box", "an empty box; expected x_min < x_max and y_min < y_max");
  }
  return {{v[0], v[1]}, {v[2], v[3]}};
}

/// What a world file says.
struct Building {
  std::string name;
  double resolution, wall_height, wall_thickness;  // [m]
  Textures textures;
  std::vector<Room> rooms;
  std::vector<Door> doors;
  std::vector<Furniture> furniture;
  std::vector<Drop> drops;
  std::vector<Ramp> ramps;
};

constexpr int kNoRoom = -1;

/// Of the building and the walls about it. Throws InputError if there are more voxels than can be
/// kept.
GridFrame frame_of(const Building& building, int layers, int margin, const std::string& source) {
  const double r = building.resolution;
  Eigen::Vector2d low = building.rooms.front().box.low, high = building.rooms.front().box.high;
  const auto cover = [&](const Rectangle& box) {
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  };
  for (const Room& room : building.rooms) cover(room.box);
  for (const Door& door : building.doors) cover(door.box);
  GridFrame frame;
  frame.resolution = r;
  frame.i0 = static_cast<int>(std::floor(low.x() / r)) - margin;
  frame.j0 = static_cast<int>(std::floor(low.y() / r)) - margin;
  const double columns_x = std::ceil(high.x() / r) + margin - frame.i0;
  const double columns_y = std::ceil(high.y() / r) + margin - frame.j0;
  if (columns_x * columns_y * layers > kMostVoxels) {
    throw InputError(source + ": " + std::to_string(static_cast<std::int64_t>(columns_x)) + " x " +
                     std::to_string(static_cast<std::int64_t>(columns_y)) + " x " +
                     std::to_string(layers) + " voxels; expected at most 4e8, so a smaller " +
                     "world or a coarser resolution");
  }
  frame.width = static_cast<int>(columns_x);
  frame.height = static_cast<int>(columns_y);
  return frame;
}

/// Which room a column belongs to; the first in the file wins where rooms overlap.
Grid<int> rooms_of(const Building& building, const GridFrame& frame) {
  Grid<int> room_of(frame, kNoRoom);
  for (int n = 0; n < frame.size(); ++n) {
    const Eigen::Vector2d center = frame.center(frame.at(n));
    for (std::size_t m = 0; m < building.rooms.size(); ++m) {
      if (!building.rooms[m].box.contains(center)) continue;
      room_of.data[static_cast<std::size_t>(n)] = static_cast<int>(m);
      break;
    }
  }
  return room_of;
}

/// Offsets to the cells within `margin`, nearest first.
std::vector<Cell> offsets_within(int margin) {
  std::vector<Cell> around;
  for (int dj = -margin; dj <= margin; ++dj) {
    for (int di = -margin; di <= margin; ++di) around.push_back({di, dj});
  }
  std::stable_sort(around.begin(), around.end(), [](const Cell& a, const Cell& b) {
    return a.i * a.i + a.j * a.j < b.i * b.i + b.j * b.j;
  });
  return around;
}

/// Puts up a building, column by column.
class Builder {
 public:
  Builder(const Building& building, const std::string& source)
      : building_(building),
        r_(building.resolution),
        wall_(std::max(1, static_cast<int>(std::lround(building.wall_thickness / r_)))),
        layers_(std::max(1, static_cast<int>(std::lround(building.wall_height / r_)))),
        below_(deepest_floor(building) - 1),
        frame_(frame_of(building, layers_ - below_, wall_ + 1, source)),
        room_of_(rooms_of(building, frame_)),
        around_(offsets_within(wall_ + 1)),
        world_{building.name,
               VoxelGrid(frame_, (below_ + 0.5) * r_, (layers_ - 0.5) * r_),
               {},
               building.textures.densities,
               {},
               0.0} {
    world_.texture_class.assign(world_.voxels.data().size(), 0);
  }

  World build() {
    for (int n = 0; n < frame_.size(); ++n) {
      const Cell c = frame_.at(n);
      if (const int own = room_of_[c]; own != kNoRoom) {
        lay_floor(c, building_.rooms[static_cast<std::size_t>(own)].floor);
        for (int k = 0; k < layers_; ++k) put(c, k, CellState::kFree, 0);
      } else {
        between_rooms(c);
      }
    }
    for (const Ramp& ramp : building_.ramps) fill(ramp);
    for (const Furniture& piece : building_.furniture) place(piece);
    return std::move(world_);
  }

 private:
  void put(Cell c, int k, CellState state, std::uint8_t texture) {
    world_.voxels.set(c.i, c.j, k, state);
    world_.texture_class[world_.voxels.index(c.i, c.j, k)] = texture;
  }

  /// Layer of the surface of a drop's floor: 0 is that of rooms without one.
  static int floor_of(const Drop& drop, double resolution) {
    return -std::max(1, static_cast<int>(std::lround(drop.depth / resolution)));
  }
  static int deepest_floor(const Building& building) {
    int deepest = 0;
    for (const Drop& drop : building.drops) {
      deepest = std::min(deepest, floor_of(drop, building.resolution));
    }
    return deepest;
  }

  /// Solid from the lowest layer up to the floor, free from there to z = 0. The deepest drop
  /// counts.
  void lay_floor(Cell c, std::uint8_t texture) {
    int floor = 0;
    for (const Drop& drop : building_.drops) {
      if (floor_of(drop, r_) >= floor || !drop.box.contains(frame_.center(c))) continue;
      floor = floor_of(drop, r_);
      if (drop.texture) texture = *drop.texture;
    }
    for (int k = below_; k < floor; ++k) put(c, k, CellState::kOccupied, texture);
    for (int k = floor; k < 0; ++k) put(c, k, CellState::kFree, 0);
  }

  const Door* door_at(const Eigen::Vector2d& p) const {
    const auto door = std::find_if(building_.doors.begin(), building_.doors.end(),
                                   [&](const Door& d) { return d.box.contains(p); });
    return door == building_.doors.end() ? nullptr : &*door;
  }

  bool beside_door(Cell c) const {
    return std::any_of(around_.begin(), around_.end(), [&](const Cell& offset) {
      return std::max(std::abs(offset.i), std::abs(offset.j)) <= wall_ &&
             door_at(frame_.center({c.i + offset.i, c.j + offset.j})) != nullptr;
    });
  }

  /// A wall, a doorway, or nothing.
  void between_rooms(Cell c) {
    // The nearest room gives a wall its texture and a doorway its floor.
    const Room* nearest = nullptr;
    Cell toward{};
    for (const Cell& offset : around_) {
      const int m = room_of_.get({c.i + offset.i, c.j + offset.j}, kNoRoom);
      if (m == kNoRoom) continue;
      nearest = &building_.rooms[static_cast<std::size_t>(m)];
      toward = offset;
      break;
    }
    std::uint8_t texture = 0;
    if (nearest != nullptr) {
      const Side side = std::abs(toward.j) >= std::abs(toward.i) ? (toward.j < 0 ? kNorth : kSouth)
                                                                 : (toward.i < 0 ? kEast : kWest);
      texture = nearest->walls[side];
    }
    if (const Door* door = door_at(frame_.center(c))) {
      const int open = static_cast<int>(std::lround(door->height / r_));
      lay_floor(c, nearest != nullptr ? nearest->floor : std::uint8_t{0});
      for (int k = 0; k < layers_; ++k) {
        put(c, k, k < open ? CellState::kFree : CellState::kOccupied, texture);
      }
      return;
    }
    const bool is_wall =
        nearest != nullptr && std::max(std::abs(toward.i), std::abs(toward.j)) <= wall_;
    if (!is_wall && !beside_door(c)) return;
    for (int k = below_; k < layers_; ++k) put(c, k, CellState::kOccupied, texture);
  }

  /// What is below it is solid, as far as it is whole voxels of free space.
  void fill(const Ramp& ramp) {
    const Slope& slope = ramp.slope;
    for (int n = 0; n < frame_.size(); ++n) {
      const Cell c = frame_.at(n);
      const Eigen::Vector2d center = frame_.center(c);
      if (!slope.contains(center)) continue;
      const double lowest = slope.at(center) - 0.5 * r_ * slope.rise.lpNorm<1>();
      const auto top = static_cast<int>(std::floor(lowest / r_ + kFaceTolerance));
      for (int k = below_; k < std::min(top, layers_); ++k) {
        if (world_.voxels.state(c.i, c.j, k) != CellState::kFree) continue;
        put(c, k, CellState::kOccupied, ramp.texture.value_or(floor_texture(c)));
      }
    }
    world_.slopes.push_back(slope);
  }
  std::uint8_t floor_texture(Cell c) const {
    const int own = room_of_[c];
    return own == kNoRoom ? 0 : building_.rooms[static_cast<std::size_t>(own)].floor;
  }

  void place(const Furniture& piece) {
    const double slack = 1e-6 * r_;
    for (int n = 0; n < frame_.size(); ++n) {
      const Cell c = frame_.at(n);
      if (!piece.box.contains(frame_.center(c))) continue;
      for (int k = 0; k < layers_; ++k) {
        const double z = (k + 0.5) * r_;
        if (z < piece.z_min - slack || z >= piece.z_max - slack) continue;
        if (world_.voxels.state(c.i, c.j, k) == CellState::kFree) {
          put(c, k, CellState::kOccupied, piece.texture);
        }
      }
    }
  }

  const Building& building_;
  const double r_;           // [m]
  const int wall_, layers_;  // voxels
  const int below_;          // the lowest layer
  const GridFrame frame_;
  const Grid<int> room_of_;
  const std::vector<Cell> around_;
  World world_;
};

Ramp read_ramp(YamlMap& map) {
  Ramp ramp;
  const Rectangle box = read_box(map);
  ramp.slope.low = box.low;
  ramp.slope.high = box.high;
  const std::vector<double> z =
      map.required_numbers("z", 2, 0.0, 10.0, "m", "height of its lower and of its upper end");
  if (z.size() == 2 && !(z[0] <= z[1] && z[1] > 0.0)) {
    map.problem("z", "no height; expected lower <= upper, and upper above 0");
  }
  const std::string up =
      map.choice("up", "east", {"north", "east", "south", "west"}, "where its upper end is");
  if (z.size() != 2) return ramp;
  const int axis = up == "east" || up == "west" ? 0 : 1;
  const double run = box.high[axis] - box.low[axis];
  const bool along = up == "east" || up == "north";
  ramp.slope.height = along ? z[0] : z[1];
  if (run > 0.0) ramp.slope.rise[axis] = (along ? z[1] - z[0] : z[0] - z[1]) / run;
  return ramp;
}

World read(StrictYaml yaml, const std::string& source, bool* states_start) {
  YamlMap root = yaml.root();
  Building building;
  building.name =
      root.text("name", std::filesystem::path(source).stem().string(), "name of the world");
  building.resolution = root.number("resolution", 0.1, 0.02, 1.0, "m", "size of a voxel");
  building.wall_height = root.number("wall_height", 2.5, 0.5, 10.0, "m", "height of the walls");
  building.wall_thickness =
      root.number("wall_thickness", 0.2, 0.01, 2.0, "m", "thickness of walls about rooms");

  Textures& textures = building.textures;
  YamlMap texture_map = root.map("textures");
  const std::vector<std::string> texture_names = texture_map.keys();
  if (texture_names.size() > kMostTextures) {
    throw InputError(texture_map.where() + ": textures: " + std::to_string(texture_names.size()) +
                     " of them; expected at most " + std::to_string(kMostTextures));
  }
  for (const std::string& texture : texture_names) {
    textures.names.push_back(texture);
    textures.densities.push_back(
        texture_map.required_number(texture, 0.0, 1e4, "1/m^2", "features per area of surface"));
  }
  if (textures.names.empty()) {
    root.problem("textures", "no texture; expected at least one, as name: features per m^2");
  }
  const auto texture = [&](YamlMap& map, const char* key, const char* description) {
    return textures.index(map.required_choice(key, textures.names, description));
  };

  for (YamlMap& map : root.maps("rooms")) {
    Room room;
    map.text("name", "", "name of the room");
    room.box = read_box(map);
    const std::string walls = map.required_choice("walls", textures.names, "texture of the walls");
    for (int side = 0; side < kSides; ++side) {
      room.walls[side] = textures.index(
          map.choice(kSideNames[side], walls, textures.names, "texture of one wall"));
    }
    room.floor = texture(map, "floor", "texture of the floor");
    building.rooms.push_back(room);
  }
  if (building.rooms.empty()) root.problem("rooms", "no room; expected a list of at least one");

  for (YamlMap& map : root.maps("doors")) {
    Door door;
    map.text("name", "", "name of the door");
    door.box = read_box(map);
    door.height = map.number("height", 2.1, 0.1, 10.0, "m", "height of the opening");
    building.doors.push_back(door);
  }

  for (YamlMap& map : root.maps("furniture")) {
    Furniture piece;
    map.text("name", "", "name of the piece");
    piece.box = read_box(map);
    const std::vector<double> z =
        map.numbers("z", {0.0, 0.8}, 2, 0.0, 10.0, "m", "lower and upper end");
    piece.z_min = z[0];
    piece.z_max = z[1];
    if (!(z[0] < z[1])) map.problem("z", "an empty range; expected z_min < z_max");
    piece.texture = texture(map, "texture", "texture of the piece");
    building.furniture.push_back(piece);
  }

  for (YamlMap& map : root.maps("drops")) {
    Drop drop;
    map.text("name", "", "name of the drop");
    drop.box = read_box(map);
    drop.depth = map.required_number("depth", 0.01, 20.0, "m", "of its floor below the others'");
    if (map.has("texture"))
      drop.texture = texture(map, "texture", "texture of its floor and sides");
    building.drops.push_back(drop);
  }

  for (YamlMap& map : root.maps("ramps")) {
    map.text("name", "", "name of the ramp");
    Ramp ramp = read_ramp(map);
    if (map.has("texture")) ramp.texture = texture(map, "texture", "texture of its top and sides");
    building.ramps.push_back(ramp);
  }

  Pose start;
  const bool stated = root.has("start");
  if (stated) {
    const std::vector<double> v =
        root.required_numbers("start", 3, -kFarthest, kFarthest, "", "x, y [m], yaw [rad]");
    start.position = {v[0], v[1], 0.0};
    start.yaw = v[2];
  } else {
    root.numbers("start", {}, 3, -kFarthest, kFarthest, "", "x, y [m], yaw [rad]");
  }
  yaml.finish();
  World world = Builder(building, source).build();
  world.start = start;
  if (states_start != nullptr) *states_start = stated;
  return world;
}

}  // namespace

World world_from_file(const std::string& path, bool* states_start) {
  return read(StrictYaml::from_file(path), path, states_start);
}

World world_from_yaml(const std::string& text, const std::string& source, bool* states_start) {
  return read(StrictYaml::from_text(text, source), source, states_start);
}

}  // namespace prospect
