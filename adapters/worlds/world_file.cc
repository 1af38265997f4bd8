#include "adapters/worlds/world_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

#include "adapters/files/input_error.h"
#include "adapters/files/strict_yaml.h"

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

World build(const std::string& name, double r, double wall_height, double wall_thickness,
            const std::vector<Room>& rooms, const std::vector<Door>& doors,
            const std::vector<Furniture>& furniture, const Textures& textures,
            const std::string& source) {
  Eigen::Vector2d low = rooms.front().box.low, high = rooms.front().box.high;
  const auto cover = [&](const Rectangle& box) {
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  };
  for (const Room& room : rooms) cover(room.box);
  for (const Door& door : doors) cover(door.box);
  const int wall = std::max(1, static_cast<int>(std::lround(wall_thickness / r)));
  const int margin = wall + 1;
  GridFrame frame;
  frame.resolution = r;
  frame.i0 = static_cast<int>(std::floor(low.x() / r)) - margin;
  frame.j0 = static_cast<int>(std::floor(low.y() / r)) - margin;
  const double columns_x = std::ceil(high.x() / r) + margin - frame.i0;
  const double columns_y = std::ceil(high.y() / r) + margin - frame.j0;
  const int layers = std::max(1, static_cast<int>(std::lround(wall_height / r)));
  if (columns_x * columns_y * (layers + 1.0) > kMostVoxels) {
    throw InputError(source + ": " + std::to_string(static_cast<std::int64_t>(columns_x)) + " x " +
                     std::to_string(static_cast<std::int64_t>(columns_y)) + " x " +
                     std::to_string(layers + 1) + " voxels; expected at most 4e8, so a smaller " +
                     "world or a coarser resolution");
  }
  frame.width = static_cast<int>(columns_x);
  frame.height = static_cast<int>(columns_y);

  World world{name, VoxelGrid(frame, -0.5 * r, (layers - 0.5) * r), {}, textures.densities, {},
              0.0};
  world.texture_class.assign(world.voxels.data().size(), 0);
  const auto put = [&](Cell c, int k, CellState state, std::uint8_t texture) {
    world.voxels.set(c.i, c.j, k, state);
    world.texture_class[world.voxels.index(c.i, c.j, k)] = texture;
  };

  // Which room a column belongs to; the first in the file wins where rooms overlap.
  constexpr int kNoRoom = -1;
  Grid<int> room_of(frame, kNoRoom);
  for (int n = 0; n < frame.size(); ++n) {
    const Eigen::Vector2d center = frame.center(frame.at(n));
    for (std::size_t m = 0; m < rooms.size(); ++m) {
      if (!rooms[m].box.contains(center)) continue;
      room_of.data[static_cast<std::size_t>(n)] = static_cast<int>(m);
      break;
    }
  }
  std::vector<Cell> around;  // offsets, nearest first
  for (int dj = -margin; dj <= margin; ++dj) {
    for (int di = -margin; di <= margin; ++di) around.push_back({di, dj});
  }
  std::stable_sort(around.begin(), around.end(), [](const Cell& a, const Cell& b) {
    return a.i * a.i + a.j * a.j < b.i * b.i + b.j * b.j;
  });

  const double slack = 1e-6 * r;
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    const Eigen::Vector2d center = frame.center(c);
    const int own = room_of[c];
    if (own != kNoRoom) {
      const Room& room = rooms[static_cast<std::size_t>(own)];
      put(c, -1, CellState::kOccupied, room.floor);
      for (int k = 0; k < layers; ++k) put(c, k, CellState::kFree, 0);
      continue;
    }
    // The nearest room gives a wall its texture and a doorway its floor.
    const Room* nearest = nullptr;
    Cell toward{};
    for (const Cell& offset : around) {
      const int m = room_of.get({c.i + offset.i, c.j + offset.j}, kNoRoom);
      if (m == kNoRoom) continue;
      nearest = &rooms[static_cast<std::size_t>(m)];
      toward = offset;
      break;
    }
    const auto door = std::find_if(doors.begin(), doors.end(),
                                   [&](const Door& d) { return d.box.contains(center); });
    std::uint8_t texture = 0;
    if (nearest != nullptr) {
      const Side side = std::abs(toward.j) >= std::abs(toward.i) ? (toward.j < 0 ? kNorth : kSouth)
                                                                 : (toward.i < 0 ? kEast : kWest);
      texture = nearest->walls[side];
    }
    if (door != doors.end()) {
      const int open = static_cast<int>(std::lround(door->height / r));
      put(c, -1, CellState::kOccupied, nearest != nullptr ? nearest->floor : 0);
      for (int k = 0; k < layers; ++k) {
        put(c, k, k < open ? CellState::kFree : CellState::kOccupied, texture);
      }
      continue;
    }
    const bool is_wall =
        nearest != nullptr && std::max(std::abs(toward.i), std::abs(toward.j)) <= wall;
    bool beside_door = false;
    if (!is_wall) {
      for (const Cell& offset : around) {
        if (std::max(std::abs(offset.i), std::abs(offset.j)) > wall) continue;
        const Eigen::Vector2d p = frame.center({c.i + offset.i, c.j + offset.j});
        beside_door = beside_door || std::any_of(doors.begin(), doors.end(),
                                                 [&](const Door& d) { return d.box.contains(p); });
      }
    }
    if (!is_wall && !beside_door) continue;
    for (int k = -1; k < layers; ++k) put(c, k, CellState::kOccupied, texture);
  }
  for (const Furniture& piece : furniture) {
    for (int n = 0; n < frame.size(); ++n) {
      const Cell c = frame.at(n);
      if (!piece.box.contains(frame.center(c))) continue;
      for (int k = 0; k < layers; ++k) {
        const double z = (k + 0.5) * r;
        if (z < piece.z_min - slack || z >= piece.z_max - slack) continue;
        if (world.voxels.state(c.i, c.j, k) == CellState::kFree) {
          put(c, k, CellState::kOccupied, piece.texture);
        }
      }
    }
  }
  return world;
}

World read(StrictYaml yaml, const std::string& source, bool* states_start) {
  YamlMap root = yaml.root();
  const std::string name =
      root.text("name", std::filesystem::path(source).stem().string(), "name of the world");
  const double r = root.number("resolution", 0.1, 0.02, 1.0, "m", "size of a voxel");
  const double wall_height = root.number("wall_height", 2.5, 0.5, 10.0, "m", "height of the walls");
  const double wall_thickness =
      root.number("wall_thickness", 0.2, 0.01, 2.0, "m", "thickness of walls about rooms");

  Textures textures;
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

  std::vector<Room> rooms;
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
    rooms.push_back(room);
  }
  if (rooms.empty()) root.problem("rooms", "no room; expected a list of at least one");

  std::vector<Door> doors;
  for (YamlMap& map : root.maps("doors")) {
    Door door;
    map.text("name", "", "name of the door");
    door.box = read_box(map);
    door.height = map.number("height", 2.1, 0.1, 10.0, "m", "height of the opening");
    doors.push_back(door);
  }

  std::vector<Furniture> furniture;
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
    furniture.push_back(piece);
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
  World world =
      build(name, r, wall_height, wall_thickness, rooms, doors, furniture, textures, source);
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
