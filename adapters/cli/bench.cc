#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/bench/bench_files.h"
#include "adapters/bench/bench_run.h"
#include "adapters/bench/bench_summary.h"
#include "adapters/bench/mission_set.h"
#include "adapters/bench/problem_set.h"
#include "adapters/bench/solver_choice.h"
#include "adapters/cli/absent_solver.h"
#include "adapters/cli/commands.h"
#include "adapters/cli/interrupt.h"
#include "adapters/files/input_error.h"
#include "adapters/problem_file/problem_file.h"

namespace prospect {
namespace {

/// One of each kind, of those that are built in.
std::vector<std::string> default_solvers(const SolverRegistry& registry, bool quick) {
  const std::vector<std::string> wanted =
      quick ? std::vector<std::string>{"hybrid", "ceres", "nlopt:LD_SLSQP", "nlopt:LD_LBFGS",
                                       "sampling"}
            : std::vector<std::string>{"hybrid",          "ceres",          "ipopt",
                                       "nlopt:LD_SLSQP",  "nlopt:LD_LBFGS", "nlopt:LD_CCSAQ",
                                       "nlopt:LN_BOBYQA", "nlopt:LN_SBPLX", "sampling",
                                       "sampling:cem"};
  std::vector<std::string> names;
  for (const std::string& name : wanted) {
    for (const SolverInfo& info : registry.list()) {
      if (info.name == name && info.available) names.push_back(name);
    }
  }
  return names;
}

/// Writes the problems of the set `missions` to a new folder, which is then a set.
int capture(const BenchArguments& arguments, const SolverRegistry& registry) {
  namespace fs = std::filesystem;
  const std::string& folder = arguments.capture;
  const char* const expected = "; expected a new or empty folder";
  if (!arguments.sets.empty()) {
    throw InputError("--capture: '" + arguments.sets.front() +
                     "' beside it; expected no set, as it writes 'missions'");
  }
  std::error_code error;
  if (fs::exists(folder, error) && !(fs::is_directory(folder) && fs::is_empty(folder, error))) {
    throw InputError("--capture " + folder + ": is there already" + expected);
  }
  fs::create_directories(folder, error);
  if (error) {
    throw InputError("--capture " + folder + ": cannot be made (" + error.message() + ")" +
                     expected);
  }
  int written = 0;
  capture_missions(arguments.quick ? quick_missions() : default_missions(), registry,
                   [&](const SavedProblem& saved) {
                     write_problem((fs::path(folder) / problem_file_name(saved.origin)).string(),
                                   saved);
                     ++written;
                   });
  std::printf("%d problems in %s\n", written, folder.c_str());
  return kDone;
}

}  // namespace

int bench(const BenchArguments& arguments, const SolverRegistry& registry) {
  if (!arguments.capture.empty()) return capture(arguments, registry);
  // Everything is looked at before anything is measured or written.
  const std::vector<SolverChoice> solvers = choose_solvers(
      arguments.solvers.empty() ? default_solvers(registry, arguments.quick) : arguments.solvers,
      registry);
  for (const SolverChoice& choice : solvers) {
    if (tell_if_absent(choice.solver->name(), registry)) return kNotBuiltIn;
  }
  std::vector<std::string> names = arguments.sets;
  if (names.empty()) names = builtin_set_names();
  std::vector<ProblemSet> sets;
  std::set<std::string> used;
  for (const std::string& name : names) {
    sets.push_back(make_problem_set(name, registry, arguments.quick));
    if (!used.insert(sets.back().name).second) {
      throw InputError("problem set '" + name + "': another one is named '" + sets.back().name +
                       "' too; expected sets of different names");
    }
    if (arguments.keep_best && sets.back().folder.empty()) {
      throw InputError("--keep-best: '" + name +
                       "' is no folder; expected folders of problem files only");
    }
  }
  BenchOptions options;
  options.deadlines = arguments.deadlines;
  if (options.deadlines.empty()) {
    options.deadlines = arguments.quick ? std::vector<double>{0.1} : std::vector<double>{0.1, 1.0};
  }
  if (std::set<double>(options.deadlines.begin(), options.deadlines.end()).size() !=
      options.deadlines.size()) {
    throw InputError("--deadline: the same twice; expected each once");
  }
  options.repeats = arguments.repeats > 0 ? arguments.repeats : (arguments.quick ? 1 : 3);
  options.max_evaluations = arguments.max_evaluations;
  options.seed = arguments.seed;
  options.relative_tolerance = arguments.tolerance;
  const std::string out = arguments.out.empty() ? "runs/bench" : arguments.out;
  open_bench_folder(out);

  options.cancelled = catch_interrupts();
  if (isatty(STDERR_FILENO)) {
    options.on_solve = [](int done, int all) {
      std::fprintf(stderr, "\r%d of %d solves%s", done, all, done == all ? "\n" : "");
    };
  }
  const BenchTable table = run_bench(std::move(sets), solvers, options);
  if (table.cancelled) {
    std::cerr << "prospect: cancelled; nothing is written\n";
    return kFailed;
  }

  const std::vector<GroupSummary> groups = summarize(table);
  write_bench_folder(out, table, groups);
  if (arguments.keep_best) {
    for (std::size_t s = 0; s < table.sets.size(); ++s) {
      ProblemSet set = table.sets[s];
      for (std::size_t p = 0; p < set.problems.size(); ++p) {
        if (std::isfinite(table.best[s][p].cost))
          set.problems[p].best_known = table.best[s][p].cost;
      }
      keep_best_known(set);
    }
  }

  if (arguments.json) {
    std::cout << bench_json(table, groups, false)
                     .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << '\n';
  } else {
    for (const GroupSummary& group : groups) std::printf("%s\n", bench_text(table, group).c_str());
    std::printf("%s/bench.html\n", out.c_str());
  }
  std::set<std::string> told;
  bool any = false;
  for (const BenchRow& row : table.rows) {
    any |= row.solved;
    const std::string& solver = table.solvers[static_cast<std::size_t>(row.solver)];
    if (row.supported && row.stop == StopReason::kError && told.insert(solver).second) {
      std::cerr << "prospect: " << solver << ": " << row.detail << '\n';
    }
  }
  return any ? kDone : kFailed;
}

}  // namespace prospect
