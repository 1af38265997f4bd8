#include "solvers/registry.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "models/nearest_name.h"
#include "solvers/evaluator.h"
#include "solvers/nlopt_algorithms.h"
#include "solvers/options.h"
#include "solvers/sampling/sampling_solver.h"
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
  sampling("sampling:mppi", SamplingMethod::kPathIntegral,
           "model predictive path integral control on the knots");
  sampling("sampling:search", SamplingMethod::kSearch,
           "systematic search over constant and two-segment inputs, then pattern search");
  std::sort(all.begin(), all.end(), [](const Entry& a, const Entry& b) { return a.name < b.name; });
  return all;
}

}  // namespace

std::shared_ptr<const Solver> make_solver(std::string_view name) {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) {
    if (entry.name == name) {
      if (entry.make) return entry.make();
      return std::make_shared<AbsentSolver>(entry.name, entry.needs);
    }
    names.push_back(entry.name);
  }
  const std::string given(name);
  throw std::invalid_argument("unknown solver '" + given + "'" + did_you_mean(given, names) +
                              expected_one_of(names));
}

std::vector<SolverInfo> list_solvers() {
  std::vector<SolverInfo> list;
  for (const Entry& entry : entries()) {
    list.push_back({entry.name, entry.description, make_solver(entry.name)->options(),
                    static_cast<bool>(entry.make), entry.needs});
  }
  return list;
}

}  // namespace prospect
