// SPDX-License-Identifier: Apache-2.0
// coarse_problems FILE...: what cheaper stand-ins for planning problems are worth (files of
// `explore --save-problems` or `bench --capture`). A stand-in has the same variables, but fewer
// landmarks, those that are alike merged, or half as many stages, each twice as long.
//
// First table, a row for each: landmarks; processor time of a score and of a value with gradient
// [us], least of several rounds; and how its costs at the planner's seeds and a spread over the
// bounds differ from those of the problem: mean, largest, and the correlation of the ranks
// (Spearman) over the feasible points.
//
// Second table: how many problems are solved, and the mean processor time of a solve [ms]. By the
// problem alone; by a stand-in and then 25 evaluations of the problem, from where that ended; and
// by `hybrid` on the problem after a first round, ten seeds with ten evaluations each, on a
// stand-in. Solved: as in `bench`, with the best of all rows as the best known.

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/problem_file/problem_file.h"
#include "adapters/missions/bench/solved_rule.h"
#include "benchmarks/guarded_main.h"
#include "solvers/hybrid/spread_candidates.h"
#include "solvers/registry.h"
#include "solvers/sampling/rate_projection.h"

namespace prospect {
namespace {

constexpr int kPoints = 208;  // whole chunks of 16
constexpr int kRounds = 3;
constexpr int kPolish = 25;  // evaluations of the problem itself after a stand-in's

struct StandIn {
  const char* name;
  std::size_t landmarks;  ///< at most
  int stages_each;        ///< stages of the problem that one stands for
};
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
constexpr StandIn kStandIns[] = {{"the problem", kAll, 1},
                                 {"120 landmarks", 120, 1},
                                 {"60 landmarks", 60, 1},
                                 {"half the stages", kAll, 2}};

/// The landmark that stands for all of these: the one nearest to their mean, with their mean
/// covariance, direction, range, survival and crowding, all weighted by what each can count.
Landmark stand_in(const std::vector<const Landmark*>& alike) {
  double all = 0.0;
  Landmark mean;
  mean.position.setZero();
  mean.covariance.setZero();
  mean.creation_direction.setZero();
  mean.multiplicity = mean.per_cell = mean.creation_range = 0.0;
  for (const Landmark* l : alike) {
    const double weight = l->multiplicity * l->survival;
    all += weight;
    mean.multiplicity += l->multiplicity;
    mean.position += weight * l->position;
    mean.covariance += weight * l->covariance;
    mean.creation_direction += weight * l->creation_direction.normalized();
    mean.creation_range += weight / l->creation_range;
    mean.per_cell += weight * l->per_cell;
  }
  mean.position /= all;
  mean.covariance /= all;
  mean.creation_range = all / mean.creation_range;
  mean.per_cell /= all;
  mean.survival = std::min(1.0, all / mean.multiplicity);
  const auto distance = [&](const Landmark* l) {
    return (l->position - mean.position).squaredNorm();
  };
  const Landmark& nearest = **std::min_element(
      alike.begin(), alike.end(),
      [&](const Landmark* a, const Landmark* b) { return distance(a) < distance(b); });
  mean.position = nearest.position;  // on a surface
  if (mean.creation_direction.norm() < 1e-6) mean.creation_direction = nearest.creation_direction;
  mean.creation_direction.normalize();
  return mean;
}

/// Merges landmarks of one cell of a lattice that were made from one quarter of directions, in the
/// finest lattice that leaves few enough.
std::vector<Landmark> merged(const std::vector<Landmark>& landmarks, std::size_t most) {
  if (landmarks.size() <= most) return landmarks;
  for (double side = 0.05;; side *= 1.2) {
    std::map<std::tuple<double, double, double, bool, bool>, std::vector<const Landmark*>> cells;
    for (const Landmark& l : landmarks) {
      const Eigen::Vector3d cell = (l.position / side).array().floor();
      const Eigen::Vector3d& from = l.creation_direction;
      cells[{cell.x(), cell.y(), cell.z(), from.x() > 0.0, from.y() > 0.0}].push_back(&l);
    }
    if (cells.size() > most) continue;
    std::vector<Landmark> result;
    for (const auto& [cell, alike] : cells) result.push_back(stand_in(alike));
    return result;
  }
}

ProblemSpecification stand_in(ProblemSpecification s, const StandIn& how) {
  s.landmarks = merged(s.landmarks, how.landmarks);
  s.N /= how.stages_each;
  s.dt *= how.stages_each;
  return s;
}

double processor_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class Run>
double microseconds_a_point(const Run& run) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRounds; ++i) {
    const double begin = processor_seconds();
    run();
    least = std::min(least, processor_seconds() - begin);
  }
  return 1e6 * least / kPoints;
}

Eigen::MatrixXd points(const ReadProblem& p) {
  Eigen::MatrixXd X = spread_candidates(*p.problem, kPoints, 5);
  const RateProjection rate(*p.problem);
  for (Eigen::Index i = 0; i < kPoints; ++i) {
    Eigen::VectorXd z = X.col(i);
    if (i < static_cast<Eigen::Index>(p.saved.seeds.size())) {
      z = p.saved.seeds[static_cast<std::size_t>(i)].z;
    }
    rate.apply(z);
    X.col(i) = z;
  }
  return X;
}

/// The place of each entry in increasing order.
Eigen::ArrayXd ranks(const Eigen::ArrayXd& x) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(x.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return x[a] < x[b]; });
  Eigen::ArrayXd rank(x.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<double>(i);
  return rank;
}

struct Comparison {
  double landmarks = 0.0, score = 0.0, gradient = 0.0, mean = 0.0, largest = 0.0;
  double correlation = 0.0;
  int correlated = 0;  ///< problems with enough feasible points

  void add(const ReadProblem& read, const ProblemSpecification& s, const Problem& problem) {
    const Eigen::MatrixXd X = points(read);
    Workspace workspace = problem.make_workspace(), own = read.problem->make_workspace();
    Evaluation e, exact;
    landmarks += static_cast<double>(s.landmarks.size());
    score += microseconds_a_point([&] {
      for (int i = 0; i < kPoints; i += 16) {
        problem.evaluate(X.middleCols(i, 16), Evaluate::kScore, workspace, e);
      }
    });
    gradient += microseconds_a_point([&] {
      for (int i = 0; i < kPoints; ++i) {
        problem.evaluate(X.col(i), Evaluate::kGradient, workspace, e);
      }
    });
    problem.evaluate(X, Evaluate::kValue, workspace, e);
    read.problem->evaluate(X, Evaluate::kValue, own, exact);
    const Eigen::ArrayXd error = (e.cost - exact.cost).abs();
    mean += error.mean();
    largest = std::max(largest, error.maxCoeff());
    std::vector<Eigen::Index> feasible;
    for (Eigen::Index i = 0; i < kPoints; ++i) {
      if (violation(exact.constraints.col(i)) <= kFeasible) feasible.push_back(i);
    }
    if (feasible.size() < 5) return;
    const Eigen::ArrayXd a = ranks(exact.cost(feasible)), b = ranks(e.cost(feasible));
    const Eigen::ArrayXd da = a - a.mean(), db = b - b.mean();
    correlation += (da * db).sum() / std::sqrt(da.square().sum() * db.square().sum());
    ++correlated;
  }
};

Result solve(const Problem& problem, const char* solver, const WarmStart& from,
             const Options& options) {
  return make_solver(solver)->solve(problem, from, options, {});
}

/// From the first of these points, with the others as seeds.
template <class Points, class PointOf>
WarmStart starts(const Points& points, const PointOf& point_of) {
  WarmStart w;
  w.x = point_of(points.front());
  w.seeds.resize(w.x.size(), static_cast<Eigen::Index>(points.size()) - 1);
  for (std::size_t i = 1; i < points.size(); ++i) {
    w.seeds.col(static_cast<Eigen::Index>(i) - 1) = point_of(points[i]);
  }
  return w;
}

/// A way to solve problems, and what came of it.
struct Row {
  std::string name;
  std::vector<double> costs;  ///< by problem
  double seconds = 0.0;
};

/// The planner's seeds, best first by this problem, after ten evaluations each of the best ten.
WarmStart first_round(const Problem& problem, const WarmStart& from) {
  constexpr std::size_t kBasins = 10;
  Eigen::MatrixXd X(from.x.size(), from.seeds.cols() + 1);
  X << from.x, from.seeds;
  const RateProjection rate(problem);
  for (Eigen::Index i = 0; i < X.cols(); ++i) rate.apply(X.col(i));
  Workspace workspace = problem.make_workspace();
  Evaluation e;
  problem.evaluate(X, Evaluate::kScore, workspace, e);
  std::vector<std::pair<std::pair<double, double>, Eigen::VectorXd>> ranked;
  for (Eigen::Index i = 0; i < X.cols(); ++i) {
    const double violated = violation(e.constraints.col(i));
    ranked.push_back({{violated <= kFeasible ? 0.0 : violated, e.cost[i]}, X.col(i)});
  }
  const auto rank = [&] {
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
  };
  rank();
  ranked.resize(std::min(ranked.size(), kBasins));
  for (auto& [key, x] : ranked) {
    WarmStart own;
    own.x = x;
    const Result r = solve(problem, "nlopt:LD_SLSQP", own, {{"max_evaluations", 10}});
    key = {r.violation <= kFeasible ? 0.0 : r.violation, r.cost};
    x = r.x;
  }
  rank();
  return starts(
      ranked, [](const auto& point) -> const auto& { return point.second; });
}

void solve_all(const ReadProblem& read,
               const std::vector<std::shared_ptr<const Problem>>& stand_ins,
               std::vector<Row>& rows) {
  const Problem& problem = *read.problem;
  const WarmStart from = starts(
      read.saved.seeds, [](const auto& seed) -> const auto& { return seed.z; });
  std::size_t next = 0;
  const auto row = [&](const std::string& name, const auto& run) {
    if (next == rows.size()) rows.push_back({name, {}});
    Row& row = rows[next++];
    const double begin = processor_seconds();
    const Result result = run();
    row.seconds += processor_seconds() - begin;
    row.costs.push_back(result.violation <= kFeasible ? result.cost
                                                      : std::numeric_limits<double>::infinity());
  };
  const Options wide = {{"candidates", 200}, {"basins", 30}};
  const auto limited = [](Options options, int evaluations) {
    options["max_evaluations"] = evaluations;
    return options;
  };
  row("hybrid, 3000", [&] { return solve(problem, "hybrid", from, limited(wide, 3000)); });
  for (const int most : {130, 165, 195, 260}) {
    row("hybrid, " + std::to_string(most),
        [&] { return solve(problem, "hybrid", from, limited({}, most)); });
  }
  const int more = static_cast<int>(from.seeds.cols()) + 76;
  row("hybrid, 130 and 75 seeds more", [&] {
    return solve(problem, "hybrid", from, limited({{"candidates", more}}, 205));
  });
  for (const char* sampler : {"sampling:cem", "sampling:mppi"}) {
    for (const int most : {300, 600}) {
      row(std::string(sampler) + ", " + std::to_string(most),
          [&] { return solve(problem, sampler, from, limited({}, most)); });
    }
  }
  for (std::size_t i = 1; i < stand_ins.size(); ++i) {
    const std::string name = kStandIns[i].name;
    for (const int most : {195, 1000}) {
      row(name + ", " + std::to_string(most) + " + 25", [&] {
        WarmStart end;
        end.x =
            solve(*stand_ins[i], "hybrid", from, limited(most < 1000 ? Options{} : wide, most)).x;
        return solve(problem, "nlopt:LD_SLSQP", end, limited({}, kPolish));
      });
    }
    row(name + ", first round + 90", [&] {
      return solve(problem, "hybrid", first_round(*stand_ins[i], from), limited({}, 90));
    });
  }
}

ReadProblem read(const std::string& path) {
  ReadProblem problem;
  try {
    problem = read_problem(path);
  } catch (const std::invalid_argument& e) {
    throw InputError(e.what());
  }
  if (problem.saved.seeds.empty()) {
    throw InputError(path + ": a problem without seeds; expected the planner's");
  }
  const ProblemSpecification& s = problem.saved.specification;
  if (s.N < 2 * s.M || s.N % 2 != 0) {
    throw InputError(path + ": " + std::to_string(s.N) + " stages and " + std::to_string(s.M) +
                     " knots; expected an even number of stages, two or more a knot");
  }
  return problem;
}

int program(int argc, char** argv) {
  if (argc < 2) throw InputError("no problem file given; expected FILE...");
  std::vector<Comparison> comparisons(std::size(kStandIns));
  std::vector<Row> rows;
  for (int f = 1; f < argc; ++f) {
    const ReadProblem given = read(argv[f]);
    std::vector<std::shared_ptr<const Problem>> problems;
    for (std::size_t i = 0; i < std::size(kStandIns); ++i) {
      const ProblemSpecification s = stand_in(given.saved.specification, kStandIns[i]);
      problems.push_back(i == 0 ? given.problem : make_problem(s));
      comparisons[i].add(given, s, *problems.back());
    }
    solve_all(given, problems, rows);
  }
  const int n = argc - 1;
  std::printf("%-30s %9s %8s %8s %8s %8s %8s\n", "", "landmarks", "score", "gradient", "mean",
              "largest", "ranks");
  for (std::size_t i = 0; i < std::size(kStandIns); ++i) {
    const Comparison& c = comparisons[i];
    std::printf("%-30s %9.0f %8.1f %8.1f %8.3f %8.3f %8.3f\n", kStandIns[i].name, c.landmarks / n,
                c.score / n, c.gradient / n, c.mean / n, c.largest,
                c.correlation / std::max(1, c.correlated));
  }
  std::printf("\n");
  for (const Row& row : rows) {
    int solved = 0;
    for (std::size_t p = 0; p < row.costs.size(); ++p) {
      double best = std::numeric_limits<double>::infinity();
      for (const Row& other : rows) best = std::min(best, other.costs[p]);
      solved += row.costs[p] <= SolvedRule{}.target(best);
    }
    std::printf("%-36s %3d of %3d  %6.1f ms\n", row.name.c_str(), solved, n, 1e3 * row.seconds / n);
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("coarse_problems", prospect::program, argc, argv);
}
