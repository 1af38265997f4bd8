// s30 [--starts SEED] [SOLVER[,OPTION=VALUE]...]...: R1 from thirty starts, a row for each back end
// (all that are built in if none is named), each from the cold guess with its default options: the
// median of the times of a solve, J (mean, median) and how many are solved (r1.h). Of the solves of
// one start the fastest of three counts: other work on the machine only ever adds time. Other
// starts than S30 (--starts, to tune on) have no best known costs: the best of all rows counts.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "problems/r1.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

constexpr int kStarts = 30;
constexpr int kRepeats = 3;
constexpr unsigned kS30Seed = 17;

struct Row {
  std::string name;
  std::vector<double> ms, J;
  double evaluations = 0.0, gradients = 0.0;  ///< mean a solve
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

OptionValue parsed(const std::string& text, const OptionValue& like) {
  if (std::holds_alternative<std::string>(like)) return text;
  std::size_t used = 0;
  OptionValue value;
  if (std::holds_alternative<int>(like)) {
    value = std::stoi(text, &used);
  } else {
    value = std::stod(text, &used);
  }
  if (used != text.size()) throw std::invalid_argument("'" + text + "' is no number");
  return value;
}

Row run(const std::string& specification, const std::vector<Eigen::Vector3d>& starts) {
  std::istringstream parts(specification);
  std::string name, part;
  std::getline(parts, name, ',');
  const auto solver = make_solver(name);
  Options options;
  while (std::getline(parts, part, ',')) {
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string key = part.substr(0, equals);
    OptionValue like = std::string();
    for (const OptionInfo& info : solver->options()) {
      if (info.name == key) like = info.fallback;
    }
    options[key] = parsed(part.substr(std::min(equals + 1, part.size())), like);
  }
  Row row{specification, {}, {}};
  WarmStart cold;
  cold.x = r1_cold();
  for (const Eigen::Vector3d& x0 : starts) {
    const Problem problem = make_r1(x0);
    double ms = std::numeric_limits<double>::infinity();
    Result result;
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      result = solver->solve(problem, cold, options, {});
      if (result.stop == StopReason::kError) throw std::runtime_error(result.detail);
      ms = std::min(ms, 1e3 * result.wall_seconds);
    }
    row.ms.push_back(ms);
    row.J.push_back(result.cost);
    row.evaluations += result.counters.cost_evaluations / static_cast<double>(starts.size());
    row.gradients += result.counters.gradient_evaluations / static_cast<double>(starts.size());
  }
  return row;
}

void print(const Row& row, const std::vector<double>& best) {
  int solved = 0;
  for (std::size_t i = 0; i < best.size(); ++i) solved += r1_solved(row.J[i], best[i]);
  const double mean = std::accumulate(row.J.begin(), row.J.end(), 0.0) / kStarts;
  std::printf("| `%s` | %.1f | %.1f | %.3f | %.4f | %d | %.0f | %.0f |\n", row.name.c_str(),
              median(row.ms), *std::max_element(row.ms.begin(), row.ms.end()), mean, median(row.J),
              solved, row.evaluations, row.gradients);
  std::fflush(stdout);
}

int table(std::vector<std::string> arguments) {
  unsigned seed = kS30Seed;
  if (arguments.size() >= 2 && arguments[0] == "--starts") {
    seed = static_cast<unsigned>(std::get<int>(parsed(arguments[1], 0)));
    arguments.erase(arguments.begin(), arguments.begin() + 2);
  }
  if (arguments.empty()) {
    for (const SolverInfo& info : list_solvers()) {
      if (info.available) arguments.push_back(info.name);
    }
  }
  const std::vector<Eigen::Vector3d> starts = r1_starts(seed, kStarts);
  std::printf(
      "| back end | ms, median | ms, worst | J, mean | J, median | solved of 30 | evaluations | of "
      "them with gradient |\n|---|---|---|---|---|---|---|---|\n");
  std::vector<double> best(s30_best_known().begin(), s30_best_known().end());
  std::vector<Row> rows;
  for (const std::string& specification : arguments) {
    rows.push_back(run(specification, starts));
    if (seed == kS30Seed) print(rows.back(), best);
  }
  if (seed != kS30Seed) {
    for (std::size_t i = 0; i < best.size(); ++i) {
      best[i] = std::numeric_limits<double>::infinity();
      for (const Row& row : rows) best[i] = std::min(best[i], row.J[i]);
    }
    for (const Row& row : rows) print(row, best);
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  try {
    return prospect::table({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::cerr << "s30: " << e.what() << '\n';
    return 2;
  }
}
