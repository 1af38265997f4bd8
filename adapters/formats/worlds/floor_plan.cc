// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/floor_plan.h"

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

namespace prospect {
namespace {

/// Whole decimetres, so that everything lies on voxels of 0.1 m.
struct Box {
  int x0, y0, x1, y1;

  bool within(const Box& other, int margin) const {
    return x0 < other.x1 + margin && x1 > other.x0 - margin && y0 < other.y1 + margin &&
           y1 > other.y0 - margin;
  }
  std::string text() const {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, "[%.1f, %.1f, %.1f, %.1f]", 0.1 * x0, 0.1 * y0, 0.1 * x1,
                  0.1 * y1);
    return buffer;
  }
};

constexpr int kWall = 2;

class FloorPlan {
 public:
  FloorPlan(std::uint64_t seed, const std::optional<FloorPlanSize>& size, PlanFloor floor)
      : generator_(seed) {
    columns_ = size ? size->columns : draw(3, 4);
    rows_ = size ? size->rows : draw(2, 3);
    std::vector<int> x{0}, y{0};
    for (int i = 0; i < columns_; ++i) x.push_back(x.back() + draw(32, 58) + kWall);
    for (int j = 0; j < rows_; ++j) y.push_back(y.back() + draw(32, 48) + kWall);
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        rooms_.push_back({x[at(i)], y[at(j)], x[at(i + 1)] - kWall, y[at(j + 1)] - kWall});
      }
    }
    open_doors();
    for (const Box& room : rooms_) furnish(room);
    if (floor == PlanFloor::kDrops) {
      for (const Box& room : rooms_) lower_floor(room);
    }
    if (floor == PlanFloor::kRamps) {
      for (const Box& room : rooms_) raise_floor(room);
      for (const Box& door : doors_) lay_threshold(door);
    }
  }

  std::string yaml(const std::string& name) {
    std::string text = "name: " + name +
                       "\nresolution: 0.1\nwall_height: 2.5\nwall_thickness: 0.2\n"
                       "textures: {posters: 60, brick: 40, carpet: 35, wood: 25, plaster: 6, "
                       "tiles: 4, white: 0}\nrooms:\n";
    for (const Box& room : rooms_) {
      text += "  - {box: " + room.text() + ", walls: " + wall();
      for (const char* side : {"north", "south"}) {
        if (draw(0, 2) == 0) text += std::string(", ") + side + ": " + wall();
      }
      text += std::string(", floor: ") + pick({"carpet", "wood", "tiles"}) + "}\n";
    }
    text += "doors:\n";
    for (const Box& door : doors_) text += "  - {box: " + door.text() + "}\n";
    if (!furniture_.empty()) text += "furniture:\n";
    for (const Box& piece : furniture_) {
      const int height = draw(7, 18);
      text += "  - {box: " + piece.text() + ", z: [0, " + std::to_string(height / 10) + "." +
              std::to_string(height % 10) + "], texture: " + pick({"wood", "posters", "plaster"}) +
              "}\n";
    }
    if (!drops_.empty()) text += "drops:\n";
    for (const Drop& drop : drops_) {
      text += "  - {box: " + drop.box.text() + ", depth: " + std::to_string(drop.depth / 10) + "." +
              std::to_string(drop.depth % 10) + "}\n";
    }
    if (!ramps_.empty()) text += "ramps:\n";
    for (const Ramp& ramp : ramps_) {
      char heights[64];
      std::snprintf(heights, sizeof heights, ", z: [%.2f, %.2f], up: %s}\n", 0.01 * ramp.from,
                    0.01 * ramp.to, ramp.up);
      text += "  - {box: " + ramp.box.text() + heights;
    }
    return text;
  }

 private:
  struct Drop {
    Box box;
    int depth;
  };

  struct Ramp {
    Box box;
    int from, to;  // [cm]
    const char* up;
  };

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  /// A whole number in [least, most]; not std::uniform_int_distribution, whose numbers are the
  /// library's own.
  int draw(int least, int most) {
    return least + static_cast<int>(generator_() % static_cast<std::uint64_t>(most - least + 1));
  }
  std::string pick(std::initializer_list<const char*> names) {
    return *(names.begin() + draw(0, static_cast<int>(names.size()) - 1));
  }
  std::string wall() { return pick({"brick", "posters", "plaster", "brick", "posters", "white"}); }

  /// Walls between neighbours in random order, opened where they join what was apart (Kruskal), and
  /// a quarter of the rest, so that there are loops.
  void open_doors() {
    std::vector<std::pair<int, int>> walls;
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        const int room = j * columns_ + i;
        if (i + 1 < columns_) walls.emplace_back(room, room + 1);
        if (j + 1 < rows_) walls.emplace_back(room, room + columns_);
      }
    }
    for (std::size_t n = walls.size(); n > 1; --n) {
      std::swap(walls[n - 1], walls[at(draw(0, static_cast<int>(n) - 1))]);
    }
    std::vector<int> part(rooms_.size());
    for (std::size_t n = 0; n < part.size(); ++n) part[n] = static_cast<int>(n);
    for (const auto& [a, b] : walls) {
      const int old = part[at(b)], joined = part[at(a)];
      if (old == joined && draw(0, 3) != 0) continue;
      for (int& p : part) p = p == old ? joined : p;
      doors_.push_back(door(rooms_[at(a)], rooms_[at(b)]));
    }
  }

  /// b is right of a or above it.
  Box door(const Box& a, const Box& b) {
    const int width = draw(10, 13);
    if (b.x0 > a.x1) {
      const int y = draw(a.y0 + 4, a.y1 - 4 - width);
      return {a.x1 - 1, y, b.x0 + 1, y + width};
    }
    const int x = draw(a.x0 + 4, a.x1 - 4 - width);
    return {x, a.y1 - 1, x + width, b.y0 + 1};
  }

  /// Up to three pieces against the walls, none near a door or another piece.
  void furnish(const Box& room) {
    for (int tries = 0; tries < 3; ++tries) {
      const int length = draw(8, 16), depth = draw(5, 8), side = draw(0, 3);
      Box piece{};
      if (side < 2) {  // along x
        const int x = draw(room.x0, room.x1 - length);
        const int y = side == 0 ? room.y0 : room.y1 - depth;
        piece = {x, y, x + length, y + depth};
      } else {
        const int y = draw(room.y0, room.y1 - length);
        const int x = side == 2 ? room.x0 : room.x1 - depth;
        piece = {x, y, x + depth, y + length};
      }
      const auto near_to = [&](int margin) {
        return [&piece, margin](const Box& other) { return piece.within(other, margin); };
      };
      const bool blocked = std::any_of(doors_.begin(), doors_.end(), near_to(9)) ||
                           std::any_of(furniture_.begin(), furniture_.end(), near_to(9));
      if (!blocked) furniture_.push_back(piece);
    }
  }

  /// A hole, a dock along a wall, or a stair down beside one; none where there is no place for it
  /// away from doors, furniture and other drops.
  void lower_floor(const Box& room) {
    constexpr int kTries = 8, kRun = 3, kRise = 2;
    for (int tries = 0; tries < kTries; ++tries) {
      const int kind = draw(0, 2), side = draw(0, 3);
      const int steps = kind == 2 ? draw(3, 6) : 1;
      const int length = kind == 2 ? kRun * steps : draw(5, 14);  // along the wall
      const int width = kind == 2 ? draw(9, 12) : draw(4, 9);     // away from it
      const int off = kind == 0 ? draw(0, 12) : 0;
      const int depth = kind == 0 ? draw(2, 50) : draw(6, 12);  // of a hole, of a dock
      const bool along_x = side < 2;
      const int most = along_x ? room.x1 - room.x0 - length : room.y1 - room.y0 - length;
      const int at = draw(0, most);
      const auto box = [&](int from, int to) {
        const int near = off, far = off + width;
        if (side == 0) return Box{room.x0 + from, room.y0 + near, room.x0 + to, room.y0 + far};
        if (side == 1) return Box{room.x0 + from, room.y1 - far, room.x0 + to, room.y1 - near};
        if (side == 2) return Box{room.x0 + near, room.y0 + from, room.x0 + far, room.y0 + to};
        return Box{room.x1 - far, room.y0 + from, room.x1 - near, room.y0 + to};
      };
      const Box whole = box(at, at + length);
      const auto near_to = [&](const Box& other) { return whole.within(other, 7); };
      if (std::any_of(doors_.begin(), doors_.end(), near_to) ||
          std::any_of(furniture_.begin(), furniture_.end(), near_to) ||
          std::any_of(drops_.begin(), drops_.end(),
                      [&](const Drop& drop) { return near_to(drop.box); })) {
        continue;
      }
      for (int step = 0; step < steps; ++step) {
        const Box tread = steps == 1 ? whole : box(at + kRun * step, at + kRun * (step + 1));
        drops_.push_back({tread, kind == 2 ? kRise * (step + 1) : depth});
      }
      return;
    }
  }

  /// A platform with a ramp up to it, one of four too steep; none where there is no place for it.
  void raise_floor(const Box& room) {
    constexpr int kTries = 8;
    for (int tries = 0; tries < kTries; ++tries) {
      const int height = draw(2, 3);
      const bool steep = draw(0, 3) == 0;
      // 8 degrees rise 1 in 7.1, 12 degrees 1 in 4.7.
      const int run = steep ? height * draw(25, 45) / 10 : (height * 72 + 9) / 10;
      const int length = draw(10, 14), width = draw(14, 18), side = draw(0, 3);
      const bool along_x = side % 2 == 1;
      const int dx = along_x ? run + length : width, dy = along_x ? width : run + length;
      if (room.x1 - room.x0 < dx || room.y1 - room.y0 < dy) continue;
      const int x = draw(room.x0, room.x1 - dx), y = draw(room.y0, room.y1 - dy);
      const Box whole{x, y, x + dx, y + dy};
      const auto near_to = [&](const Box& other) { return whole.within(other, 7); };
      if (std::any_of(doors_.begin(), doors_.end(), near_to) ||
          std::any_of(furniture_.begin(), furniture_.end(), near_to)) {
        continue;
      }
      Box ramp = whole, platform = whole;
      if (side == 0) ramp.y1 = platform.y0 = whole.y0 + run;
      if (side == 1) ramp.x1 = platform.x0 = whole.x0 + run;
      if (side == 2) ramp.y0 = platform.y1 = whole.y1 - run;
      if (side == 3) ramp.x0 = platform.x1 = whole.x1 - run;
      constexpr const char* kUp[] = {"north", "east", "south", "west"};
      ramps_.push_back({ramp, 0, 10 * height, kUp[side]});
      ramps_.push_back({platform, 10 * height, 10 * height, "east"});
      return;
    }
  }

  /// In every third door, none near the step that robots usually get over.
  void lay_threshold(const Box& door) {
    constexpr int kHeights[] = {2, 3, 4, 7, 8, 9};
    if (draw(0, 2) != 0) return;
    const int height = kHeights[draw(0, 5)];
    Box box = door;
    if (door.x1 - door.x0 == kWall + 2) {
      box.x0 += 1;
      box.x1 -= 1;
    } else {
      box.y0 += 1;
      box.y1 -= 1;
    }
    ramps_.push_back({box, height, height, "east"});
  }

  std::mt19937_64 generator_;
  int columns_ = 0, rows_ = 0;
  std::vector<Box> rooms_, doors_, furniture_;
  std::vector<Drop> drops_;
  std::vector<Ramp> ramps_;
};

}  // namespace

std::string random_floor_plan(std::uint64_t seed, const std::optional<FloorPlanSize>& size,
                              PlanFloor floor) {
  return FloorPlan(seed, size, floor).yaml(floor_plan_name(seed, size, floor));
}

std::string_view kind_of(PlanFloor floor) {
  return floor == PlanFloor::kDrops ? "drops" : floor == PlanFloor::kRamps ? "ramps" : "plan";
}

std::string floor_plan_name(std::uint64_t seed, const std::optional<FloorPlanSize>& size,
                            PlanFloor floor) {
  std::string name = std::string(kind_of(floor)) + ':' + std::to_string(seed);
  if (size) name += ":" + std::to_string(size->columns) + "x" + std::to_string(size->rows);
  return name;
}

}  // namespace prospect
