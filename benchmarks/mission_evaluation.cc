// SPDX-License-Identifier: Apache-2.0
// mission_evaluation FILE...: processor time of one evaluation of the planning problems in these
// files (explore --save-problems), at the planner's seeds and 60 spread over the bounds: a value, a
// value with gradient, a candidate of a batch, a score, and each term's value alone. Of each time
// the least of several rounds, in microseconds, the mean over the problems. And the largest
// difference between a score and the value, as a share of max(1, |value|).

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "adapters/formats/problem_file/problem_file.h"
#include "solvers/hybrid/spread_candidates.h"

namespace prospect {
namespace {

constexpr int kRounds = 7;

double processor_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Microseconds for each of `count` candidates that `run` evaluates.
template <class Run>
double microseconds(Eigen::Index count, const Run& run) {
  double least = std::numeric_limits<double>::infinity();
  run();  // scratch is allocated
  for (int i = 0; i < kRounds; ++i) {
    const double begin = processor_seconds();
    run();
    least = std::min(least, processor_seconds() - begin);
  }
  return 1e6 * least / static_cast<double>(count);
}

Eigen::MatrixXd points(const ReadProblem& p) {
  Eigen::MatrixXd spread = spread_candidates(*p.problem, 60, 5);
  const auto seeds = static_cast<Eigen::Index>(p.saved.seeds.size());
  Eigen::MatrixXd X(p.problem->num_variables(), seeds + spread.cols());
  for (Eigen::Index i = 0; i < seeds; ++i) {
    X.col(i) = p.saved.seeds[static_cast<std::size_t>(i)].z;
  }
  X.rightCols(spread.cols()) = spread;
  return X;
}

void measure(const ReadProblem& p, std::map<std::string, double>& sum, double& score_error) {
  const Problem& problem = *p.problem;
  const Eigen::MatrixXd X = points(p);
  Workspace workspace = problem.make_workspace();
  Evaluation evaluation;
  const auto each = [&](const Problem& of, Evaluate what, Workspace& w) {
    return microseconds(X.cols(), [&] {
      for (Eigen::Index i = 0; i < X.cols(); ++i) of.evaluate(X.col(i), what, w, evaluation);
    });
  };
  sum["value"] += each(problem, Evaluate::kValue, workspace);
  sum["value and gradient"] += each(problem, Evaluate::kGradient, workspace);
  sum["candidate of a batch"] +=
      microseconds(X.cols(), [&] { problem.evaluate(X, Evaluate::kValue, workspace, evaluation); });
  sum["score of a batch"] +=
      microseconds(X.cols(), [&] { problem.evaluate(X, Evaluate::kScore, workspace, evaluation); });
  const Eigen::ArrayXd scores = evaluation.cost;
  problem.evaluate(X, Evaluate::kValue, workspace, evaluation);
  const Eigen::ArrayXd values = evaluation.cost;
  score_error = std::max(score_error, ((scores - values).abs() / values.abs().max(1.0)).maxCoeff());
  for (const auto& weighted : problem.definition().terms) {
    ProblemDefinition alone = problem.definition();
    alone.terms = {weighted};
    const Problem part(alone);
    Workspace own = part.make_workspace();
    sum["  " + std::string(weighted.term->name()) + " alone"] += each(part, Evaluate::kValue, own);
  }
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  using namespace prospect;
  if (argc < 2) {
    std::fprintf(stderr, "mission_evaluation: no problem file given; expected FILE...\n");
    return 2;
  }
  try {
    std::map<std::string, double> sum;
    double score_error = 0.0;
    for (int i = 1; i < argc; ++i) measure(read_problem(argv[i]), sum, score_error);
    for (const auto& [name, total] : sum)
      std::printf("%-28s %8.2f\n", name.c_str(), total / (argc - 1));
    std::printf("%-28s %8.1e\n", "largest error of a score", score_error);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "mission_evaluation: %s\n", e.what());
    return 2;
  }
}
