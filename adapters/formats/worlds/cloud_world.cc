// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/cloud_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

using Eigen::Vector3d;

constexpr double kStep = 0.05;  // [m] of heights

/// Points by column, by height.
struct Columns {
  GridFrame frame;
  std::vector<std::uint32_t> first;  // of each column, where its heights begin; and their end
  std::vector<float> all;            // heights of each column, ascending [m]

  std::span<const float> heights(int column) const {
    const auto n = static_cast<std::size_t>(column);
    return std::span(all).subspan(first[n], first[n + 1] - first[n]);
  }
};

Eigen::AlignedBox3d box_of(const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : points) box.extend(p);
  return box;
}

/// The middle one along each axis, in whole metres.
Vector3d middle_of(const std::vector<Vector3d>& points) {
  Vector3d middle;
  std::vector<double> along(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), along.begin(),
                   [axis](const Vector3d& p) { return p[axis]; });
    const auto half = along.begin() + static_cast<std::ptrdiff_t>(along.size() / 2);
    std::nth_element(along.begin(), half, along.end());
    middle[axis] = std::floor(*half);
  }
  return middle;
}

/// Points farther than a country is wide from the middle of all.
void leave_out_far(PointCloud& cloud, const std::string& name) {
  constexpr double kFarthest = 1e5;  // [m]
  const Vector3d middle = middle_of(cloud.points);
  const std::size_t all = cloud.points.size();
  std::erase_if(cloud.points, [&](const Vector3d& p) {
    return !((p - middle).cwiseAbs().maxCoeff() <= kFarthest);
  });
  const std::size_t far = all - cloud.points.size();
  if (2 * far > all) {
    throw InputError(
        name + ": " + std::to_string(far) + " of " + std::to_string(all) +
        " points are more than 100 km from the middle one; expected a cloud in metres");
  }
  if (far > 0) cloud.left_out.name(std::to_string(far) + " points more than 100 km off");
}

/// What of the points hangs together, as world_from_cloud() says.
void leave_out_strays(PointCloud& cloud, const std::string& name) {
  using Block = std::array<int, 3>;
  const Vector3d middle = middle_of(cloud.points);
  const auto block_of = [&middle](const Vector3d& p) {
    const Vector3d at = (p - middle).array().floor();
    return Block{static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z())};
  };
  struct Content {
    std::size_t points = 0;
    int part = -1;
  };
  std::map<Block, Content> blocks;
  constexpr std::size_t kMost = 5'000'000;
  for (const Vector3d& p : cloud.points) {
    ++blocks[block_of(p)].points;
    if (blocks.size() > kMost) {
      throw InputError(name + ": points in more than " + std::to_string(kMost) +
                       " cubes of a metre; expected a cloud in metres, of a building");
    }
  }
  int parts = 0, main = 0;
  std::size_t most = 0;
  std::vector<Block> open;
  for (auto& [first, content] : blocks) {
    if (content.part >= 0) continue;
    const int part = parts++;
    std::size_t points = 0;
    content.part = part;
    open.assign(1, first);
    while (!open.empty()) {
      const Block at = open.back();
      open.pop_back();
      points += blocks[at].points;
      for (int n = 0; n < 27; ++n) {
        const auto next =
            blocks.find({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
        if (next == blocks.end() || next->second.part >= 0) continue;
        next->second.part = part;
        open.push_back(next->first);
      }
    }
    if (points <= most) continue;
    most = points;
    main = part;
  }
  if (parts < 2) return;
  std::vector<Vector3d> kept;
  for (const Vector3d& p : cloud.points) {
    if (blocks[block_of(p)].part == main) kept.push_back(p);
  }
  const auto size = [](const std::vector<Vector3d>& of) {
    return (box_of(of).sizes().array() + 1.0).prod();
  };
  if (2.0 * size(kept) > size(cloud.points)) return;
  cloud.left_out.name(std::to_string(cloud.points.size() - kept.size()) +
                      " points that nothing connects to the rest");
  cloud.points = std::move(kept);
}

Columns columns_of(const std::vector<Vector3d>& points, double r) {
  const Eigen::AlignedBox3d box = box_of(points);
  Columns columns;
  // A column of nothing all round.
  const auto cell = [r](double x) { return static_cast<int>(std::floor(x / r)); };
  columns.frame = {r, cell(box.min().x()) - 1, cell(box.min().y()) - 1, 0, 0};
  columns.frame.width = cell(box.max().x()) - columns.frame.i0 + 2;
  columns.frame.height = cell(box.max().y()) - columns.frame.j0 + 2;
  const auto column_of = [&](const Vector3d& p) {
    return static_cast<std::size_t>(columns.frame.index(columns.frame.cell(p.x(), p.y())));
  };
  columns.first.assign(static_cast<std::size_t>(columns.frame.size()) + 1, 0);
  for (const Vector3d& p : points) ++columns.first[column_of(p) + 1];
  for (std::size_t n = 1; n < columns.first.size(); ++n) columns.first[n] += columns.first[n - 1];
  std::vector<std::uint32_t> next(columns.first.begin(), columns.first.end() - 1);
  columns.all.resize(points.size());
  for (const Vector3d& p : points) {
    columns.all[next[column_of(p)]++] = static_cast<float>(p.z());
  }
  for (std::size_t n = 0; n + 1 < columns.first.size(); ++n) {
    std::sort(columns.all.begin() + columns.first[n], columns.all.begin() + columns.first[n + 1]);
  }
  return columns;
}

/// Where something can be stood on in a column [m], as world_from_cloud() says.
std::vector<float> standing_heights(std::span<const float> heights) {
  constexpr float kOn = 0.1F, kRoom = 1.0F, kBelow = 1.0F;  // [m]
  std::vector<float> standing;
  for (std::size_t n = 0; n < heights.size(); ++n) {
    const float z = heights[n];
    if (n + 1 < heights.size() && heights[n + 1] < z + kRoom) continue;
    int filled = 0, last = std::numeric_limits<int>::min();
    for (std::size_t k = n; k-- > 0 && heights[k] > z - kBelow;) {
      if (heights[k] > z - kOn) continue;
      const int step = static_cast<int>(std::floor(heights[k] / kStep));
      filled += step != last;
      last = step;
    }
    if (2.0 * kStep * filled < kBelow) standing.push_back(z);
  }
  return standing;
}

struct CloudFloor {
  double height = 0.0, tolerance = 0.02;                    // [m]
  double share = std::numeric_limits<double>::quiet_NaN();  // World::floor_share
  bool found = true;
};

std::string heights_text(const std::map<int, std::size_t>& layers, std::size_t least) {
  std::string text;
  for (const auto& [step, count] : layers) {
    if (count >= least && text.size() < 100) {
      text += (text.empty() ? "" : ", ") + metres((step + 0.5) * kStep);
    }
  }
  return text;
}

/// The floor of a cloud that has none.
CloudFloor below_walls(const Columns& columns) {
  std::map<int, std::size_t> layers;
  for (const float z : columns.all) ++layers[static_cast<int>(std::floor(z / kStep))];
  std::size_t most = 0;
  for (const auto& [step, count] : layers) most = std::max(most, count);
  for (const auto& [step, count] : layers) {
    if (4 * count >= most) return {.height = step * kStep, .tolerance = 0.0, .found = false};
  }
  return {};
}

/// Columns that hold points, or are enclosed by ones that do.
std::size_t footprint(const Columns& columns) {
  const GridFrame& frame = columns.frame;
  std::vector<std::uint8_t> outside(static_cast<std::size_t>(frame.size()), 0);
  std::vector<int> open = {0};  // the corner; there is a border of columns without points
  outside[0] = 1;
  std::size_t count = outside.size() - 1;
  while (!open.empty()) {
    const Cell c = frame.at(open.back());
    open.pop_back();
    for (const Cell d : {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}}) {
      const Cell next{c.i + d.i, c.j + d.j};
      if (!frame.contains(next)) continue;
      const int n = frame.index(next);
      if (outside[static_cast<std::size_t>(n)] != 0 || !columns.heights(n).empty()) continue;
      outside[static_cast<std::size_t>(n)] = 1;
      --count;
      open.push_back(n);
    }
  }
  return count;
}

CloudFloor cloud_floor(const Columns& columns, const std::string& name,
                       const std::optional<double>& wanted) {
  constexpr double kFarthest = 0.5;  // [m]
  std::map<int, std::size_t> layers;
  std::vector<float> standing;
  for (int n = 0; n < columns.frame.size(); ++n) {
    for (const float z : standing_heights(columns.heights(n))) {
      ++layers[static_cast<int>(std::floor(z / kStep))];
      standing.push_back(z);
    }
  }
  // A floor may lie across the border of two steps.
  std::size_t most = 0;
  std::map<int, std::size_t> pairs;
  for (const auto& [step, count] : layers) {
    const auto above = layers.find(step + 1);
    pairs[step] = count + (above == layers.end() ? 0 : above->second);
    most = std::max(most, pairs[step]);
  }
  constexpr double kLeast = 0.25;  // less is the top of furniture
  const bool none = static_cast<double>(most) < kLeast * static_cast<double>(footprint(columns));
  if (none && wanted) return {.height = *wanted, .tolerance = 0.0, .found = false};
  if (none) return below_walls(columns);
  int best = 0;
  bool found = false;
  double nearest = kFarthest;
  for (const auto& [step, count] : pairs) {
    if (wanted) {
      const double off = std::abs((step + 1) * kStep - *wanted);
      if (off > nearest || 20 * count < most) continue;
      nearest = off;
    } else if (found || 2 * count < most) {
      continue;
    }
    found = true;
    best = step;
  }
  if (!found) {
    throw InputError(name + ": no ground within 0.5 m of z = " + metres(*wanted) +
                     " m; expected one of the heights " + heights_text(layers, most / 5) + " m");
  }
  std::vector<float> there;
  for (const float z : standing) {
    if (z >= best * kStep && z < (best + 2) * kStep) there.push_back(z);
  }
  const auto median = [](std::vector<float>& of) {
    const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
    std::nth_element(of.begin(), middle, of.end());
    return *middle;
  };
  CloudFloor floor;
  const float height = median(there);
  floor.height = height;
  floor.share = static_cast<double>(there.size()) / static_cast<double>(standing.size());
  for (float& z : there) z = std::abs(z - height);
  constexpr double kDeviation = 1.4826;  // of a normal distribution, by its median
  floor.tolerance = std::clamp(4.0 * kDeviation * median(there), 0.02, 0.1);
  return floor;
}

/// Which columns are floor: those with a point of it.
Grid<std::uint8_t> floor_columns(const Columns& columns, const CloudFloor& floor, double below) {
  Grid<std::uint8_t> on(columns.frame, 0);
  for (int n = 0; n < columns.frame.size(); ++n) {
    for (const float z : columns.heights(n)) {
      const double above = z - floor.height;
      if (above >= -below && above <= floor.tolerance) on.data[static_cast<std::size_t>(n)] = 1;
    }
  }
  return on;
}

/// Share of the neighbours of the floor's columns that hold points.
double closed_share(const Columns& columns, const Grid<std::uint8_t>& on) {
  std::size_t count = 0, filled = 0;
  for (int n = 0; n < on.frame.size(); ++n) {
    if (on.data[static_cast<std::size_t>(n)] == 0) continue;
    const Cell c = on.frame.at(n);
    for (const Cell d : {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}}) {
      const Cell next{c.i + d.i, c.j + d.j};
      if (!on.frame.contains(next)) continue;
      ++count;
      filled += !columns.heights(on.frame.index(next)).empty();
    }
  }
  return count == 0 ? 0.0 : static_cast<double>(filled) / static_cast<double>(count);
}

/// Sets of connected columns that are not floor, of at most a square metre, and hold no point above
/// it, become floor; or all that are not joined to the border, of any size, where there is none.
void close_gaps(const Grid<std::uint8_t>& standing, bool any_size, Grid<std::uint8_t>& on) {
  constexpr double kLargest = 1.0;  // [m^2]
  const GridFrame& frame = on.frame;
  const auto largest = static_cast<std::size_t>(kLargest / (frame.resolution * frame.resolution));
  std::vector<std::uint8_t> seen(on.data.size(), 0);
  std::vector<int> gap;
  for (int first = 0; first < frame.size(); ++first) {
    const auto free = [&](int n) {
      const auto k = static_cast<std::size_t>(n);
      return on.data[k] == 0 && standing.data[k] == 0 && seen[k] == 0;
    };
    if (!free(first)) continue;
    bool border = false;
    gap.assign(1, first);
    seen[static_cast<std::size_t>(first)] = 1;
    for (std::size_t n = 0; n < gap.size(); ++n) {
      const Cell c = frame.at(gap[n]);
      for (const Cell d : {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}}) {
        const Cell next{c.i + d.i, c.j + d.j};
        if (!frame.contains(next)) {
          border = true;
        } else if (free(frame.index(next))) {
          gap.push_back(frame.index(next));
          seen[static_cast<std::size_t>(gap.back())] = 1;
        }
      }
    }
    if (border || (!any_size && gap.size() > largest)) continue;
    for (const int n : gap) on.data[static_cast<std::size_t>(n)] = 1;
  }
}

/// Positions count from the corner where they are far from the origin.
void move_near(PointCloud& cloud) {
  constexpr double kFar = 1e4;  // [m]
  const Eigen::AlignedBox3d box = box_of(cloud.points);
  if (box.min().cwiseAbs().maxCoeff() > kFar || box.max().cwiseAbs().maxCoeff() > kFar) {
    const bool high = std::abs(box.min().z()) > kFar;
    const Vector3d corner(std::floor(box.min().x()), std::floor(box.min().y()),
                          high ? std::floor(box.min().z()) : 0.0);
    for (Vector3d& p : cloud.points) p -= corner;
    std::array<char, 100> text{};
    std::snprintf(text.data(), text.size(), "its origin (positions count from %.0f, %.0f m)",
                  corner.x(), corner.y());
    cloud.left_out.name(text.data());
  }
}

/// The voxels of a cloud whose floor is at `floor`, of those columns; `box_is_floor`: of all.
VoxelGrid voxels_of(const Columns& columns, const CloudFloor& floor, const Grid<std::uint8_t>& on,
                    int top, bool box_is_floor) {
  const GridFrame& frame = columns.frame;
  const double r = frame.resolution;
  constexpr int kLowest = -1;
  const auto depth = static_cast<std::size_t>(top + 1);
  std::vector<CellState> data(static_cast<std::size_t>(frame.size()) * depth, CellState::kUnknown);
  for (int n = 0; n < frame.size(); ++n) {
    CellState* const column = data.data() + static_cast<std::size_t>(n) * depth;
    if (on.data[static_cast<std::size_t>(n)] != 0 || box_is_floor) {
      column[0] = CellState::kOccupied;
      std::fill(column + 1, column + depth, CellState::kFree);
    }
    for (const float z : columns.heights(n)) {
      const double above = z - floor.height;
      if (above <= floor.tolerance && floor.found) continue;
      const int k = static_cast<int>(std::floor(above / r));
      if (k >= 0 && k < top) column[static_cast<std::size_t>(k - kLowest)] = CellState::kOccupied;
    }
  }
  return VoxelGrid(frame, kLowest, top + 1, std::move(data));
}

}  // namespace

World world_from_cloud(PointCloud cloud, const std::string& name,
                       const CloudWorldOptions& options) {
  constexpr std::size_t kLeast = 100;  // points
  if (cloud.points.size() < kLeast) {
    throw InputError(name + ": " + std::to_string(cloud.points.size()) +
                     " points; expected a cloud of a building");
  }
  const Eigen::Matrix3d turned = upright(options.up);
  for (Vector3d& p : cloud.points) p = turned * p;
  leave_out_far(cloud, name);
  leave_out_strays(cloud, name);
  move_near(cloud);
  const Vector3d size = box_of(cloud.points).sizes();
  const auto too_many_voxels = [&](double r) {
    const double voxels = (size.x() / r + 3.0) * (size.y() / r + 3.0) * (options.height / r + 2.0);
    return !(voxels <= static_cast<double>(options.max_voxels));
  };
  const auto look = [&](double r) {
    if (too_many_voxels(r)) {
      throw InputError(name + ": " + metres(size.x()) + " x " + metres(size.y()) +
                       " m are too many voxels of " + metres(r) +
                       " m; expected a cloud in metres, of a building, or --resolution");
    }
    if (options.progress) options.progress("columns of " + metres(r) + " m of " + name);
    return columns_of(cloud.points, r);
  };
  constexpr std::array kSizes = {0.05, 0.1, 0.2, 0.5};  // [m]
  constexpr double kWithoutFloor = 0.1, kClosed = 0.8;
  double r = options.resolution;
  const auto floor_at = [&](const Columns& columns) {
    return cloud_floor(columns, name, options.ground);
  };
  const auto below = [](double size) { return std::max(size, 0.1); };
  for (std::size_t n = 0; r == 0.0 && n < kSizes.size(); ++n) {
    if (too_many_voxels(kSizes[n])) continue;
    const Columns columns = look(kSizes[n]);
    const CloudFloor floor = floor_at(columns);
    const Grid<std::uint8_t> on = floor_columns(columns, floor, below(kSizes[n]));
    if (floor.found && closed_share(columns, on) >= kClosed) r = kSizes[n];
  }
  if (r == 0.0) r = kWithoutFloor;
  const Columns columns = look(r);
  const CloudFloor floor = floor_at(columns);
  const int top = static_cast<int>(std::ceil(options.height / r));
  Grid<std::uint8_t> on(columns.frame, 0), standing(columns.frame, 0);
  if (floor.found) on = floor_columns(columns, floor, below(r));
  for (int n = 0; n < columns.frame.size(); ++n) {
    for (const float z : columns.heights(n)) {
      const double above = z - floor.height;
      const bool stands = above > floor.tolerance && above < options.height;
      if (stands) standing.data[static_cast<std::size_t>(n)] = 1;
    }
  }
  close_gaps(standing, !floor.found, on);
  bool box_is_floor = options.unknown_is_free;
  if (!floor.found) {
    const bool encloses = std::find(on.data.begin(), on.data.end(), 1) != on.data.end();
    box_is_floor = box_is_floor || !encloses;
    cloud.left_out.name(std::string("a floor (there is none: taken at ") + metres(floor.height) +
                        " m, where its points begin, " +
                        (encloses ? "within what they enclose)" : "all over)"));
  }
  return World{.name = name,
               .voxels = voxels_of(columns, floor, on, top, box_is_floor),
               .start = {},
               .texture_density = {},
               .texture_class = {},
               .source_floor_height = floor.height,
               .left_out = std::move(cloud.left_out),
               .floor_share = floor.share};
}

}  // namespace prospect
