// SPDX-License-Identifier: Apache-2.0
#include "solvers/hybrid/hybrid_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "solvers/evaluator.h"
#include "solvers/hybrid/neighbour.h"
#include "solvers/hybrid/spread_candidates.h"
#include "solvers/options.h"
#include "solvers/sampling/rate_projection.h"
#include "solvers/solver_frame.h"

namespace prospect {
namespace {

// Starts that are polished from one incumbent: as many threads have work.
constexpr int kStartsPerTurn = 2;

// With fewer evaluations a start comes to nothing.
constexpr int kLeastPolish = 10;

// Under a deadline this many seeds are scored at a time, a register of floats, until this share of
// the time is over: those given come best first.
constexpr int kScoredAtATime = 8;
constexpr double kScoringShare = 0.0625;

// Seeds where the warm start gives none, itself included.
constexpr int kOwnSeeds = 60;

/// A point that may be polished.
struct Seed {
  Eigen::VectorXd x;  ///< free variables
  double cost = 0.0, violation = 0.0;
};

class HybridSolver final : public SolverFrame {
 public:
  HybridSolver(std::string name, FindSolver find)
      : name_(std::move(name)), find_(std::move(find)) {}

  std::string name() const override { return name_; }

  std::vector<OptionInfo> options() const override {
    std::vector<OptionInfo> options = common_options();
    options.push_back(threads_option());
    options.push_back({"polish", std::string("sqp"), "back end with derivatives that polishes"});
    options.push_back({"candidates", 0,
                       "seeds that are scored, the given ones included; 0: those that are given, "
                       "or " +
                           std::to_string(kOwnSeeds) + " where none are"});
    options.push_back(
        {"segments", 5, "stretches of constant input in the seeds of its own, 1 or more"});
    options.push_back({"basins", 10, "seeds that are polished at most, 1 or more"});
    options.push_back(
        {"separation", 0.3, "distance below which two seeds share a basin, 0 or more [-]"});
    options.push_back(
        {"polish_evaluations", 30, "evaluations of each start but the first, 2 or more"});
    options.push_back(
        {"patience", 2, "turns without gain after which no further start is polished, 0 or more"});
    options.push_back(
        {"polish_tolerance", 1e-3, "relative change of cost at which a basin is left, 0 to 1 [-]"});
    return options;
  }

  std::string explain_unsupported(const Problem& problem) const override {
    return explain_no_gradient(problem);
  }

  bool compares_starts() const override { return true; }

 protected:
  Evaluate start_evaluation() const override { return Evaluate::kValue; }

  void check_options(OptionSet& options) const override {
    const auto whole = [&](const char* name, int least, const char* expected) {
      const int value = options.integer(name);
      options.require_value(name, value >= least && value <= 1000000, expected);
    };
    whole("candidates", 0, "0 to 1000000");
    whole("segments", 1, "1 to 1000000");
    whole("basins", 1, "1 to 1000000");
    whole("polish_evaluations", 2, "2 to 1000000");
    whole("patience", 0, "0 to 1000000");
    options.require_value("separation", options.number("separation") >= 0.0, "0 or more");
    const double tolerance = options.number("polish_tolerance");
    options.require_value("polish_tolerance", tolerance >= 0.0 && tolerance <= 1.0, "0 to 1");
    try {
      const auto polish = find_(options.text("polish"));
      options.require_value(
          "polish",
          dynamic_cast<const SolverFrame*>(polish.get()) != nullptr && polish->name() != name_,
          "a back end that is built in, other than this one");
    } catch (const std::invalid_argument& e) {
      options.require(false, std::string("option 'polish': ") + e.what());
    }
  }

  Result run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
             const Eigen::VectorXd& start) const override {
    const auto found = find_(options.text("polish"));
    const auto& polish = dynamic_cast<const SolverFrame&>(*found);
    const std::string unsupported = polish.explain_unsupported(evaluator.problem());
    if (!unsupported.empty()) throw std::invalid_argument(polish.name() + ": " + unsupported);

    std::vector<Seed> seeds = score(evaluator, options, warm_start, start);
    keep_apart(evaluator, start, options.number("separation"), options.integer("basins"), seeds);

    Options coarse = {
        {"tolerance", std::max(options.number("polish_tolerance"), evaluator.options().tolerance)},
        {"feasibility_tolerance", evaluator.options().feasibility_tolerance},
        {"seed", static_cast<int>(evaluator.options().seed)},
        {"max_evaluations", std::max(1, evaluator.evaluations_left() / 2)}};
    const RateProjection rate(evaluator.problem());
    Eigen::MatrixXd stage_hessians = warm_start.stage_hessians;
    std::size_t opened = 1;
    int neighbours = 0, begun = 0, turns_without_gain = 0;
    std::vector<WarmStart> starts(1);
    starts.front().x = evaluator.expand(seeds.front().x);
    starts.front().stage_hessians = stage_hessians;
    while (!evaluator.should_stop()) {
      const double cost = evaluator.incumbent_cost(), violation = evaluator.incumbent_violation();
      for (const auto& r : polish.solve_within(evaluator, starts, coarse)) {
        if (!r) continue;
        ++begun;
        if (r->cost == evaluator.incumbent_cost()) stage_hessians = r->next.stage_hessians;
      }
      evaluator.count_iteration();
      const bool gained = gains(evaluator, cost, violation, options.number("polish_tolerance"));
      turns_without_gain = gained ? 0 : turns_without_gain + 1;
      // One share is for the end of the best.
      const int share = evaluator.evaluations_left() / (kStartsPerTurn + 1);
      if (turns_without_gain > options.integer("patience") || share < kLeastPolish) break;
      coarse["max_evaluations"] = std::min(options.integer("polish_evaluations"), share);
      const Eigen::VectorXd best = evaluator.expand(evaluator.incumbent());
      starts.clear();
      if (opened < seeds.size()) starts.emplace_back().x = evaluator.expand(seeds[opened++].x);
      while (static_cast<int>(starts.size()) < kStartsPerTurn) {
        Eigen::VectorXd& z = starts.emplace_back().x;
        z = neighbour(evaluator.problem(), best, ++neighbours);
        rate.apply(z);
      }
      for (WarmStart& s : starts) s.stage_hessians = stage_hessians;
    }
    WarmStart next = warm_start;
    next.x = evaluator.expand(evaluator.incumbent());
    next.stage_hessians.resize(0, 0);
    Options fine = coarse;
    fine["tolerance"] = evaluator.options().tolerance;
    fine["max_evaluations"] = std::max(1, evaluator.evaluations_left());
    const Result end = polish.solve_within(evaluator, next, fine);
    return evaluator.finish(end.stop, end.quality == Quality::kFeasibleOptimum,
                            "best of " + std::to_string(begun) + " starts, " + end.detail,
                            end.next);
  }

 private:
  /// Whether the incumbent is better than one before by more than a relative `tolerance`.
  static bool gains(const Evaluator& evaluator, double cost, double violation, double tolerance) {
    if (violation > evaluator.options().feasibility_tolerance) {
      return evaluator.incumbent_violation() < (1.0 - tolerance) * violation;
    }
    return evaluator.incumbent_cost() < cost - tolerance * std::max(1.0, std::abs(cost));
  }

  /// The seeds that can be evaluated, best first.
  static std::vector<Seed> score(Evaluator& evaluator, const OptionSet& options,
                                 const WarmStart& warm_start, const Eigen::VectorXd& start) {
    const Problem& problem = evaluator.problem();
    const Eigen::MatrixXd& given = warm_start.seeds;
    if (given.cols() > 0 && (given.rows() != problem.num_variables() || !given.allFinite())) {
      throw std::invalid_argument("warm_start.seeds is " + std::to_string(given.rows()) + " x " +
                                  std::to_string(given.cols()) + "; expected " +
                                  std::to_string(problem.num_variables()) + " finite rows");
    }
    const int most = std::max(1, evaluator.evaluations_left() / 2);
    const int taken = std::min(static_cast<int>(given.cols()), most);
    const int asked = options.integer("candidates");
    const int wanted = asked > 0 ? asked : (taken > 0 ? taken + 1 : kOwnSeeds);
    const int own = std::clamp(wanted - 1 - taken, 0, most - taken);
    const Eigen::MatrixXd spread = spread_candidates(problem, own, options.integer("segments"));
    const RateProjection rate(problem);
    Eigen::MatrixXd X(evaluator.num_variables(), taken + own);
    Eigen::VectorXd z;
    for (int s = 0; s < taken + own; ++s) {
      z = s < taken ? given.col(s) : spread.col(s - taken);
      z = z.cwiseMax(problem.lower()).cwiseMin(problem.upper());
      rate.apply(z);
      X.col(s) = evaluator.reduce(z);
    }
    // The start is evaluated already, and the incumbent until the batch is.
    std::vector<Seed> seeds = {
        {start, evaluator.incumbent_cost(), evaluator.incumbent_violation()}};
    const auto total = static_cast<int>(X.cols());
    const double time = evaluator.seconds_left();
    const bool hurried = own == 0 && std::isfinite(time);
    const int portion = hurried ? kScoredAtATime : total;
    for (int from = 0; from < total && !evaluator.stopped(); from += portion) {
      if (from > 0 && evaluator.seconds_left() <= (1.0 - kScoringShare) * time) break;
      Eigen::ArrayXd cost, violation;
      const auto batch = X.middleCols(from, std::min(portion, total - from));
      const int done = evaluator.evaluate_batch(batch, cost, violation, Evaluate::kScore);
      for (int s = 0; s < done; ++s) {
        if (std::isfinite(violation[s])) {
          seeds.push_back({batch.col(s), cost[s], violation[s]});
        }
      }
    }
    evaluator.count_iteration();
    rank(evaluator, seeds);
    // The start is what the caller knows: it comes second at the latest.
    const auto given_start =
        std::find_if(seeds.begin(), seeds.end(), [&](const Seed& s) { return s.x == start; });
    if (given_start != seeds.begin()) std::rotate(seeds.begin() + 1, given_start, given_start + 1);
    return seeds;
  }

  /// Feasible before infeasible, then by cost; infeasible ones by violation.
  static void rank(const Evaluator& evaluator, std::vector<Seed>& seeds) {
    const double tolerance = evaluator.options().feasibility_tolerance;
    const auto key = [&](const Seed& s) {
      return std::pair(s.violation <= tolerance ? 0.0 : s.violation, s.cost);
    };
    std::stable_sort(seeds.begin(), seeds.end(),
                     [&](const Seed& a, const Seed& b) { return key(a) < key(b); });
  }

  /// Keeps the best of ranked seeds that are at least `separation` from every better one kept,
  /// and the start.
  static void keep_apart(const Evaluator& evaluator, const Eigen::VectorXd& start,
                         double separation, int most, std::vector<Seed>& seeds) {
    const Eigen::ArrayXd range = evaluator.upper() - evaluator.lower();
    const auto n = static_cast<double>(range.size());
    const double best = seeds.front().cost;
    const double spread = std::max(std::abs(seeds[seeds.size() / 2].cost - best),
                                   1e-9 * std::max(1.0, std::abs(best)));
    std::vector<Seed> kept;
    for (Seed& seed : seeds) {
      if (static_cast<int>(kept.size()) == most) break;
      const bool apart = std::all_of(kept.begin(), kept.end(), [&](const Seed& other) {
        const double along_z = ((seed.x - other.x).array() / range).square().sum() / n;
        const double along_cost = (seed.cost - other.cost) / spread;
        return along_z + along_cost * along_cost >= separation * separation;
      });
      if (apart || seed.x == start) kept.push_back(std::move(seed));
    }
    seeds = std::move(kept);
  }

  std::string name_;
  FindSolver find_;
};

}  // namespace

std::shared_ptr<const Solver> make_hybrid_solver(std::string name, FindSolver find) {
  return std::make_shared<HybridSolver>(std::move(name), std::move(find));
}

}  // namespace prospect
