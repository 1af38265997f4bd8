// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/step_history.h"

#include <algorithm>
#include <utility>

namespace prospect {

void StepHistory::add(std::shared_ptr<const StepRecord> step) {
  steps_.push_back(std::move(step));
  if (steps_.size() <= most_) return;
  std::vector<std::shared_ptr<const StepRecord>> kept;
  std::size_t k = 0;
  for (; k + 1 < steps_.size(); k += 2) {
    auto both = std::make_shared<StepRecord>(*steps_[k + 1]);
    const auto& before = steps_[k]->map_changes;
    both->map_changes.insert(both->map_changes.begin(), before.begin(), before.end());
    kept.push_back(std::move(both));
  }
  if (k < steps_.size()) kept.push_back(std::move(steps_[k]));
  steps_ = std::move(kept);
}

std::vector<std::shared_ptr<const StepRecord>> StepHistory::since(int after,
                                                                  std::size_t count) const {
  const auto first =
      std::upper_bound(steps_.begin(), steps_.end(), after,
                       [](int number, const auto& step) { return number < step->step; });
  const auto left = static_cast<std::size_t>(steps_.end() - first);
  return {first, first + static_cast<std::ptrdiff_t>(std::min(left, count))};
}

}  // namespace prospect
