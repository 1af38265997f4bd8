#include "solvers/hybrid/hybrid_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "solvers/evaluator.h"
#include "solvers/hybrid/spread_candidates.h"
#include "solvers/options.h"
#include "solvers/sampling/rate_projection.h"
#include "solvers/solver_frame.h"

namespace prospect {
namespace {

// Two polished points nearer than this are on their way to one minimum [-].
constexpr double kMerged = 0.02;

// What an evaluation with its gradient takes, in scores (docs/results/performance.md).
constexpr double kGradientPerScore = 3.0;

// Under a deadline this many seeds are scored at a time, a register of floats, until this share of
// the time is over: those given come best first.
constexpr int kScoredAtATime = 8;
constexpr double kScoringShare = 0.0625;

// Seeds where the warm start gives none, itself included.
constexpr int kOwnSeeds = 60;

/// When `share` of the time from now to `latest` is over; never if that is never.
StopCondition::Clock::time_point part_way(StopCondition::Clock::time_point latest, double share) {
  if (latest == StopCondition::Clock::time_point::max()) return latest;
  const auto now = StopCondition::Clock::now();
  return now + std::chrono::duration_cast<StopCondition::Clock::duration>(share * (latest - now));
}

/// A point that stands for a basin: a seed at first, then what its polish has come to.
struct Basin {
  Eigen::VectorXd x;  ///< free variables
  double cost = 0.0, violation = 0.0;
  Eigen::MatrixXd stage_hessians;  ///< WarmStart::stage_hessians, of the polish
  bool settled = false;            ///< its polish found nothing more to gain at the loose tolerance
};

class HybridSolver final : public SolverFrame {
 public:
  HybridSolver(std::string name, HybridPolish polish)
      : name_(std::move(name)), polish_(std::move(polish)) {}

  std::string name() const override { return name_; }

  std::vector<OptionInfo> options() const override {
    std::vector<OptionInfo> options = common_options();
    options.push_back(threads_option());
    options.push_back({"polish", std::string("auto"),
                       "back end with derivatives that polishes; auto: " + polish_.unconstrained +
                           " without constraints, " + polish_.constrained + " with"});
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
        {"polish_evaluations", 10, "evaluations a basin gets in the first round, 2 or more"});
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
    options.require_value("separation", options.number("separation") >= 0.0, "0 or more");
    const double tolerance = options.number("polish_tolerance");
    options.require_value("polish_tolerance", tolerance >= 0.0 && tolerance <= 1.0, "0 to 1");
    if (options.text("polish") == "auto") return;
    try {
      const auto polish = polish_.find(options.text("polish"));
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
    const std::string& asked = options.text("polish");
    const auto found = polish_.find(asked != "auto"                   ? asked
                                    : evaluator.num_constraints() > 0 ? polish_.constrained
                                                                      : polish_.unconstrained);
    const auto& polish = dynamic_cast<const SolverFrame&>(*found);
    const std::string unsupported = polish.explain_unsupported(evaluator.problem());
    if (!unsupported.empty()) throw std::invalid_argument(polish.name() + ": " + unsupported);

    const StopCondition::Clock::time_point began = StopCondition::Clock::now();
    std::vector<Basin> basins = score(evaluator, options, warm_start, start);
    // Each gets its first round within half of what is left.
    int evaluations = options.integer("polish_evaluations");
    int affordable = evaluator.evaluations_left() / (2 * evaluations);
    if (evaluator.latest() != StopCondition::Clock::time_point::max() && basins.size() > 1) {
      const StopCondition::Clock::time_point now = StopCondition::Clock::now();
      const double polish = kGradientPerScore / static_cast<double>(basins.size()) *
                            std::chrono::duration<double>(now - began).count();  // [s]
      const double left = std::chrono::duration<double>(evaluator.latest() - now).count();
      double in_time = left / (2.0 * evaluations * polish);
      // Scores were taken on one thread, basins are polished on several. Where there is time for
      // one only, a polish that begins anew after a round costs more than a second basin brings.
      if (in_time >= 2.0) in_time *= options.integer("threads");
      affordable = static_cast<int>(std::clamp(in_time, 0.0, static_cast<double>(affordable)));
    }
    keep_apart(evaluator, options.number("separation"),
               std::min(options.integer("basins"), std::max(1, affordable)), basins);
    const std::size_t opened = basins.size();
    Options coarse = {
        {"tolerance", std::max(options.number("polish_tolerance"), evaluator.options().tolerance)},
        {"feasibility_tolerance", evaluator.options().feasibility_tolerance},
        {"seed", static_cast<int>(evaluator.options().seed)}};
    while (basins.size() > 1 && !evaluator.should_stop()) {
      // Half of what is left goes to the rounds to come and to the end of the best.
      const int share = evaluator.evaluations_left() / (2 * static_cast<int>(basins.size()));
      if (share < 2) break;
      coarse["max_evaluations"] = std::min(evaluations, share);
      // Half of the time, likewise; the best goes first.
      const StopCondition::Clock::time_point end = part_way(evaluator.latest(), 0.5);
      std::vector<Basin*> open;
      std::vector<WarmStart> starts;
      for (Basin& basin : basins) {
        if (basin.settled) continue;
        open.push_back(&basin);
        starts.emplace_back().x = evaluator.expand(basin.x);
        starts.back().stage_hessians = basin.stage_hessians;
      }
      const auto results = polish.solve_within(evaluator, starts, coarse, end);
      for (std::size_t b = 0; b < open.size(); ++b) {
        const std::optional<Result>& r = results[b];
        if (!r || r->quality == Quality::kNone) continue;
        Basin& basin = *open[b];
        basin.x = evaluator.reduce(r->x);
        basin.cost = r->cost;
        basin.violation = r->violation;
        basin.stage_hessians = r->next.stage_hessians;
        basin.settled = r->stop == StopReason::kConverged;
      }
      rank(evaluator, basins);
      keep_apart(evaluator, kMerged, static_cast<int>(basins.size() + 1) / 2, basins);
      evaluations *= 2;
    }
    WarmStart next = warm_start;
    next.x = evaluator.expand(evaluator.incumbent());
    next.stage_hessians = basins.front().stage_hessians;
    Options fine = coarse;
    fine["tolerance"] = evaluator.options().tolerance;
    fine["max_evaluations"] = std::max(1, evaluator.evaluations_left());
    const Result end = polish.solve_within(evaluator, next, fine);
    return evaluator.finish(end.stop, end.quality == Quality::kFeasibleOptimum,
                            "best of " + std::to_string(opened) + " basins, " + end.detail,
                            end.next);
  }

 private:
  /// The seeds that can be evaluated, best first.
  static std::vector<Basin> score(Evaluator& evaluator, const OptionSet& options,
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
    std::vector<Basin> seeds = {
        {start, evaluator.incumbent_cost(), evaluator.incumbent_violation(), {}, false}};
    const auto total = static_cast<int>(X.cols());
    const bool hurried = own == 0 && evaluator.latest() != StopCondition::Clock::time_point::max();
    const StopCondition::Clock::time_point end = part_way(evaluator.latest(), kScoringShare);
    const int portion = hurried ? kScoredAtATime : total;
    for (int from = 0; from < total && !evaluator.stopped(); from += portion) {
      if (from > 0 && StopCondition::Clock::now() >= end) break;
      Eigen::ArrayXd cost, violation;
      const auto batch = X.middleCols(from, std::min(portion, total - from));
      const int done = evaluator.evaluate_batch(batch, cost, violation, Evaluate::kScore);
      for (int s = 0; s < done; ++s) {
        if (std::isfinite(violation[s])) {
          seeds.push_back({batch.col(s), cost[s], violation[s], {}, false});
        }
      }
    }
    evaluator.count_iteration();
    rank(evaluator, seeds);
    return seeds;
  }

  /// Feasible before infeasible, then by cost; infeasible ones by violation.
  static void rank(const Evaluator& evaluator, std::vector<Basin>& basins) {
    const double tolerance = evaluator.options().feasibility_tolerance;
    const auto key = [&](const Basin& b) {
      return std::pair(b.violation <= tolerance ? 0.0 : b.violation, b.cost);
    };
    std::stable_sort(basins.begin(), basins.end(),
                     [&](const Basin& a, const Basin& b) { return key(a) < key(b); });
  }

  /// Keeps the best of ranked basins that are at least `separation` from every better one kept.
  static void keep_apart(const Evaluator& evaluator, double separation, int most,
                         std::vector<Basin>& basins) {
    const Eigen::ArrayXd range = evaluator.upper() - evaluator.lower();
    const auto n = static_cast<double>(range.size());
    const double best = basins.front().cost;
    const double spread = std::max(std::abs(basins[basins.size() / 2].cost - best),
                                   1e-9 * std::max(1.0, std::abs(best)));
    std::vector<Basin> kept;
    for (Basin& basin : basins) {
      if (static_cast<int>(kept.size()) == most) break;
      const bool apart = std::all_of(kept.begin(), kept.end(), [&](const Basin& other) {
        const double along_z = ((basin.x - other.x).array() / range).square().sum() / n;
        const double along_cost = (basin.cost - other.cost) / spread;
        return along_z + along_cost * along_cost >= separation * separation;
      });
      if (apart) kept.push_back(std::move(basin));
    }
    basins = std::move(kept);
  }

  std::string name_;
  HybridPolish polish_;
};

}  // namespace

std::shared_ptr<const Solver> make_hybrid_solver(std::string name, HybridPolish polish) {
  return std::make_shared<HybridSolver>(std::move(name), std::move(polish));
}

}  // namespace prospect
