// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/heading_reach.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/maps/free_line.h"

namespace prospect {
namespace {

constexpr double kStartRadius = 1.0;    // [m] within which a state to start from is looked for
constexpr double kMetresARadian = 0.5;  // what a heading that is off counts there

/// Less than 90 degrees off the direction of neighbour n: 90 n degrees.
HeadingMask headings_ahead(int n) {
  HeadingMask mask = kNoHeading;
  for (int k = 1 - kHeadings / 4; k < kHeadings / 4; ++k) {
    mask |= std::rotl(HeadingMask{1}, k + n * kHeadings / 4);
  }
  return mask;
}

}  // namespace

HeadingMask turned_through(HeadingMask some, HeadingMask within) {
  if (within == kAllHeadings) return some != kNoHeading ? kAllHeadings : kNoHeading;
  HeadingMask joined = some & within;
  HeadingMask up = within, down = within;
  for (int step = 1; step < kHeadings; step *= 2) {
    const HeadingMask before = joined;
    joined |= (up & std::rotl(before, step)) | (down & std::rotr(before, step));
    up &= std::rotl(up, step);
    down &= std::rotr(down, step);
  }
  return joined;
}

std::optional<std::pair<Cell, int>> HeadingReach::find_start(
    const Grid<HeadingMask>& fits, const Eigen::Vector2d& position, double yaw,
    const std::function<bool(Cell)>& solid) {
  const GridFrame& frame = fits.frame;
  const Cell own = frame.cell(position.x(), position.y());
  const int reach = static_cast<int>(std::ceil(kStartRadius / frame.resolution));
  double least = std::numeric_limits<double>::infinity();
  std::optional<std::pair<Cell, int>> best;
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      const Cell c{own.i + di, own.j + dj};
      const HeadingMask mask = fits.get(c, kNoHeading);
      const double distance = (frame.center(c) - position).norm();
      if (mask == kNoHeading || distance > kStartRadius || distance >= least) continue;
      int heading = 0;
      double off = std::numeric_limits<double>::infinity();
      for (int k = 0; k < kHeadings; ++k) {
        if (((mask >> k) & 1U) == 0) continue;
        const double turn = std::abs(std::remainder(heading_at(k) - yaw, 2.0 * M_PI));
        if (turn >= off) continue;
        off = turn;
        heading = k;
      }
      const double cost = distance + kMetresARadian * off;
      if (cost >= least) continue;
      const bool joined = visit_line(frame, position, frame.center(c),
                                     [&](Cell on) { return on == own || !solid(on); });
      if (!joined) continue;
      least = cost;
      best = {c, heading};
    }
  }
  return best;
}

void HeadingReach::begin(int cell, bool all) {
  std::uint8_t& is_open = is_open_[static_cast<std::size_t>(cell)];
  if (is_open != 0) return;
  is_open = 1;
  (all ? open_ : waiting_).push_back(cell);
}

// Into a cell with these headings, which it has not all been entered with before.
void HeadingReach::enter(const Grid<HeadingMask>& fits, std::size_t cell, HeadingMask with,
                         Grid<HeadingMask>& reached) {
  const HeadingMask added = with & fits.data[cell] & ~reached.data[cell];
  if (added == kNoHeading) return;
  reached.data[cell] |= turned_through(added, fits.data[cell]);
  begin(static_cast<int>(cell), fits.data[cell] == kAllHeadings);
}

// From what is open, to where nothing is added any more. Where the body can turn all round headings
// make no difference: such cells, by far the most, are taken by whole runs of a row.
void HeadingReach::flood(const Grid<HeadingMask>& fits, const Steps& steps,
                         Grid<HeadingMask>& reached, const PausePoint& pause) {
  const int width = fits.frame.width, height = fits.frame.height;
  std::size_t next = 0, taken = 0;
  while (!open_.empty() || next < waiting_.size()) {
    if (++taken % 16 == 0) pause();
    // The others in order, so that most come once, with all headings that they are reached at.
    const int cell = open_.empty() ? waiting_[next++] : open_.back();
    if (!open_.empty()) open_.pop_back();
    is_open_[static_cast<std::size_t>(cell)] = 0;
    const int i = cell % width, j = cell / width;
    const HeadingMask here = reached.data[static_cast<std::size_t>(cell)];
    const HeadingMask* fits_row = fits.data.data() + static_cast<std::ptrdiff_t>(j) * width;
    HeadingMask* row = reached.data.data() + static_cast<std::ptrdiff_t>(j) * width;
    int first = i, last = i;
    if (here == kAllHeadings) {
      while (first > 0 && fits_row[first - 1] == kAllHeadings && row[first - 1] == kNoHeading) {
        row[--first] = kAllHeadings;
      }
      while (last + 1 < width && fits_row[last + 1] == kAllHeadings &&
             row[last + 1] == kNoHeading) {
        row[++last] = kAllHeadings;
      }
    }
    const auto at = [&](int to_i, int to_j) {
      return static_cast<std::size_t>(to_j * width + to_i);
    };
    if (last + 1 < width) enter(fits, at(last + 1, j), here & steps[0], reached);
    if (first > 0) enter(fits, at(first - 1, j), here & steps[2], reached);
    for (const int dj : {1, -1}) {
      if (j + dj < 0 || j + dj >= height) continue;
      const HeadingMask with = here & steps[dj > 0 ? 1 : 3];
      bool in_run = false;  // of cells that the first one of the run will take along
      for (int to_i = first; to_i <= last; ++to_i) {
        const std::size_t to = at(to_i, j + dj);
        const bool all = fits.data[to] == kAllHeadings && reached.data[to] == kNoHeading;
        if (!(all && in_run)) enter(fits, to, with, reached);
        in_run = all;
      }
    }
  }
  waiting_.clear();
}

void HeadingReach::update(const Grid<HeadingMask>& fits, const Eigen::Vector2d& position,
                          double yaw, bool free_moves, const std::function<bool(Cell)>& solid,
                          const PausePoint& pause) {
  const GridFrame& frame = fits.frame;
  const auto size = static_cast<std::size_t>(frame.size());
  reached_.frame = frame;
  assign_in_pieces(reached_.data, size, kNoHeading, pause);
  assign_in_pieces(is_open_, size, std::uint8_t{0}, pause);
  open_.clear();
  waiting_.clear();
  const auto start = find_start(fits, position, yaw, solid);
  started_ = start.has_value();
  if (!started_) return;
  const int first = frame.index(start->first);
  const HeadingMask heading = HeadingMask{1} << start->second;
  reached_.data[static_cast<std::size_t>(first)] = turned_through(heading, fits[start->first]);
  begin(first, reached_.data[static_cast<std::size_t>(first)] == kAllHeadings);
  Steps steps{kAllHeadings, kAllHeadings, kAllHeadings, kAllHeadings};
  if (!free_moves) {
    for (int n = 0; n < 4; ++n) steps[static_cast<std::size_t>(n)] = headings_ahead(n);
  }
  flood(fits, steps, reached_, pause);
  if (free_moves) return;

  // The same backwards, from where the body can turn: all those cells have been entered already.
  const Steps back{steps[2], steps[3], steps[0], steps[1]};
  turning_.frame = frame;
  assign_in_pieces(turning_.data, size, kNoHeading, pause);
  for (std::size_t c = 0; c < size; ++c) {
    if (c % 4096 == 0) pause();
    if (reached_.data[c] == kAllHeadings) turning_.data[c] = kAllHeadings;
  }
  const auto turns_at = [&](int i, int j) {
    return i >= 0 && i < frame.width && j >= 0 && j < frame.height &&
           turning_.data[static_cast<std::size_t>(j * frame.width + i)] == kAllHeadings;
  };
  for (int j = 0; j < frame.height; ++j) {
    pause();
    for (int i = 0; i < frame.width; ++i) {
      const auto c = static_cast<std::size_t>(j * frame.width + i);
      if (reached_.data[c] == kNoHeading || reached_.data[c] == kAllHeadings) continue;
      HeadingMask with = kNoHeading;
      if (turns_at(i - 1, j)) with |= back[0];
      if (turns_at(i, j - 1)) with |= back[1];
      if (turns_at(i + 1, j)) with |= back[2];
      if (turns_at(i, j + 1)) with |= back[3];
      enter(reached_, c, with, turning_);
    }
  }
  // What leads there from a state that was reached was reached, too.
  flood(reached_, back, turning_, pause);
  if ((turning_.data[static_cast<std::size_t>(first)] & heading) == kNoHeading) return;
  std::swap(reached_, turning_);
}

}  // namespace prospect
