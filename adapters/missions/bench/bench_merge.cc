// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_merge.h"

#include <algorithm>
#include <set>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/bench/bench_rows.h"

namespace prospect {
namespace {

template <typename T>
void add_new(std::vector<T>& to, const std::vector<T>& from) {
  for (const T& value : from) {
    if (std::find(to.begin(), to.end(), value) == to.end()) to.push_back(value);
  }
}

/// Words of the first cell that has no row; "".
std::string missing_row(const BenchTable& table) {
  std::set<std::string> there;
  for (const BenchRow& row : table.rows) there.insert(words_of(table, row));
  BenchRow cell;
  for (cell.set = 0; cell.set < static_cast<int>(table.sets.size()); ++cell.set) {
    const auto problems = static_cast<int>(table.set_of(cell).problems.size());
    for (cell.problem = 0; cell.problem < problems; ++cell.problem) {
      for (const double deadline : table.deadlines) {
        for (const int seed : table.seeds) {
          for (cell.solver = 0; cell.solver < static_cast<int>(table.solvers.size());
               ++cell.solver) {
            cell.deadline = deadline;
            cell.seed = seed;
            const std::string words = words_of(table, cell);
            if (!there.contains(words)) return words;
          }
        }
      }
    }
  }
  return "";
}

}  // namespace

void add_problems(BenchTable& to, const BenchTable& from, const std::string& folder) {
  const auto fail = [&](const std::string& what) {
    throw InputError(folder + ": " + what + "; expected the same as in the other benches");
  };
  for (const ProblemSetFacts& set : from.sets) {
    const auto known =
        std::find_if(to.sets.begin(), to.sets.end(), [&](auto& s) { return s.name == set.name; });
    if (known == to.sets.end()) {
      to.sets.push_back(set);
      continue;
    }
    if (known->absolute_tolerance != set.absolute_tolerance) {
      fail("the tolerance of set '" + set.name + "'");
    }
    for (const ProblemFacts& problem : set.problems) {
      const auto same = std::find_if(known->problems.begin(), known->problems.end(),
                                     [&](auto& p) { return p.name == problem.name; });
      if (same == known->problems.end()) {
        known->problems.push_back(problem);
        continue;
      }
      if (same->fingerprint != problem.fingerprint) {
        fail("problem '" + problem.name + "' of '" + set.name + "' is another one");
      }
      if (problem.best_known && (!same->best_known || *problem.best_known < *same->best_known)) {
        same->best_known = problem.best_known;
      }
    }
  }
}

BenchTable merge_benches(const std::vector<std::string>& folders) {
  std::vector<BenchTable> parts;
  for (const std::string& folder : folders) parts.push_back(read_bench_rows(folder));
  BenchTable merged;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const BenchTable& part = parts[i];
    if (i == 0) {
      merged = part;
      merged.rows.clear();
      merged.environments.clear();
      continue;
    }
    const auto same = [&](const char* what, int first, int other) {
      if (first == other) return;
      throw InputError("bench merge: " + folders[i] + ": " + what + " " + std::to_string(other) +
                       "; expected " + std::to_string(first) + " as in " + folders[0]);
    };
    if (part.clock != merged.clock) {
      throw InputError("bench merge: " + folders[i] + ": times by --clock " +
                       to_string(part.clock) + "; expected " + to_string(merged.clock) + " as in " +
                       folders[0]);
    }
    same("repeats", merged.repeats, part.repeats);
    same("evaluations at most", merged.max_evaluations, part.max_evaluations);
    add_problems(merged, part, folders[i]);
    add_new(merged.solvers, part.solvers);
    add_new(merged.deadlines, part.deadlines);
    add_new(merged.seeds, part.seeds);
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (const std::string twice = take_rows(merged, parts[i]); !twice.empty()) {
      throw InputError("bench merge: " + folders[i] + ": " + twice +
                       " is in another bench, too; expected each row once");
    }
  }
  if (const std::string missing = missing_row(merged); !missing.empty()) {
    throw InputError("bench merge: no row of " + missing +
                     "; expected every back end on every problem");
  }
  sort_rows(merged);
  judge(merged);
  return merged;
}

}  // namespace prospect
