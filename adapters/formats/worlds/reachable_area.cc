// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/reachable_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/sloped_floor.h"
#include "engine/maps/floor_state.h"
#include "engine/maps/free_line.h"
#include "engine/maps/heading_reach.h"

namespace prospect {
namespace {

constexpr double kSlack = 1e-9;  // relative slack of comparisons between multiples of a resolution
constexpr std::array<Cell, 4> kNeighbours = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

using Mask = Grid<std::uint8_t>;

/// Columns that are not free, but have a free neighbour: the nearest point of what is not free lies
/// on one of them. One ring outside the grid included.
template <typename Visit>
void visit_outline(const Mask& free, Visit&& visit) {
  const GridFrame& frame = free.frame;
  for (int j = frame.j0 - 1; j <= frame.j0 + frame.height; ++j) {
    for (int i = frame.i0 - 1; i <= frame.i0 + frame.width; ++i) {
      if (free.get({i, j}, 0) != 0) continue;
      const bool outline = std::any_of(kNeighbours.begin(), kNeighbours.end(), [&](Cell n) {
        return free.get({i + n.i, j + n.j}, 0) != 0;
      });
      if (outline) visit(Cell{i, j});
    }
  }
}

/// Distance [in cells] from the centre of a column to the square of the column offset by (di, dj).
double distance_to_square(int di, int dj) {
  const double x = std::max(std::abs(di) - 0.5, 0.0);
  const double y = std::max(std::abs(dj) - 0.5, 0.0);
  return std::hypot(x, y);
}

/// Which columns can be lit from a point: exact propagation of the open slopes, octant by octant
/// and row by row (symmetric to recursive shadow casting), for sight lines that end anywhere in a
/// column and pass between and along corners. A superset of what lines between column centres
/// reach, so an empty answer settles that nothing is seen.
class ShadowCast {
 public:
  /// Collects the offsets from `origin` of `wanted` columns within `radius` [cells] that may be
  /// lit.
  void lit_columns(const Grid<std::uint8_t>& transparent, const Grid<std::uint8_t>& wanted,
                   Cell origin, double radius, std::vector<Cell>& lit) {
    lit.clear();
    for (int octant = 0; octant < 8; ++octant) {
      cast(transparent, wanted, origin, radius, octant, lit);
    }
  }

 private:
  struct Slopes {
    double low, high;
  };

  void cast(const Grid<std::uint8_t>& transparent, const Grid<std::uint8_t>& wanted, Cell origin,
            double radius, int octant, std::vector<Cell>& lit) {
    constexpr double kSlack = 1e-9;
    const int reach = static_cast<int>(std::floor(radius));
    open_.assign(1, {0.0, 1.0});
    for (int d = 1; d <= reach && !open_.empty(); ++d) {
      next_.clear();
      for (const Slopes& slopes : open_) {
        double low = slopes.low;
        const double high = slopes.high;
        const int first = std::max(0, static_cast<int>(std::floor(low * (d - 0.5) + 0.5 - 1e-6)));
        const int last = std::min(d, static_cast<int>(std::floor(high * (d + 0.5) + 0.5 + 1e-6)));
        for (int m = first; m <= last && low <= high; ++m) {
          // Slopes of the rays through the square (d, m); a ray meets squares in ascending m.
          const double from = m == 0 ? -1.0 : (m - 0.5) / (d + 0.5);
          const double to = (m + 0.5) / (d - 0.5);
          if (from > high || to < low) continue;
          const Cell offset = place(octant, d, m);
          const Cell cell{origin.i + offset.i, origin.j + offset.j};
          if (transparent.get(cell, 0) == 0) {
            if (from + kSlack >= low) next_.push_back({low, std::min(high, from + kSlack)});
            low = std::max(low, to - kSlack);
          } else if (wanted.get(cell, 0) != 0 && std::hypot(d, m) <= radius) {
            lit.push_back(offset);
          }
        }
        if (low <= high) next_.push_back({low, high});
      }
      std::swap(open_, next_);
    }
  }

  static Cell place(int octant, int d, int m) {
    const int i = (octant & 1) != 0 ? m : d;
    const int j = (octant & 1) != 0 ? d : m;
    return {(octant & 2) != 0 ? -i : i, (octant & 4) != 0 ? -j : j};
  }

  std::vector<Slopes> open_, next_;
};

/// Whether the segment between the centres of two columns meets transparent columns only (the first
/// is not looked at). In whole numbers, so exact; through a corner it passes unless both columns
/// beside the corner are opaque.
bool free_line(const Grid<std::uint8_t>& transparent, Cell from, Cell to) {
  const int di = std::abs(to.i - from.i), dj = std::abs(to.j - from.j);
  const int step_i = to.i > from.i ? 1 : -1, step_j = to.j > from.j ? 1 : -1;
  Cell c = from;
  for (int i = 0, j = 0; i < di || j < dj;) {
    // Which border is next: between columns in i at (2 i + 1) / (2 di), in j at (2 j + 1) / (2 dj).
    const int order = (2 * i + 1) * dj - (2 * j + 1) * di;
    if (order == 0 && transparent.get({c.i + step_i, c.j}, 0) == 0 &&
        transparent.get({c.i, c.j + step_j}, 0) == 0) {
      return false;
    }
    if (order <= 0) {
      ++i;
      c.i += step_i;
    }
    if (order >= 0) {
      ++j;
      c.j += step_j;
    }
    if (transparent.get(c, 0) == 0) return false;
  }
  return true;
}

void check(bool good, const char* what) {
  if (!good) throw std::invalid_argument(what);
}

bool positive_length(double value) { return std::isfinite(value) && value > 0.0; }

}  // namespace

Grid<std::uint8_t> free_columns(const VoxelGrid& voxels, const BodySlice& slice) {
  check(std::isfinite(slice.z_min) && std::isfinite(slice.z_max) && slice.z_max > slice.z_min,
        "body slice: z_min and z_max; expected finite heights with z_min < z_max");
  const GridFrame& frame = voxels.frame();
  const double r = frame.resolution;
  const int low = static_cast<int>(std::floor(slice.z_min / r + kSlack));
  const int high = static_cast<int>(std::ceil(slice.z_max / r - kSlack)) - 1;
  const FloorLayers floor{floor_layer(slice.step, r), std::max(low, 0)};
  Grid<std::uint8_t> free(frame, 0);
  if (low < voxels.k0() || high >= voxels.k0() + voxels.depth()) return free;
  const std::vector<CellState>& data = voxels.data();
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    const auto begin = data.begin() + static_cast<std::ptrdiff_t>(voxels.index(c.i, c.j, low));
    free.data[static_cast<std::size_t>(n)] =
        std::all_of(begin, begin + (high - low + 1),
                    [](CellState s) { return s == CellState::kFree; }) &&
                floor_state(voxels, c, floor) != FloorState::kMissing
            ? 1
            : 0;
  }
  return free;
}

Grid<std::uint8_t> standing_columns(const VoxelGrid& voxels, const BodySlice& slice) {
  check(std::isfinite(slice.standing_clearance) && slice.standing_clearance >= 0.0,
        "standing clearance; expected a finite distance of at least 0");
  const Grid<std::uint8_t> free = free_columns(voxels, slice);
  Grid<std::uint8_t> standing = free;
  const GridFrame& frame = free.frame;
  const double clearance = slice.standing_clearance / frame.resolution;
  std::vector<Cell> near;  // offsets whose centre is too near to a square that is not free
  const int reach = static_cast<int>(std::ceil(clearance + 0.5));
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      if (distance_to_square(di, dj) < clearance * (1.0 - kSlack)) near.push_back({di, dj});
    }
  }
  visit_outline(free, [&](Cell o) {
    for (const Cell& offset : near) {
      const Cell c{o.i + offset.i, o.j + offset.j};
      if (frame.contains(c)) standing[c] = 0;
    }
  });
  return standing;
}

Grid<HeadingMask> fitting_headings(const VoxelGrid& voxels, const BodySlice& slice, double room) {
  const Mask free = free_columns(voxels, slice);
  const HeadingFit fit(slice.shape, room, free.frame.resolution);
  Grid<HeadingMask> fits(free.frame, kNoHeading);
  for (std::size_t n = 0; n < free.data.size(); ++n) {
    if (free.data[n] != 0) fits.data[n] = kAllHeadings;
  }
  visit_outline(free, [&](Cell o) {
    for (const HeadingFit::Entry& e : fit.entries()) {
      const Cell c{o.i - e.di, o.j - e.dj};
      if (fits.frame.contains(c)) fits[c] &= ~e.bars;
    }
  });
  return fits;
}

Grid<std::uint8_t> connected_component(const Grid<std::uint8_t>& mask, Cell seed) {
  Grid<std::uint8_t> component(mask.frame, 0);
  if (mask.get(seed, 0) == 0) return component;
  std::vector<Cell> open{seed};
  component[seed] = 1;
  while (!open.empty()) {
    const Cell c = open.back();
    open.pop_back();
    for (const Cell& n : kNeighbours) {
      const Cell next{c.i + n.i, c.j + n.j};
      if (mask.get(next, 0) != 0 && component[next] == 0) {
        component[next] = 1;
        open.push_back(next);
      }
    }
  }
  return component;
}

namespace {

/// The columns that a disc of that radius gets to, with its centre on theirs. zones: null: none.
Mask reached_by_disc(const World& world, const BodySlice& slice, double radius,
                     const ZoneMap* zones) {
  BodySlice disc = slice;
  disc.standing_clearance = std::max(0.0, radius);
  Mask standing = standing_columns(world.voxels, disc);
  for (int n = 0; zones != nullptr && n < standing.frame.size(); ++n) {
    std::uint8_t& stands = standing.data[static_cast<std::size_t>(n)];
    if (stands != 0 && zones->distance(standing.frame.center(standing.frame.at(n))) < radius) {
      stands = 0;
    }
  }
  const Mask free = free_columns(world.voxels, slice);
  const GridFrame& frame = standing.frame;
  const Eigen::Vector2d start = world.start.position.head<2>();
  const Cell own = frame.cell(start.x(), start.y());
  constexpr double kNear = 1.0;  // [m]
  const int reach = static_cast<int>(std::ceil(kNear / frame.resolution));
  double least = kNear;
  Cell seed = own;
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      const Cell c{own.i + di, own.j + dj};
      const double distance = (frame.center(c) - start).norm();
      if (standing.get(c, 0) == 0 || distance >= least || standing.get(own, 0) != 0) continue;
      if (!visit_line(frame, start, frame.center(c),
                      [&](Cell on) { return free.get(on, 0) != 0; })) {
        continue;
      }
      least = distance;
      seed = c;
    }
  }
  return connected_component(standing, seed);
}

/// Takes the headings out at which the body would come nearer than `room` to a forbidden part.
void keep_out(const ZoneMap& zones, const ReachableAreaOptions& options, Grid<HeadingMask>& fits) {
  const BodyOutline body = body_outline(options.slice.shape);
  const double far = circumscribed_radius(options.slice.shape) + options.room;
  for (int n = 0; n < fits.frame.size(); ++n) {
    HeadingMask& headings = fits.data[static_cast<std::size_t>(n)];
    const Eigen::Vector2d center = fits.frame.center(fits.frame.at(n));
    if (headings == kNoHeading || zones.distance(center) >= far) continue;
    for (int k = 0; k < kHeadings; ++k) {
      const Pose pose{{center.x(), center.y(), 0.0}, heading_at(k)};
      for (int part = 0; part < zones.num_forbidden(); ++part) {
        if (zones.gap(part, body, pose) < options.room) headings &= ~(HeadingMask{1} << k);
      }
    }
  }
}

/// The same for a body whose heading matters.
Mask reached_by_body(const World& world, const ReachableAreaOptions& options) {
  const Mask free = free_columns(world.voxels, options.slice);
  Grid<HeadingMask> fits = fitting_headings(world.voxels, options.slice, options.room);
  if (options.zones != nullptr) keep_out(*options.zones, options, fits);
  HeadingReach reach;
  reach.update(fits, world.start.position.head<2>(), world.start.yaw, options.free_moves,
               [&](Cell c) { return free.get(c, 0) == 0; });
  Mask reached(free.frame, 0);
  for (std::size_t n = 0; n < reached.data.size(); ++n) {
    reached.data[n] = reach.reached().data[n] != kNoHeading ? 1 : 0;
  }
  return reached;
}

/// 1 where some cell at most `reach` away along either axis is not 0.
Mask widened(const Mask& mask, int reach) {
  const GridFrame& f = mask.frame;
  const auto along = [reach](int count, auto&& in, auto&& out) {
    int last = -reach - 1;  // the newest at which `in` is true, the next one ahead included
    int ahead = 0;
    for (int i = 0; i < count; ++i) {
      for (; ahead < count && ahead <= i + reach; ++ahead) {
        if (in(ahead)) last = ahead;
      }
      if (last >= i - reach && last >= 0) out(i);
    }
  };
  Mask rows(f, 0), wide(f, 0);
  for (int j = 0; j < f.height; ++j) {
    const auto at = [&](int i) { return static_cast<std::size_t>(j * f.width + i); };
    along(
        f.width, [&](int i) { return mask.data[at(i)] != 0; },
        [&](int i) { rows.data[at(i)] = 1; });
  }
  for (int i = 0; i < f.width; ++i) {
    const auto at = [&](int j) { return static_cast<std::size_t>(j * f.width + i); };
    along(
        f.height, [&](int j) { return rows.data[at(j)] != 0; },
        [&](int j) { wide.data[at(j)] = 1; });
  }
  return wide;
}

/// The ground cells that are seen from A, and their area, by the definition in the header.
void add_what_is_seen(const World& world, const ReachableAreaOptions& options,
                      ReachableArea& result) {
  const VoxelGrid& voxels = world.voxels;
  const GridFrame& frame = voxels.frame();
  const double r = frame.resolution;
  const int layer = static_cast<int>(std::floor(options.sensor_height / r + kSlack));
  const Grid<std::uint8_t> free = free_columns(voxels, options.slice);
  const Grid<std::uint8_t>& standing = result.standing;

  // Sight passes from face to face through transparent columns, so it stays within their component.
  Grid<std::uint8_t> transparent(frame, 0);
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    transparent.data[static_cast<std::size_t>(n)] =
        voxels.state(c.i, c.j, layer) == CellState::kFree ? 1 : 0;
  }
  Grid<std::uint8_t> connected(frame, 0);
  std::vector<Cell> open;
  for (int n = 0; n < frame.size(); ++n) {
    const auto index = static_cast<std::size_t>(n);
    if (standing.data[index] != 0 && transparent.data[index] != 0) {
      connected.data[index] = 1;
      open.push_back(frame.at(n));
    }
  }
  while (!open.empty()) {
    const Cell c = open.back();
    open.pop_back();
    for (const Cell& n : kNeighbours) {
      const Cell next{c.i + n.i, c.j + n.j};
      if (transparent.get(next, 0) != 0 && connected[next] == 0) {
        connected[next] = 1;
        open.push_back(next);
      }
    }
  }

  const double radius = options.range / r * (1.0 + kSlack);
  const int reach = static_cast<int>(std::floor(radius));
  constexpr int kNear = 20;  // [cells]
  const double nearby = std::min<double>(radius, kNear);
  std::vector<Cell> disc;  // offsets of what is nearby, nearest first
  for (int dj = -kNear; dj <= kNear; ++dj) {
    for (int di = -kNear; di <= kNear; ++di) {
      if (std::hypot(di, dj) <= nearby) disc.push_back({di, dj});
    }
  }
  const auto nearer = [](const Cell& a, const Cell& b) {
    return a.i * a.i + a.j * a.j < b.i * b.i + b.j * b.j;
  };
  std::stable_sort(disc.begin(), disc.end(), nearer);

  const Mask near = widened(standing, reach);
  const auto sees = [&](Cell from, Cell to) {
    return transparent[from] != 0 && free_line(transparent, from, to);
  };

  ShadowCast shadow;
  std::vector<Cell> lit;
  const auto seen = [&](Cell h) {
    if (standing[h] != 0) return true;
    if (connected[h] == 0 || near[h] == 0) return false;
    // Most columns are seen from one of the nearest places to stand; the rest is decided by first
    // finding what can be lit at all.
    int tries = 24;
    for (const Cell& offset : disc) {
      const Cell from{h.i + offset.i, h.j + offset.j};
      if (standing.get(from, 0) == 0) continue;
      if (sees(from, h)) return true;
      if (--tries == 0) break;
    }
    shadow.lit_columns(transparent, standing, h, radius, lit);
    std::stable_sort(lit.begin(), lit.end(), nearer);
    return std::any_of(lit.begin(), lit.end(), [&](const Cell& offset) {
      return sees({h.i + offset.i, h.j + offset.j}, h);
    });
  };

  const double m = options.map_resolution;
  GridFrame cells;
  cells.resolution = m;
  cells.i0 = static_cast<int>(std::floor(frame.i0 * r / m - kSlack));
  cells.j0 = static_cast<int>(std::floor(frame.j0 * r / m - kSlack));
  cells.width = static_cast<int>(std::ceil((frame.i0 + frame.width) * r / m + kSlack)) - cells.i0;
  cells.height = static_cast<int>(std::ceil((frame.j0 + frame.height) * r / m + kSlack)) - cells.j0;
  // (1): 0 no column assigned, 1 all assigned are free, 2 one is not.
  Grid<std::uint8_t> assigned(cells, 0);
  const auto hold = [&](double x, double size) {
    return static_cast<int>(std::floor(x / size + kSlack));
  };
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    std::uint8_t& state = assigned[{hold((c.i + 0.5) * r, m), hold((c.j + 0.5) * r, m)}];
    if (free.data[static_cast<std::size_t>(n)] == 0) {
      state = 2;
    } else if (state == 0) {
      state = 1;
    }
  }
  result.cells = Grid<std::uint8_t>(cells, 0);
  int count = 0;
  for (int n = 0; n < cells.size(); ++n) {
    const auto index = static_cast<std::size_t>(n);
    if (assigned.data[index] == 2) continue;
    const Cell c = cells.at(n);
    const Cell h{hold((c.i + 0.5) * m, r), hold((c.j + 0.5) * m, r)};
    if (!frame.contains(h)) continue;
    if (assigned.data[index] == 0 && free[h] == 0) continue;
    if (seen(h)) {
      result.cells.data[index] = 1;
      ++count;
    }
  }
  result.area = count * m * m;
}

}  // namespace

ReachableArea reachable_area(const World& world, const ReachableAreaOptions& options) {
  if (!world.slopes.empty()) return reachable_area(flattened(world, options.slice.step), options);
  check(positive_length(options.range), "range; expected a finite distance above 0 m");
  check(positive_length(options.map_resolution),
        "map resolution; expected a finite length above 0 m");
  check(std::isfinite(options.sensor_height), "sensor height; expected a finite height");
  check(std::isfinite(options.room), "room; expected a finite distance");
  const VoxelGrid& voxels = world.voxels;
  const int layer =
      static_cast<int>(std::floor(options.sensor_height / voxels.resolution() + kSlack));
  check(layer >= voxels.k0() && layer < voxels.k0() + voxels.depth(),
        "sensor height; expected a height within the world's layers");
  const Cell start = voxels.frame().cell(world.start.position.x(), world.start.position.y());
  if (free_columns(voxels, options.slice).get(start, 0) == 0) {
    std::ostringstream out;
    out << world.name << ": the robot cannot stand at the start (" << world.start.position.x()
        << ", " << world.start.position.y()
        << "), which is not free; expected free space from z = " << options.slice.z_min << " to "
        << options.slice.z_max << " m";
    throw InputError(out.str());
  }

  const RobotShape& shape = options.slice.shape;
  const auto seen_from = [&](Mask standing) {
    ReachableArea area;
    area.standing = std::move(standing);
    area.standing[start] = 1;
    add_what_is_seen(world, options, area);
    return area;
  };
  if (is_round(shape)) {
    return seen_from(reached_by_disc(
        world, options.slice, circumscribed_radius(shape) + options.room, options.zones.get()));
  }
  ReachableArea result = seen_from(reached_by_body(world, options));
  const ReachableArea wider = seen_from(reached_by_disc(
      world, options.slice, inscribed_radius(shape) + options.room, options.zones.get()));
  for (std::size_t n = 0; n < result.cells.data.size(); ++n) {
    if (wider.cells.data[n] == 0 || result.cells.data[n] != 0) continue;
    result.too_long_for += options.map_resolution * options.map_resolution;
  }
  return result;
}

}  // namespace prospect
