// SPDX-License-Identifier: Apache-2.0
#include "solvers/sampling/sampling_solver.h"

#include <algorithm>
#include <cmath>

#include "solvers/evaluator.h"
#include "solvers/options.h"
#include "solvers/sampling/cross_entropy.h"
#include "solvers/sampling/path_integral.h"
#include "solvers/sampling/pattern_search.h"
#include "solvers/sampling/rate_projection.h"
#include "solvers/sampling/systematic_search.h"
#include "solvers/solver_frame.h"

namespace prospect {
namespace {

class SamplingSolver final : public SolverFrame {
 public:
  SamplingSolver(std::string name, SamplingMethod method)
      : name_(std::move(name)), method_(method) {}

  std::string name() const override { return name_; }

  std::vector<OptionInfo> options() const override {
    std::vector<OptionInfo> options = common_options();
    options.push_back(threads_option());
    options.push_back({"rate_feasible", 1,
                       "1: candidates keep the rate limits of the model, 0: constraints alone do"});
    if (searches()) {
      options.push_back({"candidates", 400, "candidates of the systematic search, 1 or more"});
    }
    if (method_ == SamplingMethod::kCrossEntropy) {
      const CrossEntropySettings fallback;
      options.push_back({"samples", fallback.samples, "candidates an iteration, 4 or more"});
      options.push_back({"sigma", fallback.sigma,
                         "standard deviation at the start, as a fraction of the range of each "
                         "variable, above 0, up to 1 [-]"});
      options.push_back(
          {"elite", fallback.elite,
           "share of the candidates that the next ones follow, above 0, up to 1 [-]"});
      options.push_back({"smoothing", fallback.smoothing,
                         "how far mean and sigma go to those of the elite, above 0, up to 1 [-]"});
      options.push_back({"correlation", fallback.correlation,
                         "of the noise between knots, for every other candidate, 0 to 1 [-]"});
    }
    if (integrates()) {
      const PathIntegralSettings fallback;
      // After a search fewer do: it stands in the right basin already.
      const int samples =
          method_ == SamplingMethod::kBoth ? fallback.samples / 2 : fallback.samples;
      options.push_back({"samples", samples, "candidates an iteration, 4 or more"});
      options.push_back({"sigma", fallback.sigma,
                         "standard deviation at the start, as a fraction of the range of each "
                         "variable, above 0, up to 1 [-]"});
      options.push_back({"temperature", fallback.temperature,
                         "of the weights, relative to the spread of the best fifth, above 0 [-]"});
      options.push_back({"adaptation", fallback.adaptation,
                         "how fast sigma follows the weighted candidates, 0 to 1 [-]"});
      options.push_back({"correlation", fallback.correlation,
                         "of the noise between knots, for every other candidate, 0 to 1 [-]"});
    }
    return options;
  }

  std::string explain_unsupported(const Problem&) const override { return {}; }

 protected:
  Evaluate start_evaluation() const override { return Evaluate::kValue; }

  void check_options(OptionSet& options) const override {
    const int rate = options.integer("rate_feasible");
    options.require_value("rate_feasible", rate == 0 || rate == 1, "0 or 1");
    if (searches()) {
      const int candidates = options.integer("candidates");
      options.require_value("candidates", candidates >= 1 && candidates <= 1000000, "1 to 1000000");
    }
    const auto unit = [&](const char* name) {
      return options.number(name) >= 0.0 && options.number(name) <= 1.0;
    };
    const auto positive_unit = [&](const char* name) {
      options.require_value(name, unit(name) && options.number(name) > 0.0,
                            "a number above 0, up to 1");
    };
    if (method_ != SamplingMethod::kSearch) {
      const int samples = options.integer("samples");
      options.require_value("samples", samples >= 4 && samples <= 100000, "4 to 100000");
      positive_unit("sigma");
      options.require_value("correlation", unit("correlation"), "0 to 1");
    }
    if (method_ == SamplingMethod::kCrossEntropy) {
      positive_unit("elite");
      positive_unit("smoothing");
    }
    if (integrates()) {
      options.require_value("temperature", options.number("temperature") > 0.0, "a number above 0");
      options.require_value("adaptation", unit("adaptation"), "0 to 1");
    }
  }

  Result run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
             const Eigen::VectorXd& start) const override {
    const RateProjection rate(evaluator.problem());
    const bool rate_feasible = options.integer("rate_feasible") == 1;
    const double precision = std::clamp(std::sqrt(evaluator.options().tolerance) * 0.1, 1e-9, 0.05);
    PathIntegralSettings settings;
    if (integrates()) {
      settings.samples = options.integer("samples");
      settings.sigma = options.number("sigma");
      settings.temperature = options.number("temperature");
      settings.adaptation = options.number("adaptation");
      settings.correlation = options.number("correlation");
    }
    settings.rate_feasible = rate_feasible;

    bool converged = false;
    if (method_ == SamplingMethod::kPathIntegral) {
      converged = path_integral(evaluator, rate, settings, precision, start);
    } else if (method_ == SamplingMethod::kCrossEntropy) {
      const CrossEntropySettings cem{.samples = options.integer("samples"),
                                     .sigma = options.number("sigma"),
                                     .elite = options.number("elite"),
                                     .smoothing = options.number("smoothing"),
                                     .correlation = options.number("correlation"),
                                     .rate_feasible = rate_feasible};
      converged = cross_entropy(evaluator, rate, cem, precision, start);
    } else {
      search(evaluator, rate, rate_feasible, options.integer("candidates"));
      if (method_ == SamplingMethod::kSearch) {
        converged = pattern_search(evaluator, rate, rate_feasible, 0.1, precision);
      } else {
        // Each has what the other lacks: the path integral moves between basins, the pattern search
        // is quick in a bowl, and only the former gets along edges of constraints.
        constexpr double kHandover = 0.02;
        converged = path_integral(evaluator, rate, settings, kHandover, evaluator.incumbent()) &&
                    pattern_search(evaluator, rate, rate_feasible, 0.05, precision);
        settings.sigma = kHandover;
        converged =
            converged && path_integral(evaluator, rate, settings, precision, evaluator.incumbent());
      }
    }
    WarmStart next;
    next.time = warm_start.time;
    return evaluator.finish(
        converged ? StopReason::kConverged : StopReason::kNumericalTrouble, false,
        converged ? "the candidates no longer differ" : "no candidate could be evaluated",
        std::move(next));
  }

 private:
  bool searches() const {
    return method_ == SamplingMethod::kSearch || method_ == SamplingMethod::kBoth;
  }
  bool integrates() const {
    return method_ == SamplingMethod::kPathIntegral || method_ == SamplingMethod::kBoth;
  }

  static void search(Evaluator& evaluator, const RateProjection& rate, bool rate_feasible,
                     int candidates) {
    // Half of the evaluations at most, so that some are left to refine what was found.
    const int most = std::min(candidates, std::max(1, evaluator.evaluations_left() / 2));
    Eigen::MatrixXd Z = systematic_candidates(evaluator.problem(), most);
    Eigen::MatrixXd X(evaluator.num_variables(), Z.cols());
    for (Eigen::Index c = 0; c < Z.cols(); ++c) {
      if (rate_feasible) rate.apply(Z.col(c));
      X.col(c) = evaluator.reduce(Z.col(c));
    }
    Eigen::ArrayXd cost, violations;
    evaluator.evaluate_batch(X, cost, violations, Evaluate::kScore);
    evaluator.count_iteration();
  }

  std::string name_;
  SamplingMethod method_;
};

}  // namespace

std::shared_ptr<const Solver> make_sampling_solver(std::string name, SamplingMethod method) {
  return std::make_shared<SamplingSolver>(std::move(name), method);
}

}  // namespace prospect
