// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/traversability.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "engine/maps/known_extent.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr double kRounding = 1e-9;  // [m]; radii given as decimals must not fail by an ulp

/// Least n with sqrt(n) r / 2 >= distance [half cells squared].
std::int32_t least_square(double distance, double resolution) {
  const double halves = std::max(0.0, 2.0 * (distance - kRounding) / resolution);
  return static_cast<std::int32_t>(std::ceil(halves * halves));
}

/// Squared distance [half cells] along one axis between the centre of a cell and the square of a
/// cell d cells away.
std::int32_t axis_square(int d) {
  const std::int32_t gap = std::max(0, 2 * std::abs(d) - 1);
  return gap * gap;
}

}  // namespace

void Traversability::Rectangle::add(int i, int j) {
  if (empty()) {
    *this = {i, j, i, j};
    return;
  }
  i0 = std::min(i0, i);
  j0 = std::min(j0, j);
  i1 = std::max(i1, i);
  j1 = std::max(j1, j);
}

std::int64_t Traversability::Rectangle::area() const {
  return empty() ? 0 : static_cast<std::int64_t>(i1 - i0 + 1) * (j1 - j0 + 1);
}

Traversability::Traversability(const TraversabilityOptions& options) : options_(options) {
  const auto& o = options_;
  check_knobs("traversability", o);
  check_parameter(o.hard_radius >= 0.0 && o.hard_radius < 10.0, "traversability", "hard_radius",
                  o.hard_radius, "0 to 10 m");
  check_parameter(o.comfortable_radius >= o.hard_radius && o.comfortable_radius < 10.0,
                  "traversability", "comfortable_radius", o.comfortable_radius,
                  "hard_radius to 10 m");
  if (o.body) {
    check_parameter(o.hard_radius >= circumscribed_radius(*o.body) - kRounding, "traversability",
                    "hard_radius", o.hard_radius, "at least the body's circumscribed radius");
    check_parameter(o.facing > 0.0, "traversability", "facing", o.facing, "more than 0 rad");
  }
  check_parameter(o.unknown_travel == 0.0 || (o.unknown_travel >= 1.0 && o.unknown_travel <= 1e3),
                  "traversability", "unknown_travel", o.unknown_travel, "0, or 1 to 1000");
  check_parameter(o.top_speed > 0.0 && o.top_speed < 1e3, "traversability", "top_speed",
                  o.top_speed, "more than 0, below 1000 m/s");
}

void Traversability::restart(const GridFrame& frame, const PausePoint& pause) {
  const double r = frame.resolution;
  hard_sq_ = least_square(options_.hard_radius - options_.lattice_slack, r);
  comfortable_sq_ = least_square(options_.comfortable_radius - options_.lattice_slack, r);
  // An occupied cell itself has distance 0 and must stay impassable whatever the radius.
  hard_sq_ = std::max(hard_sq_, 1);
  narrow_sq_ = std::max(
      least_square(options_.hard_radius - options_.lattice_slack - options_.narrow_slack, r), 1);
  comfortable_sq_ = std::max(comfortable_sq_, hard_sq_);
  limit_sq_ = std::max(comfortable_sq_, least_square(options_.comfortable_radius, r));
  reach_ = 1;
  while (axis_square(reach_) < limit_sq_) ++reach_;
  state_ = Grid<CellState>(frame, CellState::kUnknown, pause);
  see_through_ = Grid<std::uint8_t>(frame, 0, pause);
  closed_ = Grid<std::uint8_t>(frame, 0, pause);
  occupied_sq_ = Grid<std::int32_t>(frame, limit_sq_, pause);
  unknown_sq_ = Grid<std::int32_t>(frame, 0, pause);
  factor_ = Grid<float>(frame, 0.0F, pause);
  if (options_.body) {
    const double room =
        options_.hard_radius - options_.lattice_slack - circumscribed_radius(*options_.body);
    fit_ = std::make_shared<const HeadingFit>(*options_.body, room, r);
    inscribed_sq_ = std::max(1, least_square(inscribed_radius(*options_.body) + room, r));
    facing_east_ = kNoHeading;
    for (int k = 0; k < kHeadings; ++k) {
      const double off = std::abs(std::remainder(heading_at(k), 2.0 * M_PI));
      if (off <= options_.facing) facing_east_ |= HeadingMask{1} << k;
    }
    headings_ = Grid<HeadingMask>(frame, kNoHeading, pause);
    usable_ = Grid<HeadingMask>(frame, kNoHeading, pause);
    confined_ = false;
  }
  forbidden_sq_ = {};
  slowness_ = {};
  lay_zones(pause);
  explored_cells_ = 0;
  fresh_ = false;
  restarted_ = true;
}

void Traversability::widen(const GridFrame& frame, const PausePoint& pause) {
  const GridFrame old = state_.frame;
  state_.widen(frame, CellState::kUnknown, pause);
  see_through_.widen(frame, std::uint8_t{0}, pause);
  closed_.widen(frame, std::uint8_t{0}, pause);
  occupied_sq_.widen(frame, limit_sq_, pause);
  unknown_sq_.widen(frame, 0, pause);
  factor_.widen(frame, 0.0F, pause);
  if (fit_ != nullptr) {
    headings_.widen(frame, kNoHeading, pause);
    usable_.widen(frame, kNoHeading, pause);
  }
  lay_zones(pause);
  // The cells beyond the old rim are unknown, hence at distance 0 of unknown and impassable, but
  // they may lie near occupied cells within it.
  const int i1 = old.i0 + old.width - 1, j1 = old.j0 + old.height - 1;
  transform(within({old.i0 - reach_, old.j0 - reach_, i1 + reach_, old.j0 - 1}, 0), false, pause);
  transform(within({old.i0 - reach_, j1 + 1, i1 + reach_, j1 + reach_}, 0), false, pause);
  transform(within({old.i0 - reach_, old.j0, old.i0 - 1, j1}, 0), false, pause);
  transform(within({i1 + 1, old.j0, i1 + reach_, j1}, 0), false, pause);
}

Traversability::Rectangle Traversability::within(Rectangle cells, int margin) const {
  const GridFrame& f = state_.frame;
  return {std::max(cells.i0 - margin, f.i0), std::max(cells.j0 - margin, f.j0),
          std::min(cells.i1 + margin, f.i0 + f.width - 1),
          std::min(cells.j1 + margin, f.j0 + f.height - 1)};
}

// Separable: along rows the distance to the nearest target cell, then along columns the least sum
// of squares. Both only as far as the limit reaches.
void Traversability::transform(Rectangle cells, bool unknown, const PausePoint& pause) {
  if (cells.empty() || cells.j1 < cells.j0) return;
  const GridFrame& f = state_.frame;
  const int width = cells.i1 - cells.i0 + 1;
  const int row0 = cells.j0 - reach_, row1 = cells.j1 + reach_;
  const std::int32_t far = limit_sq_;
  assign_in_pieces(scratch_,
                   static_cast<std::size_t>(width) * static_cast<std::size_t>(row1 - row0 + 1), far,
                   pause);
  for (int j = row0; j <= row1; ++j) {
    pause();
    std::int32_t* row = scratch_.data() + static_cast<std::ptrdiff_t>(j - row0) * width;
    if (j < f.j0 || j >= f.j0 + f.height) {
      if (unknown) std::fill(row, row + width, 0);
      continue;
    }
    const CellState* states = state_.data.data() + static_cast<std::ptrdiff_t>(j - f.j0) * f.width;
    const auto is_target = [&](int i) {
      if (i < f.i0 || i >= f.i0 + f.width) return unknown;
      const CellState s = states[i - f.i0];
      return unknown ? s == CellState::kUnknown : s == CellState::kOccupied;
    };
    int distance = reach_ + 1;
    for (int i = cells.i0 - reach_; i <= cells.i1; ++i) {
      distance = is_target(i) ? 0 : std::min(distance + 1, reach_ + 1);
      if (i >= cells.i0) row[i - cells.i0] = std::min(far, axis_square(distance));
    }
    distance = reach_ + 1;
    for (int i = cells.i1 + reach_; i >= cells.i0; --i) {
      distance = is_target(i) ? 0 : std::min(distance + 1, reach_ + 1);
      if (i <= cells.i1) {
        row[i - cells.i0] = std::min(row[i - cells.i0], std::min(far, axis_square(distance)));
      }
    }
  }
  Grid<std::int32_t>& out = unknown ? unknown_sq_ : occupied_sq_;
  const bool zones = !unknown && !forbidden_sq_.data.empty();
  for (int j = cells.j0; j <= cells.j1; ++j) {
    pause();
    std::int32_t* to = &out[{cells.i0, j}];
    if (zones) {
      std::copy_n(&forbidden_sq_[{cells.i0, j}], width, to);
    } else {
      std::fill(to, to + width, far);
    }
    for (int d = -reach_; d <= reach_; ++d) {
      const std::int32_t* row = scratch_.data() + static_cast<std::ptrdiff_t>(j + d - row0) * width;
      const std::int32_t add = axis_square(d);
      for (int i = 0; i < width; ++i) to[i] = std::min(to[i], row[i] + add);
    }
  }
}

bool Traversability::has_path(std::size_t at) const {
  if (fit_ == nullptr) {
    // A wall may be drawn twice; a forbidden part is where it is said to be.
    const bool kept_out = !forbidden_sq_.data.empty() && forbidden_sq_.data[at] < hard_sq_;
    return state_.data[at] == CellState::kFree && occupied_sq_.data[at] >= narrow_sq_ &&
           !kept_out && closed_.data[at] == 0;
  }
  return usable_.data[at] != kNoHeading;
}

HeadingMask Traversability::facing(double direction) const {
  return fit_ == nullptr ? kAllHeadings : std::rotl(facing_east_, nearest_heading(direction));
}

// The reach may change anywhere.
void Traversability::refresh_usable(const PausePoint& pause) {
  const std::vector<HeadingMask>& now = confined_ ? reach_of_body_.reached().data : headings_.data;
  for (std::size_t n = 0; n < now.size(); ++n) {
    if (n % 4096 == 0) pause();
    if (now[n] == usable_.data[n]) continue;
    usable_.data[n] = now[n];
    changed_headings_.push_back(state_.frame.at(static_cast<int>(n)));
  }
}

// The headings at which the body has room there, whatever the state of the cell.
HeadingMask Traversability::fitting(Cell c) const {
  if (fit_ == nullptr || !state_.frame.contains(c)) return kNoHeading;
  const std::int32_t clearance_sq = occupied_sq_[c];
  if (clearance_sq >= hard_sq_) return kAllHeadings;
  if (clearance_sq < inscribed_sq_) return kNoHeading;
  HeadingMask barred = kNoHeading;
  for (const HeadingFit::Entry& e : fit_->entries()) {
    if (state_.get({c.i + e.di, c.j + e.dj}, CellState::kUnknown) != CellState::kOccupied) continue;
    barred |= e.bars;
    if (barred == kAllHeadings) break;
  }
  return ~barred;
}

void Traversability::refresh_headings(const Rectangle& cells, const PausePoint& pause) {
  if (fit_ == nullptr) return;
  for (int j = cells.j0; j <= cells.j1; ++j) {
    pause();
    for (int i = cells.i0; i <= cells.i1; ++i) {
      const bool may_stand = state_[{i, j}] == CellState::kFree && closed_[{i, j}] == 0;
      headings_[{i, j}] = may_stand ? fitting({i, j}) : kNoHeading;
    }
  }
}

// Without a state to start from the body is where the map says that it does not fit: then all
// places where it fits count. Whether it may leave is for the certificate to say.
void Traversability::refresh_reach(const Pose& pose, const PausePoint& pause) {
  reach_of_body_.update(
      headings_, pose.position.head<2>(), pose.yaw, options_.free_moves,
      [&](Cell c) { return state_.get(c, CellState::kUnknown) == CellState::kOccupied; }, pause);
  confined_ = reach_of_body_.started();
}

void Traversability::refresh_factors(const Rectangle& cells, const PausePoint& pause) {
  const auto narrow = static_cast<float>(options_.narrow_factor);
  const auto tight = static_cast<float>(options_.tight_factor);
  const auto near = static_cast<float>(options_.unknown_factor);
  const auto travel = static_cast<float>(options_.unknown_travel);
  const GridFrame& f = state_.frame;
  const auto within_rim = [&](Cell c) {
    return c.i > f.i0 && c.j > f.j0 && c.i + 1 < f.i0 + f.width && c.j + 1 < f.j0 + f.height;
  };
  for (int j = cells.j0; j <= cells.j1; ++j) {
    pause();
    for (int i = cells.i0; i <= cells.i1; ++i) {
      const auto at = static_cast<std::size_t>(state_.frame.index({i, j}));
      float factor = 0.0F;
      const std::int32_t room = occupied_sq_.data[at];
      if (has_path(at)) {
        // A body whose heading matters fits exactly or not at all: it has no narrow passages.
        factor = (room < hard_sq_ && fit_ == nullptr ? narrow
                  : room < comfortable_sq_           ? tight
                                                     : 1.0F) *
                 (unknown_sq_.data[at] < comfortable_sq_ ? near : 1.0F);
      } else if (travel > 0.0F && state_.data[at] == CellState::kUnknown &&
                 occupied_sq_.data[at] >= hard_sq_ && closed_.data[at] == 0 && within_rim({i, j})) {
        const bool ground = !options_.extent || options_.extent->contains(f.center({i, j}));
        factor = !ground ? 0.0F : travel * (occupied_sq_.data[at] < comfortable_sq_ ? tight : 1.0F);
      }
      if (!slowness_.data.empty()) factor *= slowness_.data[at];
      if (factor != factor_.data[at]) {
        factor_.data[at] = factor;
        changed_factors_.push_back({i, j});
      }
    }
  }
}

// Where the frame is new: the distances to forbidden parts and the prices of slow zones.
void Traversability::lay_zones(const PausePoint& pause) {
  if (options_.zones == nullptr) return;
  const ZoneMap& zones = *options_.zones;
  const GridFrame& f = state_.frame;
  const GridFrame old = slowness_.frame;
  if (old.width == 0) {
    forbidden_sq_ = Grid<std::int32_t>(f, limit_sq_, pause);
    slowness_ = Grid<float>(f, 1.0F, pause);
  } else {
    forbidden_sq_.widen(f, limit_sq_, pause);
    slowness_.widen(f, 1.0F, pause);
  }
  for (int n = 0; n < f.size(); ++n) {
    if (n % 256 == 0) pause();
    const Cell c = f.at(n);
    if (old.width > 0 && old.contains(c)) continue;
    const auto at = static_cast<std::size_t>(n);
    const Eigen::Vector2d center = f.center(c);
    const double halves = 2.0 * (zones.distance(center) + kRounding) / f.resolution;
    if (!(halves * halves >= limit_sq_) || halves < 0.0) {
      forbidden_sq_.data[at] =
          halves <= 0.0 ? 0 : static_cast<std::int32_t>(std::floor(halves * halves));
    }
    occupied_sq_.data[at] = std::min(occupied_sq_.data[at], forbidden_sq_.data[at]);
    const double limit = zones.speed_limit(center);
    if (limit < options_.top_speed) {
      slowness_.data[at] = static_cast<float>(options_.top_speed / limit);
    }
  }
}

void Traversability::set_zones(std::shared_ptr<const ZoneMap> zones) {
  options_.zones = std::move(zones);
  zones_moved_ = true;
}

void Traversability::shut(Cell c, double radius, int times) {
  const int reach = static_cast<int>(std::ceil(radius / state_.frame.resolution));
  const Rectangle cells = within({c.i, c.j, c.i, c.j}, reach);
  for (int j = cells.j0; j <= cells.j1; ++j) {
    for (int i = cells.i0; i <= cells.i1; ++i) {
      const double distance = state_.frame.resolution * std::hypot(i - c.i, j - c.j);
      if (distance > radius) continue;
      std::uint8_t& closed = closed_[{i, j}];
      closed = static_cast<std::uint8_t>(std::clamp(closed + times, 0, 255));
    }
  }
  refresh_headings(cells);
  for (int j = cells.j0; fit_ != nullptr && j <= cells.j1; ++j) {
    for (int i = cells.i0; i <= cells.i1; ++i) {
      const HeadingMask left = usable_[{i, j}] & headings_[{i, j}];
      if (left != usable_[{i, j}]) changed_headings_.push_back({i, j});
      usable_[{i, j}] = left;
    }
  }
  refresh_factors(cells);
}

GridFrame Traversability::with_rim(const GroundMap& ground, const PausePoint& pause) {
  GridFrame frame = ground.frame();
  if (std::int64_t{frame.width} * frame.height > KnownExtent::kAlways) {
    KnownExtent known;
    for (int ty = 0; ty < ground.tiles_y(); ++ty) {
      pause();
      for (int tx = 0; tx < ground.tiles_x(); ++tx) {
        if (ground.tile_revision(tx, ty) == 0) continue;
        const GridFrame tile = ground.tile_frame(tx, ty);
        known.add(tile.i0, tile.j0, tile.i0 + tile.width - 1, tile.j0 + tile.height - 1);
      }
    }
    const GridFrame extent = known.frame(frame.resolution, pause);
    if (extent.width > 0) frame = extent;
  }
  frame.i0 -= GroundMap::kTile;
  frame.j0 -= GroundMap::kTile;
  frame.width += 2 * GroundMap::kTile;
  frame.height += 2 * GroundMap::kTile;
  return frame;
}

bool Traversability::continues(const GroundMap& ground, const PausePoint& pause) const {
  return fresh_ || frame_of_both(with_rim(ground, pause), state_.frame).has_value();
}

// Whether the tile at that cell holds what it did. Of all frames, tiles are whole.
bool Traversability::as_before(const GroundMap& ground, Cell tile) const {
  static_assert(sizeof(CellState) == 1 && static_cast<int>(CellState::kUnknown) == 0);
  static constexpr std::uint8_t kNothing[GroundMap::kTile] = {};
  const bool mapped = ground.frame().contains(tile);
  for (int j = tile.j; j < tile.j + GroundMap::kTile; ++j) {
    const Cell row{tile.i, j};
    const void* states = mapped ? static_cast<const void*>(&ground.cells()[row]) : kNothing;
    const void* sights = mapped ? static_cast<const void*>(&ground.sights()[row]) : kNothing;
    if (std::memcmp(&state_[row], states, GroundMap::kTile) != 0 ||
        std::memcmp(&see_through_[row], sights, GroundMap::kTile) != 0) {
      return false;
    }
  }
  return true;
}

// Neighbouring rectangles overlap once widened by the influence radius; joining them where that
// costs no area avoids computing the overlap twice.
void Traversability::join(std::vector<Rectangle>& list, const PausePoint& pause) {
  // A map that has moved: all of it.
  Rectangle all{0, 0, -1, -1};
  std::int64_t area = 0;
  for (const Rectangle& cells : list) {
    all.add(cells.i0, cells.j0);
    all.add(cells.i1, cells.j1);
    area += cells.area();
  }
  if (!list.empty() && all.area() <= area) {
    list.assign(1, all);
    return;
  }
  constexpr std::size_t kAhead = 100;  // of a long list those that follow are near
  for (std::size_t a = 0; a < list.size(); ++a) {
    pause();
    for (std::size_t b = a + 1; b < std::min(list.size(), a + kAhead);) {
      Rectangle both = list[a];
      both.add(list[b].i0, list[b].j0);
      both.add(list[b].i1, list[b].j1);
      if (both.area() <= list[a].area() + list[b].area()) {
        list[a] = both;
        list[b] = list.back();
        list.pop_back();
        b = a + 1;
      } else {
        ++b;
      }
    }
  }
}

void Traversability::update(const GroundMap& ground, const Pose* pose, const PausePoint& pause) {
  changed_states_.clear();
  newly_known_.clear();
  changed_sights_.clear();
  changed_factors_.clear();
  changed_headings_.clear();
  restarted_ = false;
  const GridFrame needed = with_rim(ground, pause);
  const std::optional<GridFrame> both = fresh_ ? std::nullopt : frame_of_both(needed, state_.frame);
  const bool reframed = !both || !(*both == state_.frame);
  if (!both) {
    restart(needed, pause);
  } else if (reframed) {
    widen(*both, pause);
  }

  // What changed, as one rectangle a tile: of cells that became or ceased to be occupied, likewise
  // unknown.
  std::vector<Rectangle> occupied, unknown;
  const GridFrame& f = state_.frame;
  if (std::exchange(zones_moved_, false) && !restarted_) {
    forbidden_sq_ = {};
    slowness_ = {};
    lay_zones(pause);
    occupied.push_back({f.i0, f.j0, f.i0 + f.width - 1, f.j0 + f.height - 1});
  }
  for (std::vector<Cell>* list :
       {&changed_states_, &newly_known_, &changed_sights_, &changed_factors_, &changed_headings_}) {
    // Long ones would be moved as they grow, without a pause.
    list->reserve(static_cast<std::size_t>(f.size()));
  }
  for (int j0 = f.j0; j0 < f.j0 + f.height; j0 += GroundMap::kTile) {
    pause();
    for (int i0 = f.i0; i0 < f.i0 + f.width; i0 += GroundMap::kTile) {
      if (as_before(ground, {i0, j0})) continue;
      pause();
      Rectangle o{0, 0, -1, -1}, u{0, 0, -1, -1};
      for (int j = j0; j < j0 + GroundMap::kTile; ++j) {
        for (int i = i0; i < i0 + GroundMap::kTile; ++i) {
          const CellState now = ground.state({i, j});
          CellState& before = state_[{i, j}];
          const std::uint8_t sight = ground.see_through({i, j});
          if (see_through_[{i, j}] != sight) {
            see_through_[{i, j}] = sight;
            changed_sights_.push_back({i, j});
          }
          if (now == before) continue;
          if (before == CellState::kUnknown) newly_known_.push_back({i, j});
          if ((now == CellState::kOccupied) != (before == CellState::kOccupied)) o.add(i, j);
          if ((now == CellState::kUnknown) != (before == CellState::kUnknown)) u.add(i, j);
          explored_cells_ += (now != CellState::kUnknown) - (before != CellState::kUnknown);
          before = now;
          changed_states_.push_back({i, j});
        }
      }
      if (!o.empty()) occupied.push_back(within(o, reach_));
      if (!u.empty()) unknown.push_back(within(u, reach_));
    }
  }

  join(occupied, pause);
  join(unknown, pause);
  for (const Rectangle& cells : occupied) transform(cells, false, pause);
  for (const Rectangle& cells : unknown) transform(cells, true, pause);
  // Free to occupied and unknown to free are covered by one of the two lists; so is every change.
  if (fit_ != nullptr) {
    for (const Rectangle& cells : occupied) refresh_headings(cells, pause);
    for (const Rectangle& cells : unknown) refresh_headings(cells, pause);
    confined_ = false;
    if (pose != nullptr) refresh_reach(*pose, pause);
    refresh_usable(pause);
  }
  for (const Rectangle& cells : occupied) refresh_factors(cells, pause);
  for (const Rectangle& cells : unknown) refresh_factors(cells, pause);
  for (std::size_t n = 0; n < changed_headings_.size(); ++n) {
    if (n % 256 == 0) pause();
    const Cell c = changed_headings_[n];
    refresh_factors({c.i, c.j, c.i, c.j});
  }
  if (options_.unknown_travel > 0.0 && reframed) {
    refresh_factors({f.i0, f.j0, f.i0 + f.width - 1, f.j0 + f.height - 1}, pause);
  }
}

double Traversability::clearance(Cell c) const {
  return 0.5 * state_.frame.resolution *
         std::sqrt(static_cast<double>(occupied_sq_.get(c, limit_sq_)));
}

double Traversability::unknown_clearance(Cell c) const {
  return 0.5 * state_.frame.resolution * std::sqrt(static_cast<double>(unknown_sq_.get(c, 0)));
}

double Traversability::clearance_limit() const {
  return 0.5 * state_.frame.resolution * std::sqrt(static_cast<double>(limit_sq_));
}

double Traversability::explored_area() const {
  const double r = state_.frame.resolution;
  return static_cast<double>(explored_cells_) * r * r;
}

void describe(Knobs& knobs, TraversabilityOptions& o) {
  knobs.number("lattice_slack", o.lattice_slack, {0.0, 1.0}, "m",
               "by which a cell may be narrower than the robot needs: lattices understate gaps");
  knobs.number("tight_factor", o.tight_factor, {1.0, 1e3}, "1",
               "cost of a metre nearer to obstacles than is comfortable");
  knobs.number("narrow_slack", o.narrow_slack, {0.0, 1.0}, "m",
               "by which a narrow passage may be narrower than the robot keeps clear");
  knobs.number("narrow_factor", o.narrow_factor, {1.0, 1e4}, "1",
               "cost of a metre through what is narrower than the robot keeps clear");
  knobs.require(o.narrow_factor >= o.tight_factor, "narrow_factor",
                "narrow_factor < tight_factor; expected at least as much");
  knobs.number("unknown_factor", o.unknown_factor, {1.0, 1e3}, "1",
               "times as much where unknown space is that near");
}

}  // namespace prospect
