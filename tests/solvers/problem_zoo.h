// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "problems/path_problem.h"
#include "problems/zoo.h"

namespace prospect::zoo {

using Case = FunctionProblem;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// What is watched, and what goes wrong, while a problem is evaluated. Counts columns, from 1.
struct Watch {
  /// Called at the start of every call of the cost term, before anything else.
  std::function<void()> on_call = {};
  bool record = false;
  int nan_at = 0;             ///< the evaluation that gives NaN, 0: none
  int throw_at = 0;           ///< the evaluation that throws, 0: none
  double seconds_a_call = 0;  ///< how long one call of the term takes, whatever its batch

  std::atomic<int> calls{0};
  std::atomic<int> evaluations{0};
  std::mutex mutex;
  std::vector<Vector> points;  ///< knot inputs as evaluated

  /// Called by the cost term for each candidate; returns whether the value is to be NaN.
  bool evaluated(const TrajectoryBatch& t, int b) {
    const int count = ++evaluations;
    if (record) {
      const std::lock_guard lock(mutex);
      points.push_back(t.inputs.col(b).matrix());
    }
    if (count == throw_at) throw std::runtime_error("injected fault");
    return count == nan_at;
  }
};

/// A cost term that is watched.
class WatchedCost final : public Term {
 public:
  WatchedCost(std::shared_ptr<const Term> cost, std::shared_ptr<Watch> watch)
      : cost_(std::move(cost)), watch_(std::move(watch)) {}
  std::string_view name() const override { return cost_->name(); }
  TermTraits traits() const override { return cost_->traits(); }
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override {
    return cost_->residual_form(horizon, sign);
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch* scratch,
                TermOutput& out) const override {
    ++watch_->calls;
    if (watch_->on_call) watch_->on_call();
    if (watch_->seconds_a_call > 0.0) {
      std::this_thread::sleep_for(std::chrono::duration<double>(watch_->seconds_a_call));
    }
    cost_->evaluate(t, request, scratch, out);
    for (int b = 0; b < t.batch(); ++b) {
      if (watch_->evaluated(t, b)) out.value(0, b) = std::numeric_limits<double>::quiet_NaN();
    }
  }

 private:
  std::shared_ptr<const Term> cost_;
  std::shared_ptr<Watch> watch_;
};

/// The same problem with its first term, a cost, watched.
inline Problem watched(const Problem& problem, const std::shared_ptr<Watch>& watch) {
  ProblemDefinition d = problem.definition();
  d.terms.front().term = std::make_shared<WatchedCost>(d.terms.front().term, watch);
  return Problem(d);
}

}  // namespace prospect::zoo
