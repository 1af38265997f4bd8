// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "engine/problem/term.h"
#include "engine/problem/trajectory.h"

namespace prospect {

/// What the terms of one problem compute once per evaluation and use several times, e.g. the looks
/// that ExplorationGain needs as a cost and as a prior. Owned by a Workspace, so that terms stay
/// const and two workspaces know nothing of each other; reached through the batch of trajectories
/// that a term is given. A term that shares nothing need not know of it. Outside of a Problem, and
/// for a copy of the batch, there is none.
///
///   if (SharedResults* shared = trajectories.shared.get()) {
///     auto& mine = shared->get<Mine>(this, [&] { return std::make_unique<Mine>(...); });
///     if (mine.stamp != shared->stamp()) { ...compute...; mine.stamp = shared->stamp(); }
///   }
///
/// Thread-safety: none; one thread a workspace.
class SharedResults {
 public:
  SharedResults() = default;
  SharedResults(const SharedResults&) = delete;
  SharedResults& operator=(const SharedResults&) = delete;

  /// Begins an evaluation of `trajectories`: what was computed before does not hold any more.
  void begin(TrajectoryBatch& trajectories, const TermRequest& request) {
    ++stamp_;
    request_ = request;
    trajectories.shared.results_ = this;
  }

  /// Differs from evaluation to evaluation; never 0.
  std::uint64_t stamp() const { return stamp_; }
  /// What this evaluation asks of its costs: gradients (or residuals), or scores.
  const TermRequest& request() const { return request_; }

  /// The results of `owner` (an address that outlives the workspace, such as the term's), made by
  /// `make` at the first call. One owner has one type of results.
  template <class Results, class Make>
  Results& get(const void* owner, Make&& make) {
    for (const auto& [key, results] : results_) {
      if (key == owner) return static_cast<Results&>(*results);
    }
    results_.emplace_back(owner, std::forward<Make>(make)());
    return static_cast<Results&>(*results_.back().second);
  }

 private:
  std::vector<std::pair<const void*, std::unique_ptr<TermScratch>>> results_;
  std::uint64_t stamp_ = 0;
  TermRequest request_;
};

}  // namespace prospect
