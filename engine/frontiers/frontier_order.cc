// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/frontier_order.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "models/knobs.h"

namespace prospect {
namespace {

/// Depth first over all sequences.
class Search {
 public:
  Search(const std::vector<FrontierCandidate>& candidates, const Eigen::MatrixXd& between,
         const FrontierOrderOptions& options)
      : candidates_(candidates),
        between_(between),
        options_(options),
        used_(candidates.size(), false) {}

  FrontierSequence run(int first) {
    for (int k = 0; k < static_cast<int>(candidates_.size()); ++k) {
      if (first < 0 || k == first) extend(k, candidates_[static_cast<std::size_t>(k)].cost, 0.0);
    }
    return best_;
  }

 private:
  void extend(int next, double time, double value) {
    if (!std::isfinite(time)) return;
    const auto at = static_cast<std::size_t>(next);
    value += candidates_[at].area * std::exp(-time / options_.patience);
    order_.push_back(next);
    used_[at] = true;
    if (value > best_.value) best_ = {order_, value};
    if (static_cast<int>(order_.size()) < options_.sequence_length) {
      for (std::size_t k = 0; k < candidates_.size(); ++k) {
        if (used_[k]) continue;
        extend(static_cast<int>(k), time + between_(next, static_cast<Eigen::Index>(k)), value);
      }
    }
    used_[at] = false;
    order_.pop_back();
  }

  const std::vector<FrontierCandidate>& candidates_;
  const Eigen::MatrixXd& between_;
  const FrontierOrderOptions& options_;
  std::vector<bool> used_;
  std::vector<int> order_;
  FrontierSequence best_;
};

}  // namespace

std::vector<FrontierCandidate> leading_candidates(std::vector<FrontierCandidate> candidates,
                                                  const FrontierOrderOptions& options,
                                                  const PausePoint& pause) {
  std::vector<std::pair<double, std::size_t>> by_value;  // less than 0: the greatest come first
  for (const FrontierCandidate& c : candidates) {
    if (by_value.size() % 64 == 0) pause();
    by_value.emplace_back(-c.area * std::exp(-c.cost / options.patience), by_value.size());
  }
  const std::size_t most =
      std::min(candidates.size(), static_cast<std::size_t>(options.candidates));
  std::partial_sort(by_value.begin(), by_value.begin() + static_cast<std::ptrdiff_t>(most),
                    by_value.end());
  std::vector<FrontierCandidate> leading;
  for (std::size_t n = 0; n < most; ++n) leading.push_back(candidates[by_value[n].second]);
  return leading;
}

double rate(const FrontierSequence& sequence, const std::vector<FrontierCandidate>& candidates,
            const Eigen::MatrixXd& between) {
  double best = 0.0, area = 0.0, time = 0.0;
  for (std::size_t n = 0; n < sequence.order.size(); ++n) {
    const int k = sequence.order[n];
    const FrontierCandidate& c = candidates[static_cast<std::size_t>(k)];
    area += c.area;
    time += n == 0 ? c.time : between(sequence.order[n - 1], k);
    best = std::max(best, area / time);
  }
  return best;
}

FrontierSequence best_sequence(const std::vector<FrontierCandidate>& candidates,
                               const Eigen::MatrixXd& between, const FrontierOrderOptions& options,
                               int first) {
  return Search(candidates, between, options).run(first);
}

void describe(Knobs& knobs, FrontierOrderOptions& o) {
  knobs.number("patience", o.patience, {0.1, 1e4}, "s",
               "in which what is still to be seen loses a factor of e in utility");
  knobs.integer("candidates", o.candidates, {1, 10}, "1", "frontiers that are put in order");
  knobs.integer("sequence_length", o.sequence_length, {1, 6}, "1",
                "of them that a sequence holds at most");
}

}  // namespace prospect
