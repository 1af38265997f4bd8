// SPDX-License-Identifier: Apache-2.0
#include "solvers/registry.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "models/nearest_name.h"
#include "solvers/evaluator.h"
#include "solvers/hybrid/hybrid_solver.h"
#include "solvers/nlopt_algorithms.h"
#include "solvers/options.h"
#include "solvers/sampling/sampling_solver.h"
#include "solvers/sqp/sqp_solver.h"
#ifdef PROSPECT_WITH_CERES
#include "solvers/ceres/ceres_solver.h"
#endif
#ifdef PROSPECT_WITH_IPOPT
#include "solvers/ipopt/ipopt_solver.h"
#endif
#ifdef PROSPECT_WITH_NLOPT
#include "solvers/nlopt/nlopt_solver.h"
#endif

namespace prospect {
namespace {

/// Stands for a back end whose library was absent when this program was built.
class AbsentSolver final : public Solver {
 public:
  AbsentSolver(std::string name, std::string needs)
      : name_(std::move(name)), message_("not built in: it needs " + std::move(needs)) {}
  std::string name() const override { return name_; }
  std::vector<OptionInfo> options() const override { return common_options(); }
  std::string explain_unsupported(const Problem&) const override { return message_; }
  Result solve(const Problem& problem, const WarmStart&, const Options&,
               const StopCondition&) const override {
    return failed_result(problem, name_ + ": " + message_);
  }

 private:
  std::string name_, message_;
};

struct Entry {
  std::string name;
  std::string description;
  std::string needs;
  std::function<std::shared_ptr<const Solver>()> make;  ///< empty: the library is absent
};

Entry nlopt_entry(std::string name, const NloptAlgorithm& algorithm) {
  Entry entry{name,
              "NLopt " + std::string(algorithm.name) + ": " + std::string(algorithm.description),
              "NLopt (libnlopt-dev)",
              {}};
#ifdef PROSPECT_WITH_NLOPT
  entry.make = [name = std::move(name), algorithm] { return make_nlopt_solver(name, algorithm); };
#endif
  return entry;
}

std::vector<Entry> entries() {
  std::vector<Entry> all;
  all.push_back({"ceres",
                 "Ceres: Levenberg-Marquardt on costs that are sums of squares",
                 "Ceres (libceres-dev)",
                 {}});
#ifdef PROSPECT_WITH_CERES
  all.back().make = &make_ceres_solver;
#endif
  all.push_back({"ipopt",
                 "Ipopt: interior point with limited-memory BFGS, warm starts with duals",
                 "Ipopt (coinor-libipopt-dev)",
                 {}});
#ifdef PROSPECT_WITH_IPOPT
  all.back().make = &make_ipopt_solver;
#endif
  for (const NloptAlgorithm& algorithm : nlopt_algorithms()) {
    if (algorithm.name == kDefaultNloptAlgorithm) all.push_back(nlopt_entry("nlopt", algorithm));
    all.push_back(nlopt_entry("nlopt:" + std::string(algorithm.name), algorithm));
  }
  const auto sampling = [&](const std::string& name, SamplingMethod method,
                            const std::string& description) {
    all.push_back(
        {name, description, "", [name, method] { return make_sampling_solver(name, method); }});
  };
  sampling("sampling", SamplingMethod::kBoth,
           "systematic search, path integral from its best, pattern search");
  sampling("sampling:cem", SamplingMethod::kCrossEntropy,
           "cross-entropy method on the knots, diagonal covariance");
  sampling("sampling:mppi", SamplingMethod::kPathIntegral,
           "model predictive path integral control on the knots");
  sampling("sampling:search", SamplingMethod::kSearch,
           "systematic search over constant and two-segment inputs, then pattern search");
  all.push_back(
      {"sqp", "sequential quadratic programming with curvature by stage", "", &make_sqp_solver});
  all.push_back({"hybrid",
                 "many seeds scored in one batch, the best polished with derivatives, then "
                 "neighbours of the incumbent",
                 "", [] { return make_hybrid_solver("hybrid", &make_solver); }});
  std::sort(all.begin(), all.end(), [](const Entry& a, const Entry& b) { return a.name < b.name; });
  return all;
}

}  // namespace

void SolverRegistry::add(std::shared_ptr<const Solver> solver, std::string description) {
  const std::string name = solver->name();
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' ||
           c == '-' || c == '.' || c == ':';
  };
  if (name.empty() || name.size() > 64 || !std::all_of(name.begin(), name.end(), plain) ||
      name == "unknown") {
    throw std::invalid_argument(
        "a back end is named '" + name +
        "'; expected 1 to 64 letters, digits and _-.: other than 'unknown'");
  }
  for (const SolverInfo& info : list()) {
    if (info.name == name) {
      throw std::invalid_argument("there is a back end named '" + name +
                                  "' already; expected another name");
    }
  }
  added_.push_back({std::move(solver), std::move(description)});
}

std::shared_ptr<const Solver> SolverRegistry::make(std::string_view name) const {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) {
    if (entry.name == name) {
      if (entry.make) return entry.make();
      return std::make_shared<AbsentSolver>(entry.name, entry.needs);
    }
    names.push_back(entry.name);
  }
  for (const Added& added : added_) {
    names.push_back(added.solver->name());
    if (names.back() == name) return added.solver;
  }
  const std::string given(name);
  throw std::invalid_argument("unknown solver '" + given + "'" + did_you_mean(given, names) +
                              expected_one_of(names));
}

std::vector<SolverInfo> SolverRegistry::list() const {
  std::vector<SolverInfo> list;
  for (const Entry& entry : entries()) {
    list.push_back({entry.name, entry.description, make(entry.name)->options(),
                    static_cast<bool>(entry.make), entry.needs});
  }
  for (const Added& added : added_) {
    list.push_back({added.solver->name(), added.description, added.solver->options(), true, ""});
  }
  std::sort(list.begin(), list.end(),
            [](const SolverInfo& a, const SolverInfo& b) { return a.name < b.name; });
  return list;
}

std::shared_ptr<const Solver> make_solver(std::string_view name) {
  return SolverRegistry().make(name);
}

std::vector<SolverInfo> list_solvers() { return SolverRegistry().list(); }

}  // namespace prospect
