// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

namespace prospect {

/// What sequences of scans say of a voxel, whatever was known of it before. A scan makes of the
/// log-odds l of a voxel min(max(l + d, lowest), highest), d that of a hit or a miss. So any
/// sequence of scans makes of it
///   f(l) = min(max(l + add, low), high),
/// from l = 0 where nothing was known; and a sequence f followed by g
///   add = f.add + g.add,   low = g(f.low),   high = g(f.high).
/// A scan that only grazes a voxel makes it free where nothing was known, and says nothing else.
///
/// Of such functions a map meets few thousands, so what is kept of a voxel is the number of one.
/// hit and miss are rounded to 2^-16: sums of them are exact, and so do not depend on how they are
/// grouped. Should there ever be 65535, the nearest of them stands for another one.
///
/// Thread-safety: one thread. Deterministic.
class EvidenceTable {
 public:
  using State = std::uint16_t;
  static constexpr State kNothing = 0;

  /// Log-odds of a hit (> 0) and a miss (< 0), and the bounds of a voxel's.
  struct Model {
    float hit = 0.85F, miss = -0.41F, lowest = -2.0F, highest = 2.2F;
  };
  explicit EvidenceTable(const Model& model);

  State after_hit(State s) { return next(s, kHit); }
  State after_miss(State s) { return next(s, kMiss); }
  State after_graze(State s) { return s == kNothing ? graze_ : s; }
  /// Of a voxel that is told to have the log-odds l, whatever it had.
  State told(float l) { return number({0.0F, l, l, l}); }
  /// First one, then the other.
  State sequence(State first, State then);

  /// The log-odds after it of a voxel that had l.
  float of_known(State s, float l) const {
    const Function& f = functions_[s];
    return std::min(std::max(l + f.add, f.low), f.high);
  }
  /// Of one of which nothing was known; not of kNothing.
  float of_unknown(State s) const { return functions_[s].of_unknown; }
  bool is_surface(State s) const { return s != kNothing && of_unknown(s) >= 0.0F; }
  /// How many there are.
  std::size_t size() const { return functions_.size(); }

 private:
  struct Function {
    float add = 0.0F, low = 0.0F, high = 0.0F;
    float of_unknown = 0.0F;  // f(0), or f(miss) after a graze
    // NOLINTNEXTLINE(modernize-use-nullptr): there is none
    friend auto operator<=>(const Function&, const Function&) = default;
  };
  enum Event { kHit, kMiss };
  static constexpr std::size_t kMost = std::numeric_limits<State>::max();

  State next(State s, Event event);
  static Function joined(const Function& first, const Function& then);
  State number(Function f);

  Model model_;
  Function event_[2];
  std::vector<Function> functions_;         // the first is that of kNothing
  std::vector<std::array<State, 2>> next_;  // after an event; kNothing: not asked yet
  std::map<Function, State> number_;
  State graze_ = kNothing;
};

}  // namespace prospect
