// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/added_terms.h"

#include <cmath>
#include <exception>
#include <limits>
#include <stdexcept>
#include <utility>

namespace prospect {
namespace {

/// A problem of one term.
Problem alone(const ProblemSpecification& s, const std::shared_ptr<const Term>& term) {
  ProblemDefinition d;
  d.model = s.robot.model;
  d.x0 = s.x0;
  d.u_previous = s.u_previous;
  d.N = s.N;
  d.dt = s.dt;
  d.M = s.M;
  d.terms = {{term, 1.0}};
  return Problem(std::move(d));
}

/// "" if it can be evaluated, else what is wrong.
std::string fault(const ProblemSpecification& s, const std::shared_ptr<const Term>& term,
                  const std::vector<Seed>& seeds) {
  const Problem problem = alone(s, term);
  Eigen::MatrixXd X(problem.num_variables(), static_cast<Eigen::Index>(seeds.size()));
  for (std::size_t i = 0; i < seeds.size(); ++i) X.col(static_cast<Eigen::Index>(i)) = seeds[i].z;
  Workspace workspace = problem.make_workspace();
  Evaluation evaluation;
  problem.evaluate(X, Evaluate::kValue, workspace, evaluation);
  for (Eigen::Index b = 0; b < X.cols(); ++b) {
    if (!evaluation.valid[b]) continue;
    if (!problem.has_gradient()) return "";
    const bool sound = problem.evaluate(X.col(b), Evaluate::kGradient, workspace, evaluation);
    return sound ? "" : "its gradient is no finite number";
  }
  return "its value is a finite number at no seed, or it throws";
}

void take_out(std::size_t at, ProblemSpecification& specification, CachedEvaluators& evaluators) {
  const auto offset = static_cast<std::ptrdiff_t>(at);
  specification.added_terms.erase(specification.added_terms.begin() + offset);
  evaluators.added_terms.erase(evaluators.added_terms.begin() + offset);
}

}  // namespace

void check_added_term(const TermUse& use) {
  if (!use.entry || !use.entry->make) {
    throw std::invalid_argument("planner.terms: a term without an entry; expected one");
  }
  const std::string term = "planner.terms." + use.entry->name;
  if (use.entry->built_in) {
    throw std::invalid_argument(term + " is built in; expected its weight (set_term.h)");
  }
  if (!(use.weight > 0.0 && use.weight <= TermEntry::kMostWeight)) {
    throw std::invalid_argument(term + ".weight = " + std::to_string(use.weight) +
                                "; expected above 0, at most 1e6");
  }
  for (const TermOption& option : use.entry->options) {
    if (!use.options.contains(option.name)) {
      throw std::invalid_argument(term + "." + option.name +
                                  " is missing; expected a number (TermRegistry::use)");
    }
  }
}

std::vector<FailedTerm> make_added_terms(ProblemSpecification& specification,
                                         CachedEvaluators& evaluators) {
  std::vector<FailedTerm> failed;
  evaluators.added_terms.clear();
  const std::vector<TermUse> wanted = std::move(specification.added_terms);
  specification.added_terms.clear();
  for (const TermUse& use : wanted) {
    try {
      evaluators.added_terms.push_back(make_term(use, {specification, evaluators}));
      specification.added_terms.push_back(use);
    } catch (const std::exception& e) {
      failed.push_back({use.entry->name, e.what()});
    }
  }
  return failed;
}

std::vector<FailedTerm> try_added_terms(ProblemSpecification& specification,
                                        CachedEvaluators& evaluators,
                                        const std::vector<Seed>& seeds) {
  std::vector<FailedTerm> failed;
  for (std::size_t i = 0; i < specification.added_terms.size();) {
    const std::string name = specification.added_terms[i].entry->name;
    std::string why;
    try {
      why = fault(specification, evaluators.added_terms[i], seeds);
    } catch (const std::exception& e) {
      why = e.what();
    } catch (...) {
      why = "it throws an exception that is not a std::exception";
    }
    if (why.empty()) {
      ++i;
      continue;
    }
    failed.push_back({name, "term '" + name + "': " + why});
    take_out(i, specification, evaluators);
  }
  return failed;
}

void tell(const std::vector<FailedTerm>& failed, Plan& plan) {
  for (const FailedTerm& term : failed) {
    plan.detail += (plan.detail.empty() ? "" : "; ") + term.why;
    plan.why += " Planned without " + term.why + '.';
    if (plan.explanation.terms.empty()) continue;
    plan.explanation.terms.push_back(
        {term.name, "", std::numeric_limits<double>::quiet_NaN(), 0.0, false});
  }
}

}  // namespace prospect
