// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/evidence_table.h"

#include <cmath>

namespace prospect {
namespace {

constexpr float kUnit = 1.0F / 65536.0F;

float rounded(float l) { return std::round(l / kUnit) * kUnit; }

}  // namespace

EvidenceTable::EvidenceTable(const Model& model)
    : model_{rounded(model.hit), rounded(model.miss), rounded(model.lowest),
             rounded(model.highest)} {
  const auto bounded = [&](float l) {
    return std::min(std::max(l, model_.lowest), model_.highest);
  };
  for (const Event event : {kHit, kMiss}) {
    const float d = event == kHit ? model_.hit : model_.miss;
    event_[event] = {d, model_.lowest, model_.highest, bounded(d)};
  }
  functions_.push_back({0.0F, model_.lowest, model_.highest, 0.0F});
  next_.push_back({kNothing, kNothing});
  graze_ = number({0.0F, model_.lowest, model_.highest, bounded(model_.miss)});
}

EvidenceTable::Function EvidenceTable::joined(const Function& first, const Function& then) {
  const auto after = [&](float l) { return std::min(std::max(l + then.add, then.low), then.high); };
  return {first.add + then.add, after(first.low), after(first.high), after(first.of_unknown)};
}

EvidenceTable::State EvidenceTable::number(Function f) {
  // What all log-odds within the bounds come to does not depend on `add`.
  if (model_.highest + f.add <= f.low) f.high = f.low;
  if (model_.lowest + f.add >= f.high) f.low = f.high;
  if (f.low == f.high) f.add = 0.0F;
  const auto found = number_.find(f);
  if (found != number_.end()) return found->second;
  if (functions_.size() < kMost) {
    const State s = static_cast<State>(functions_.size());
    functions_.push_back(f);
    next_.push_back({kNothing, kNothing});
    return number_[f] = s;
  }
  State nearest = 1;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t s = 1; s < functions_.size(); ++s) {
    const Function& g = functions_[s];
    const float off = std::abs(g.add - f.add) + std::abs(g.low - f.low) +
                      std::abs(g.high - f.high) + std::abs(g.of_unknown - f.of_unknown);
    if (off >= least) continue;
    least = off;
    nearest = static_cast<State>(s);
  }
  return nearest;
}

EvidenceTable::State EvidenceTable::next(State s, Event event) {
  if (next_[s][event] != kNothing) return next_[s][event];
  const State after = number(joined(functions_[s], event_[event]));
  next_[s][event] = after;
  return after;
}

EvidenceTable::State EvidenceTable::sequence(State first, State then) {
  if (first == kNothing) return then;
  if (then == kNothing) return first;
  Function f = joined(functions_[first], functions_[then]);
  return number(f);
}

}  // namespace prospect
