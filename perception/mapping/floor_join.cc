// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/floor_join.h"

#include <algorithm>
#include <cmath>

namespace prospect {
namespace {

// Direction d + 4 is opposite to d.
constexpr Cell kAround[] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

Cell beside(Cell c, int d, int steps = 1) {
  return {c.i + steps * kAround[d].i, c.j + steps * kAround[d].j};
}
/// To the cell beside, where rows are `row` cells long.
std::ptrdiff_t offset(int d, std::ptrdiff_t row) { return kAround[d].j * row + kAround[d].i; }
double stride(int d) { return d % 2 == 0 ? 1.0 : M_SQRT2; }

}  // namespace

FloorJoin::FloorJoin(double resolution, int k_body, double step)
    : r_(resolution),
      step_(step),
      highest_(step),
      most_rise_(most_that_joins(M_SQRT2 * resolution, step)),
      k_body_(k_body),
      reach_(std::max(1, static_cast<int>(kBaseline / resolution + 1e-9))) {
  for (int d = 0; d < 2; ++d) {
    const double way = r_ * stride(d);
    for (int n = 0; n <= reach_; ++n) {
      limits_[d].push_back(most_that_joins(way * static_cast<double>(n), step_) + kHeightRounding);
    }
  }
}

void FloorJoin::add_tile(Cell tile) {
  const int stencil = std::max(reach_, kSpread) + 2;
  const auto about = [&](int margin) {
    return GridFrame{r_, tile.i * kTile - margin, tile.j * kTile - margin, kTile + 2 * margin,
                     kTile + 2 * margin};
  };
  if (is_flat()) {
    spots_ = Grid<Spot>(about(stencil), {});
  } else if (frame_around_both(spots_.frame, about(stencil)) != spots_.frame) {
    constexpr int kMargin = 4 * kTile;  // so that it seldom grows
    spots_.widen(frame_around_both(spots_.frame, about(stencil + kMargin)), {});
  }
  for (int j = 0; j < kTile; ++j) {
    for (int i = 0; i < kTile; ++i) {
      spots_[{tile.i * kTile + i, tile.j * kTile + j}].here = true;
    }
  }
}

// The spot of a cell that is not flat: all within kSpread have one from now on.
FloorJoin::Spot& FloorJoin::spot(Cell c) {
  for (const Cell corner : {Cell{-kSpread, -kSpread}, Cell{kSpread, -kSpread},
                            Cell{-kSpread, kSpread}, Cell{kSpread, kSpread}}) {
    const Cell at{c.i + corner.i, c.j + corner.j};
    if (find(at) == nullptr) add_tile(tile_of(at));
  }
  return *find(c);
}

float FloorJoin::height(Cell c) const {
  const Spot* s = find(c);
  return s != nullptr ? s->height : std::numeric_limits<float>::quiet_NaN();
}
int FloorJoin::level(Cell c) const {
  const Spot* s = find(c);
  return s != nullptr ? s->level : 0;
}
void FloorJoin::levels(Cell first, int side, int* into) const {
  const Spot* s = find(first);
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) into[j * side + i] = s != nullptr ? s[i].level : 0;
    if (s != nullptr && j + 1 < side) s += spots_.frame.width;
  }
}
bool FloorJoin::closed(Cell c) const {
  const Spot* s = find(c);
  return s != nullptr && s->closed;
}

const FloorSurface* FloorJoin::flat_of(const std::vector<FloorSurface>& found) const {
  const FloorSurface* flat = nullptr;
  for (const FloorSurface& s : found) {
    if (s.k >= k_body_ || s.is_low || (s.k >= 0 && s.z > step_)) continue;
    if (flat == nullptr || s.k > flat->k) flat = &s;
  }
  return flat;
}

const FloorSurface* FloorJoin::joining(const std::vector<FloorSurface>& found, double from,
                                       double way) const {
  const FloorSurface* best = nullptr;
  for (const FloorSurface& s : found) {
    if (s.k < k_body_ && (s.k < 0 || !s.level)) continue;
    const double off = std::abs(s.z - from);
    if (joins(off, way, step_) && (best == nullptr || off < std::abs(best->z - from))) best = &s;
  }
  return best;
}

// The ground of a cell; a flat one is looked at when it is asked for.
float FloorJoin::ground(Cell c) {
  Spot* s = find(c);
  if (s != nullptr && s->looked) return s->height;
  beside_.clear();
  (*surfaces_)(c, beside_);
  const FloorSurface* flat = flat_of(beside_);
  const float z = flat == nullptr ? std::numeric_limits<float>::quiet_NaN()
                  : flat->k < 0   ? 0.0F
                                  : static_cast<float>(flat->z);
  if (s != nullptr) {
    s->looked = true;
    s->height = z;
    s->joined_to = flat != nullptr ? kFlat : kNone;
  }
  return z;
}

void FloorJoin::set_ground(Cell c, Spot& s, double z, std::uint8_t joined_to) {
  s.looked = true;
  s.low = false;
  const bool was_flat = s.joined_to == kFlat;
  s.joined_to = joined_to;
  // Also where it does not join what it has been joined to any more.
  if (was_flat == (joined_to == kFlat) && std::abs(z - s.height) < kSettled) return;
  s.height = static_cast<float>(z);
  highest_ = std::max(highest_, z);
  moved_.push_back(c);
  for (int d = 0; d < 8; ++d) {
    const Cell at = beside(c, d);
    const Spot* other = find(at);
    if (other == nullptr || !other->looked) continue;
    if (other->joined_to == (d + 4) % 8 &&
        !joins(std::abs(other->height - s.height), r_ * stride(d), step_)) {
      let_go(at);
    } else if (std::isnan(other->height)) {
      queue_.push_back(at);
    }
  }
}

// Takes the ground from a cell, and from all that has grown from it.
void FloorJoin::let_go(Cell first) {
  std::vector<Cell> left{first};
  while (!left.empty()) {
    const Cell c = left.back();
    left.pop_back();
    Spot& s = *find(c);
    if (std::isnan(s.height)) continue;
    s.height = std::numeric_limits<float>::quiet_NaN();
    s.joined_to = kNone;
    moved_.push_back(c);
    queue_.push_back(c);
    for (int d = 0; d < 8; ++d) {
      const Spot* other = find(beside(c, d));
      if (other != nullptr && other->joined_to == (d + 4) % 8) left.push_back(beside(c, d));
    }
  }
}

void FloorJoin::review(Cell c) {
  Spot* s = find(c);
  found_.clear();
  (*surfaces_)(c, found_);
  const FloorSurface* flat = flat_of(found_);
  if (flat != nullptr) {
    if (s != nullptr && s->looked) set_ground(c, *s, flat->k < 0 ? 0.0 : flat->z, kFlat);
    return;
  }
  if (s != nullptr) {
    s->looked = true;
    if (!std::isnan(s->height)) {
      const FloorSurface* still = nullptr;
      if (s->joined_to < 8) {
        const int d = s->joined_to;
        still = joining(found_, ground(beside(c, d)), r_ * stride(d));
      }
      if (still != nullptr) {
        set_ground(c, *s, still->z, s->joined_to);
        return;
      }
      let_go(c);
    } else if (found_.empty() && !s->low) {
      return;
    }
  } else if (found_.empty()) {
    return;
  }
  queue_.push_back(c);
}

void FloorJoin::grow() {
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const Cell c = queue_[next];
    const Spot* known = find(c);
    if (known != nullptr && known->looked && !std::isnan(known->height)) continue;
    found_.clear();
    (*surfaces_)(c, found_);
    if (found_.empty() && known == nullptr) continue;
    if (flat_of(found_) != nullptr) {
      ground(c);
      continue;
    }
    const FloorSurface* best = nullptr;
    int direction = 0;
    double least = 0.0;
    for (int d = 0; d < 8 && !found_.empty(); ++d) {
      const double from = ground(beside(c, d));
      if (std::isnan(from)) continue;
      const FloorSurface* there = joining(found_, from, r_ * stride(d));
      if (there == nullptr || (best != nullptr && std::abs(there->z - from) >= least)) continue;
      best = there;
      direction = d;
      least = std::abs(there->z - from);
    }
    if (best == nullptr) {
      close_low(c);
      continue;
    }
    const double z = best->z;
    set_ground(c, spot(c), z, static_cast<std::uint8_t>(direction));
    for (int d = 0; d < 8; ++d) {
      if (std::isnan(ground(beside(c, d)))) queue_.push_back(beside(c, d));
    }
  }
  queue_.clear();
}

// Of found_, of a cell that joins nothing.
void FloorJoin::close_low(Cell c) {
  const bool low =
      std::any_of(found_.begin(), found_.end(), [](const FloorSurface& s) { return s.is_low; });
  Spot* s = find(c);
  if (low ? s != nullptr && s->low : s == nullptr || !s->low) return;
  Spot& now = spot(c);
  now.looked = true;
  now.low = low;
  moved_.push_back(c);
}

int FloorJoin::level_of(Cell c, const Spot& s) {
  if (s.joined_to == kFlat || s.low) return 0;
  if (!std::isnan(s.height)) {
    if (s.reached_by == kNone) return 0;
    // A layer is left when its edge is passed for certain.
    const double above = (s.height + kAbove) / r_ - s.level, certain = kSettled / r_;
    if (s.own && s.level > 0 && above > -certain && above < 1.0 + certain) return s.level;
    return std::max(0, static_cast<int>(std::floor((s.height + kAbove) / r_)));
  }
  int level = 0, nearest = 2 * kSpread * kSpread + 1;
  const std::ptrdiff_t here = spots_.frame.index(c), row = spots_.frame.width;
  for (int ring = 1; ring <= kSpread && ring * ring < nearest; ++ring) {
    for (int j = -ring; j <= ring; ++j) {
      const int step = std::abs(j) == ring ? 1 : 2 * ring;
      for (int i = -ring; i <= ring; i += step) {
        const std::ptrdiff_t at = here + j * row + i;
        if (i * i + j * j >= nearest || std::isnan(ground({c.i + i, c.j + j}, at))) continue;
        const Spot& other = spots_.data[static_cast<std::size_t>(at)];
        if (!other.here || other.closed || !is_reached(other)) continue;
        nearest = i * i + j * j;
        level = other.joined_to == kFlat ? 0 : other.level;
      }
    }
  }
  return level;
}

bool FloorJoin::is_edge(Cell c, const Spot& s) {
  const std::ptrdiff_t here = spots_.frame.index(c), row = spots_.frame.width;
  if (!std::isnan(s.height)) {
    if (!(s.height > step_)) return false;
    for (int d = 0; d < 8; ++d) {
      const double other = ground(beside(c, d), here + offset(d, row));
      if (!std::isnan(other) && !joins(s.height - other, r_ * stride(d), step_)) return true;
    }
    return false;
  }
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int j = -2; j <= 2; ++j) {
    for (int i = -2; i <= 2; ++i) {
      const double z = ground({c.i + i, c.j + j}, here + j * row + i);
      if (std::isnan(z)) continue;
      low = std::min(low, z);
      high = std::max(high, z);
    }
  }
  return high > step_ && !joins(high - low, 4.0 * r_, step_);
}

bool FloorJoin::is_steep(Cell c) {
  const std::ptrdiff_t at_c = spots_.frame.index(c), row = spots_.frame.width;
  const double here = spots_.data[static_cast<std::size_t>(at_c)].height;
  std::vector<double>& line = line_;
  for (int d = 0; d < 4; ++d) {
    const std::ptrdiff_t on = offset(d, row);
    const double way = r_ * stride(d);
    const int reach = std::max(1, static_cast<int>(reach_ / stride(d)));
    const double next = ground(beside(c, d), at_c + on);
    const double last = ground(beside(c, d + 4), at_c - on);
    // Most of what is looked at is nearly level.
    const double little = 0.49 * kSteepest * way;
    if (!(std::abs(next - here) > little) && !(std::abs(last - here) > little)) continue;
    const bool goes_on = !std::isnan(next) && joins(std::abs(next - here), way, step_);
    const bool came = !std::isnan(last) && joins(std::abs(last - here), way, step_);
    if (!goes_on && !came) continue;
    const double slope = ((goes_on ? next : here) - (came ? last : here)) /
                         (way * ((goes_on ? 1 : 0) + (came ? 1 : 0)));
    if (std::abs(slope) < 0.5 * kSteepest) continue;
    const std::vector<double>& limits = limits_[d % 2];
    // From behind to ahead, as far as each joins the one before.
    line.assign(1, here);
    const auto extend = [&](int direction) {
      for (int steps = 1; steps <= reach; ++steps) {
        const double z =
            ground(beside(c, direction, steps), at_c + (direction < 4 ? steps : -steps) * on);
        if (std::isnan(z) || !joins(std::abs(z - line.back()), way, step_)) break;
        line.push_back(z);
      }
    };
    extend(d + 4);
    std::reverse(line.begin(), line.end());
    const std::size_t at = line.size() - 1;
    extend(d);
    for (std::size_t a = 0; a <= at; ++a) {
      for (std::size_t b = at; b < line.size() && b - a <= static_cast<std::size_t>(reach); ++b) {
        if (!(std::abs(line[b] - line[a]) <= limits[b - a])) return true;
      }
    }
  }
  return false;
}

// What can be reached, where ground has moved or been closed or opened: collected in reached_.
void FloorJoin::reach(const std::vector<Cell>& shut) {
  reached_.clear();
  queue_.clear();
  std::vector<Cell> left;
  const auto leads = [&](Cell from, Cell to, double way) {
    const Spot* a = find(from);
    return a != nullptr && !a->closed && is_reached(*a) &&
           joins(std::abs(a->height - find(to)->height), way, step_);
  };
  const auto check = [&](Cell c) {
    Spot& s = *find(c);
    if (s.joined_to == kFlat || std::isnan(s.height)) {
      if (s.reached_by != kNone) left.push_back(c);
    } else if (s.reached_by == kNone) {
      queue_.push_back(c);
    } else if (!leads(beside(c, s.reached_by), c, r_ * stride(s.reached_by))) {
      left.push_back(c);
    }
  };
  const auto check_around = [&](Cell c) {
    check(c);
    for (int d = 0; d < 8; ++d) {
      if (find(beside(c, d)) != nullptr) check(beside(c, d));
    }
  };
  for (const Cell c : moved_) check_around(c);
  for (const Cell c : shut) check_around(c);
  while (!left.empty()) {
    const Cell c = left.back();
    left.pop_back();
    Spot& s = *find(c);
    if (s.reached_by == kNone) continue;
    s.reached_by = kNone;
    reached_.push_back(c);
    queue_.push_back(c);
    for (int d = 0; d < 8; ++d) {
      const Spot* other = find(beside(c, d));
      if (other != nullptr && other->reached_by == (d + 4) % 8) left.push_back(beside(c, d));
    }
  }
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const Cell c = queue_[next];
    Spot& s = *find(c);
    if (s.joined_to == kFlat || s.reached_by != kNone || std::isnan(s.height)) continue;
    for (int d = 0; d < 8 && s.reached_by == kNone; ++d) {
      if (!std::isnan(ground(beside(c, d))) && leads(beside(c, d), c, r_ * stride(d))) {
        s.reached_by = static_cast<std::uint8_t>(d);
      }
    }
    if (s.reached_by == kNone) continue;
    reached_.push_back(c);
    for (int d = 0; d < 8; ++d) {
      const Spot* other = find(beside(c, d));
      if (other != nullptr && !is_reached(*other)) queue_.push_back(beside(c, d));
    }
  }
  queue_.clear();
}

// Levels and closed cells, of what has moved and of what is near.
void FloorJoin::judge() {
  changed_.clear();
  if (moved_.empty()) return;
  std::vector<Cell> listed, shut;
  const std::ptrdiff_t row = spots_.frame.width;
  const auto note = [&](Cell c, std::ptrdiff_t at) {
    Spot& s = spots_.data[static_cast<std::size_t>(at)];
    if (!s.here || s.noted == list_) return;
    s.noted = list_;
    listed.push_back(c);
  };
  const auto note_square = [&](Cell c, int reach) {
    const std::ptrdiff_t at = spots_.frame.index(c);
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) note({c.i + i, c.j + j}, at + j * row + i);
    }
  };
  const auto level = [&](Cell c) {
    Spot& s = *find(c);
    const auto now = static_cast<std::int16_t>(level_of(c, s));
    s.own = !std::isnan(s.height);
    if (now == s.level) return;
    s.level = now;
    changed_.push_back(c);
  };
  ++list_;
  for (const Cell c : moved_) {
    note_square(c, 2);
    const std::ptrdiff_t at = spots_.frame.index(c);
    for (int d = 0; d < 8; ++d) {
      for (int steps = 3; steps <= reach_; ++steps) {
        note(beside(c, d, steps), at + steps * offset(d, row));
      }
    }
  }
  for (const Cell c : listed) {
    const float z = ground(c);
    Spot& s = *find(c);
    const bool closed = s.low || is_edge(c, s) || (!std::isnan(z) && is_steep(c));
    if (closed == s.closed) continue;
    s.closed = closed;
    shut.push_back(c);
  }
  reach(shut);
  // What has ground first: others have its level.
  ++list_;
  listed.clear();
  for (const Cell c : moved_) note(c, spots_.frame.index(c));
  for (const Cell c : reached_) note(c, spots_.frame.index(c));
  for (const Cell c : listed) level(c);
  const std::size_t own = listed.size();
  for (const Cell c : moved_) note_square(c, kSpread);
  for (const Cell c : reached_) note_square(c, kSpread);
  for (const Cell c : shut) note_square(c, kSpread);
  for (std::size_t n = own; n < listed.size(); ++n) {
    if (std::isnan(ground(listed[n])) && !find(listed[n])->low) level(listed[n]);
  }
  ++list_;
  for (const Cell c : changed_) find(c)->noted = list_;
  for (const Cell c : shut) {
    if (find(c)->noted != list_) changed_.push_back(c);
  }
}

void FloorJoin::look(const std::vector<Cell>& cells, const Surfaces& surfaces) {
  surfaces_ = &surfaces;
  moved_.clear();
  queue_.clear();
  for (const Cell c : cells) review(c);
  grow();
  judge();
  surfaces_ = nullptr;
}

}  // namespace prospect
