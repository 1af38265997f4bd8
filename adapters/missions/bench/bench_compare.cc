// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/bench/bench_rows.h"
#include "adapters/missions/bench/target_curves.h"
#include "models/range_text.h"

namespace prospect {
namespace {

using Json = nlohmann::ordered_json;
using Pair = std::pair<const BenchRow*, const BenchRow*>;

constexpr double kLeastSeconds = 1e-9;  // ratios need times above zero
constexpr double kFarGap = 1.0;         // of what has no feasible point

/// Both tables are judged by the same best known costs.
void judge_alike(BenchTable& a, BenchTable& b) {
  for (ProblemSetFacts& set : a.sets) {
    for (ProblemSetFacts& other : b.sets) {
      if (set.name != other.name) continue;
      for (ProblemFacts& p : set.problems) {
        for (ProblemFacts& q : other.problems) {
          if (p.name != q.name) continue;
          if (p.fingerprint != q.fingerprint) {
            throw InputError("bench compare: problem '" + p.name + "' of '" + set.name +
                             "' is not the same in both; expected benches of the same problems");
          }
        }
      }
    }
  }
  judge(a);
  judge(b);
  const auto lower = [](BenchTable& to, const BenchTable& from) {
    for (std::size_t s = 0; s < to.sets.size(); ++s) {
      for (std::size_t p = 0; p < to.sets[s].problems.size(); ++p) {
        ProblemFacts& problem = to.sets[s].problems[p];
        for (std::size_t t = 0; t < from.sets.size(); ++t) {
          if (from.sets[t].name != to.sets[s].name) continue;
          for (std::size_t q = 0; q < from.sets[t].problems.size(); ++q) {
            if (from.sets[t].problems[q].name != problem.name) continue;
            const double best = std::min(to.best[s][p].cost, from.best[t][q].cost);
            if (std::isfinite(best)) problem.best_known = best;
          }
        }
      }
    }
  };
  lower(a, b);
  lower(b, a);
  judge(a);
  judge(b);
}

/// What the environments of two benches differ in, in words.
std::vector<std::string> differences(const BenchTable& a, const BenchTable& b) {
  std::vector<std::string> found;
  const auto value = [](const BenchTable& table, const char* key, bool of_build) {
    if (table.environments.empty()) return Json();
    const Json& environment = table.environments.front();
    const Json& from = of_build ? environment.value("build", Json::object()) : environment;
    return Json(from.is_object() ? from.value(key, Json()) : Json());
  };
  const auto view = [&](const char* key, bool of_build) {
    const Json first = value(a, key, of_build), second = value(b, key, of_build);
    if (first != second)
      found.push_back(std::string(key) + ": " + first.dump() + ", " + second.dump());
  };
  for (const char* key : {"version", "commit", "compiler", "flags", "build_type", "libraries"}) {
    view(key, true);
  }
  for (const char* key : {"processor", "cores", "system", "kernel", "threads"}) view(key, false);
  if (a.clock != b.clock) {
    found.push_back("clock: " + to_string(a.clock) + ", " + to_string(b.clock));
  }
  const auto load = [](const BenchTable& table) {
    double sum = 0.0;
    for (const BenchRow& row : table.rows) sum += row.load;
    return sum / static_cast<double>(table.rows.size());
  };
  char text[80];
  std::snprintf(text, sizeof text, "mean load: %.2g, %.2g", load(a), load(b));
  found.emplace_back(text);
  return found;
}

PairedNumber paired(std::string name, const std::vector<Pair>& pairs, bool ratio,
                    double (*value)(const BenchRow&)) {
  PairedNumber number;
  number.name = std::move(name);
  number.ratio = ratio;
  std::vector<const BenchRow*> rows;
  std::vector<double> differences;
  for (const auto& [first, second] : pairs) {
    const double a = value(*first), b = value(*second);
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    rows.push_back(first);
    differences.push_back(ratio ? std::log(b / a) : b - a);
  }
  number.pairs = static_cast<int>(rows.size());
  const Eigen::VectorXd of_problems = by_problem(rows, differences);
  const ResampledMeans means(static_cast<int>(of_problems.size()));
  number.change = means.interval(of_problems);
  if (ratio) {
    number.change = {std::exp(number.change.mean), std::exp(number.change.low),
                     std::exp(number.change.high)};
  }
  if (of_problems.size() > 0) number.p = sign_flip_p(of_problems);
  return number;
}

SolverComparison compare_solver(const std::string& solver, double deadline,
                                const std::vector<Pair>& pairs) {
  SolverComparison c;
  c.solver = solver;
  c.deadline = deadline;
  c.pairs = static_cast<int>(pairs.size());
  for (const auto& [first, second] : pairs) {
    c.only_first_solved += first->solved && !second->solved;
    c.only_second_solved += second->solved && !first->solved;
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    c.changed += deadline == 0.0 &&
                 (!same(first->cost, second->cost) ||
                  first->counters.cost_evaluations != second->counters.cost_evaluations ||
                  first->counters.gradient_evaluations != second->counters.gradient_evaluations);
  }
  c.numbers.push_back(
      paired("solved", pairs, false, [](const BenchRow& r) { return r.solved ? 1.0 : 0.0; }));
  c.numbers.push_back(
      paired("gap", pairs, false, [](const BenchRow& r) { return std::min(r.gap, kFarGap); }));
  c.numbers.push_back(paired("evaluations to target", pairs, true, [](const BenchRow& r) {
    return std::max(r.evaluations_to_target, 1.0);
  }));
  c.numbers.push_back(paired("time to target", pairs, true, [](const BenchRow& r) {
    return std::max(r.seconds_to_target, kLeastSeconds);
  }));
  c.numbers.push_back(paired("time of the solve", pairs, true, [](const BenchRow& r) {
    return r.supported ? std::max(r.seconds, kLeastSeconds)
                       : std::numeric_limits<double>::infinity();
  }));
  return c;
}

/// Holm's correction over all numbers.
void correct(std::vector<SolverComparison>& solvers) {
  std::vector<PairedNumber*> all;
  for (SolverComparison& c : solvers) {
    for (PairedNumber& number : c.numbers) {
      if (number.pairs > 0) all.push_back(&number);
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const PairedNumber* a, const PairedNumber* b) { return a->p < b->p; });
  double most = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    most = std::max(most, std::min(1.0, all[i]->p * static_cast<double>(all.size() - i)));
    all[i]->corrected = most;
    all[i]->beyond_noise = most < 0.05;
  }
}

std::string change_text(const PairedNumber& n) {
  char text[120];
  if (n.pairs == 0) return "-";
  std::snprintf(text, sizeof text, n.ratio ? "x %.3g [%.3g, %.3g]" : "%+.3g [%+.3g, %+.3g]",
                n.change.mean, n.change.low, n.change.high);
  return text;
}

}  // namespace

BenchComparison compare_benches(const std::string& first, const std::string& second,
                                double relative_tolerance) {
  BenchTable a = read_bench_rows(first), b = read_bench_rows(second);
  a.relative_tolerance = b.relative_tolerance = relative_tolerance;
  judge_alike(a, b);
  sort_rows(a);
  BenchComparison comparison;
  comparison.first = first;
  comparison.second = second;
  std::map<std::string, const BenchRow*> others;
  for (const BenchRow& row : b.rows) others[words_of(b, row)] = &row;
  std::map<std::pair<int, double>, std::vector<Pair>> pairs;
  for (const BenchRow& row : a.rows) {
    const auto other = others.find(words_of(a, row));
    if (other == others.end()) {
      ++comparison.only_first;
      continue;
    }
    pairs[{row.solver, row.deadline}].emplace_back(&row, other->second);
    others.erase(other);
  }
  comparison.only_second = static_cast<int>(others.size());
  if (pairs.empty()) {
    throw InputError("bench compare: " + first + " and " + second +
                     " have no row in common; expected the same problems by the same back ends");
  }
  comparison.different = differences(a, b);
  for (const auto& [key, of] : pairs) {
    comparison.solvers.push_back(
        compare_solver(a.solvers[static_cast<std::size_t>(key.first)], key.second, of));
  }
  correct(comparison.solvers);
  return comparison;
}

std::string comparison_text(const BenchComparison& comparison) {
  std::string out = "first:  " + comparison.first + "\nsecond: " + comparison.second + '\n';
  for (const std::string& what : comparison.different) out += what + '\n';
  const auto lonely = [&](int count, const char* which) {
    if (count > 0) out += std::to_string(count) + " rows only in the " + which + '\n';
  };
  lonely(comparison.only_first, "first");
  lonely(comparison.only_second, "second");
  char line[256];
  for (const SolverComparison& c : comparison.solvers) {
    out += '\n' + c.solver + ", " +
           (c.deadline > 0.0 ? "deadline " + exact_text(1e3 * c.deadline) + " ms"
                             : std::string("no deadline")) +
           ": " + std::to_string(c.pairs) + " pairs, solved only by the first " +
           std::to_string(c.only_first_solved) + ", only by the second " +
           std::to_string(c.only_second_solved);
    if (c.deadline == 0.0) {
      out += c.changed > 0 ? ", other costs or counts in " + std::to_string(c.changed)
                           : std::string(", the same costs and counts");
    }
    out += '\n';
    for (const PairedNumber& n : c.numbers) {
      std::snprintf(line, sizeof line, "  %-22s %4d  %-30s p %-8.2g %s\n", n.name.c_str(), n.pairs,
                    change_text(n).c_str(), n.corrected,
                    n.beyond_noise ? "beyond noise" : "within noise");
      out += line;
    }
  }
  return out;
}

nlohmann::ordered_json comparison_json(const BenchComparison& comparison) {
  Json solvers = Json::array();
  for (const SolverComparison& c : comparison.solvers) {
    Json numbers = Json::array();
    for (const PairedNumber& n : c.numbers) {
      numbers.push_back({{"name", n.name},
                         {"pairs", n.pairs},
                         {n.ratio ? "ratio" : "difference", n.change.mean},
                         {"interval", {n.change.low, n.change.high}},
                         {"p", n.p},
                         {"p_corrected", n.corrected},
                         {"beyond_noise", n.beyond_noise}});
    }
    solvers.push_back({{"solver", c.solver},
                       {"deadline_s", c.deadline},
                       {"pairs", c.pairs},
                       {"only_first_solved", c.only_first_solved},
                       {"only_second_solved", c.only_second_solved},
                       {"changed", c.changed},
                       {"numbers", numbers}});
  }
  return {{"first", comparison.first},
          {"second", comparison.second},
          {"different", comparison.different},
          {"only_first", comparison.only_first},
          {"only_second", comparison.only_second},
          {"solvers", solvers}};
}

}  // namespace prospect
