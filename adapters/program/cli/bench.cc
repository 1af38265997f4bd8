// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/formats/problem_file/problem_file.h"
#include "adapters/missions/bench/bench_compare.h"
#include "adapters/missions/bench/bench_files.h"
#include "adapters/missions/bench/bench_merge.h"
#include "adapters/missions/bench/bench_rows.h"
#include "adapters/missions/bench/bench_run.h"
#include "adapters/missions/bench/bench_summary.h"
#include "adapters/missions/bench/mission_set.h"
#include "adapters/missions/bench/problem_set.h"
#include "adapters/missions/bench/solver_choice.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/program/cli/absent_solver.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/program/cli/environment.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"

namespace prospect {
namespace {

struct BenchArguments {
  /// Empty: all built-in ones; or "merge" or "compare" and the folders of benches.
  std::vector<std::string> sets;
  ConfigurationArguments configuration;  ///< of the missions that are driven for a set
  std::vector<std::string> solvers;  ///< names, each followed by its options; empty: one of a kind
  std::vector<double> deadlines;     ///< [s], 0: none; empty: as the help says
  int repeats = 0;                   ///< 0: as the help says
  int max_evaluations = 10000;
  std::vector<int> seeds;  ///< of the back ends; empty: 1
  double tolerance = 0.01;
  std::string out;      ///< folder; empty: runs/bench
  std::string capture;  ///< folder to write the problems of `missions` to, instead of a bench
  bool quick = false;
  bool keep_best = false;
  bool publish = false;
  SolveClock clock = SolveClock::kWall;
  bool resume = false;
  bool overwrite = false;
  bool json = false;
  bool quiet = false;
};

/// One of each kind, of those that are built in.
std::vector<std::string> default_solvers(const SolverRegistry& registry, bool quick) {
  const std::vector<std::string> wanted =
      quick ? std::vector<std::string>{"hybrid",         "sqp",     "ceres", "nlopt:LD_SLSQP",
                                       "nlopt:LD_LBFGS", "sampling"}
            : std::vector<std::string>{"hybrid",         "sqp",
                                       "ceres",          "ipopt",
                                       "nlopt:LD_SLSQP", "nlopt:LD_LBFGS",
                                       "nlopt:LD_CCSAQ", "nlopt:LN_BOBYQA",
                                       "nlopt:LN_SBPLX", "sampling",
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
int capture(const BenchArguments& arguments, const Configuration& configuration,
            const Registries& registries, SignalGuard& signals) {
  const std::string& folder = arguments.capture;
  if (!arguments.sets.empty()) {
    throw InputError("--capture: '" + arguments.sets.front() +
                     "' beside it; expected no set, as it writes 'missions'");
  }
  signals.note();
  OutputFolder output = OutputFolder::own(folder, {"problems"});
  if (output.state() != OutputFolder::State::kNew) {
    throw InputError("--capture " + folder + ": is there already; expected a new or empty folder");
  }
  int written = 0;
  Progress progress(arguments.quiet);
  const bool all = capture_missions(
      arguments.quick ? quick_missions() : default_missions(), configuration, registries,
      [&](const SavedProblem& saved) {
        write_problem(output.claim(problem_file_name(saved.origin)), saved);
        ++written;
      },
      {[&](const std::string& what) { progress.show(what); }, signals.came()});
  progress.finish();
  std::printf("%d problems in %s\n", written, folder.c_str());
  if (all) {
    output.complete();
    return kDone;
  }
  std::cerr << "prospect: cancelled; the set lacks problems\n";
  return kCancelled;
}

/// The rows of the bench that the folder holds, if it holds one.
void take_earlier(BenchTable& table, const std::string& folder) {
  namespace fs = std::filesystem;
  if (!fs::exists(fs::path(folder) / kBenchRows)) return;
  const BenchTable earlier = read_bench_rows(folder);
  if (const std::string why = differs_from(earlier, table); !why.empty()) {
    throw InputError("--resume " + folder + ": " + why + "; expected the command that began it");
  }
  take_rows(table, earlier);
}

/// Of `bench merge` and `bench compare`: the folders. Throws InputError for what has no effect
/// there.
std::vector<std::string> folders_of(const BenchArguments& arguments, bool compare) {
  const std::string call = "bench " + arguments.sets.front();
  const bool other = !arguments.solvers.empty() || !arguments.deadlines.empty() ||
                     !arguments.seeds.empty() || !arguments.configuration.empty() ||
                     !arguments.capture.empty() || arguments.repeats > 0 || arguments.quick ||
                     arguments.keep_best || arguments.resume || arguments.publish ||
                     arguments.clock != SolveClock::kWall ||
                     (compare && (!arguments.out.empty() || arguments.overwrite));
  if (other) {
    throw InputError(call + ": an option of a measurement; expected " +
                     (compare ? "--tolerance or --json only"
                              : "--out, --overwrite, --tolerance or --json only"));
  }
  const std::vector<std::string> folders(arguments.sets.begin() + 1, arguments.sets.end());
  if (compare ? folders.size() != 2 : folders.size() < 2) {
    throw InputError(call + ": " + std::to_string(folders.size()) + " folders; expected " +
                     (compare ? "two" : "two or more"));
  }
  return folders;
}

void print_tables(const BenchTable& table, const std::vector<GroupSummary>& groups, bool json,
                  const std::string& out) {
  if (json) {
    std::cout << bench_json(table, groups, false)
                     .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << '\n';
    return;
  }
  for (const GroupSummary& group : groups) std::printf("%s\n", bench_text(table, group).c_str());
  std::printf("%s/bench.html\n", out.c_str());
}

EarlierRows earlier_rows(const BenchArguments& arguments) {
  if (arguments.resume && arguments.overwrite) {
    throw InputError(
        "--resume: beside --overwrite, which loses what it goes on with; expected one");
  }
  return arguments.resume      ? EarlierRows::kKept
         : arguments.overwrite ? EarlierRows::kReplaced
                               : EarlierRows::kRefused;
}

int merge(const BenchArguments& arguments, SignalGuard& signals) {
  const std::vector<std::string> folders = folders_of(arguments, false);
  BenchTable table = merge_benches(folders);
  table.relative_tolerance = arguments.tolerance;
  judge(table);
  const std::string out = arguments.out.empty() ? "runs/bench" : arguments.out;
  for (const std::string& folder : folders) {
    std::error_code ignored;
    if (std::filesystem::equivalent(folder, out, ignored)) {
      throw InputError("bench merge: --out is '" + folder + "'; expected a folder of its own");
    }
  }
  signals.note();
  OutputFolder folder = open_bench_folder(out, earlier_rows(arguments));
  begin_bench_folder(folder);
  const BenchRowFile rows(out, table);
  const std::vector<GroupSummary> groups = summarize(table);
  write_bench_folder(folder, table, groups);
  print_tables(table, groups, arguments.json, out);
  return kDone;
}

int compare(const BenchArguments& arguments) {
  const std::vector<std::string> folders = folders_of(arguments, true);
  const BenchComparison comparison = compare_benches(folders[0], folders[1], arguments.tolerance);
  if (arguments.json) {
    std::cout << comparison_json(comparison)
                     .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << '\n';
  } else {
    std::fputs(comparison_text(comparison).c_str(), stdout);
  }
  return kDone;
}

/// Says what went wrong in a bench that is whole: its exit code.
int end_of(const BenchTable& table, bool publish) {
  std::set<std::string> told;
  bool any = false;
  for (const BenchRow& row : table.rows) {
    any |= row.solved;
    const std::string& solver = table.solver_of(row);
    if (row.supported && row.stop == StopReason::kError && told.insert(solver).second) {
      std::cerr << "prospect: " << solver << ": " << row.detail << '\n';
    }
  }
  if (const std::string busy = busy_sentence(table); !busy.empty()) {
    std::cerr << "prospect: " << busy << '\n';
    if (publish && table.clock == SolveClock::kWall) {
      std::cerr << "prospect: --publish: not to be published\n";
      return kFailed;
    }
  }
  return any ? kDone : kFailed;
}

int bench(const BenchArguments& arguments, const Registries& registries, SignalGuard& signals) {
  if (!arguments.sets.empty() && arguments.sets.front() == "merge")
    return merge(arguments, signals);
  if (!arguments.sets.empty() && arguments.sets.front() == "compare") return compare(arguments);
  const Configuration configuration =
      read_told(arguments.configuration, registries, ConfigurationUse::kExplore);
  if (!arguments.capture.empty()) {
    return capture(arguments, configuration, registries, signals);
  }
  // Everything is looked at before anything is measured or written.
  const std::vector<SolverChoice> solvers = choose_solvers(
      arguments.solvers.empty() ? default_solvers(registries.solvers, arguments.quick)
                                : arguments.solvers,
      registries.solvers);
  for (const SolverChoice& choice : solvers) {
    if (tell_if_absent(choice.solver->name(), registries.solvers)) return kNotBuiltIn;
  }
  std::vector<std::string> names = arguments.sets;
  if (names.empty()) names = builtin_set_names();
  if (!arguments.configuration.empty() &&
      std::find(names.begin(), names.end(), "missions") == names.end()) {
    throw InputError(
        "--config and --set: of no effect on these sets; expected the set 'missions' among them");
  }
  BenchOptions options;
  options.cancelled = signals.came();
  Progress progress(arguments.quiet);
  const CaptureWatch watch{[&](const std::string& what) { progress.show(what); },
                           options.cancelled};
  std::vector<ProblemSet> sets;
  std::set<std::string> used;
  for (const std::string& name : names) {
    sets.push_back(make_problem_set(name, configuration, registries, arguments.quick, watch));
    progress.finish();
    if (!used.insert(sets.back().name).second) {
      throw InputError("problem set '" + name + "': another one is named '" + sets.back().name +
                       "' too; expected sets of different names");
    }
    if (arguments.keep_best && sets.back().folder.empty()) {
      throw InputError("--keep-best: '" + name +
                       "' is no folder; expected folders of problem files only");
    }
  }
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
  options.seeds = arguments.seeds.empty() ? std::vector<int>{1} : arguments.seeds;
  if (std::set<int>(options.seeds.begin(), options.seeds.end()).size() != options.seeds.size()) {
    throw InputError("--seed: the same twice; expected each once");
  }
  options.relative_tolerance = arguments.tolerance;
  options.clock = arguments.clock;
  options.environment = environment();
  const std::string out = arguments.out.empty() ? "runs/bench" : arguments.out;
  signals.note();  // not before: until here nothing is measured
  OutputFolder folder = open_bench_folder(out, earlier_rows(arguments));
  BenchTable table = empty_bench(sets, solvers, options);
  if (arguments.resume) take_earlier(table, out);
  begin_bench_folder(folder);
  BenchRowFile rows(out, table);

  options.on_row = [&](const BenchTable& of, const BenchRow& row) { rows.append(of, row); };
  options.on_solve = [&](int done, int all) {
    progress.show(std::to_string(done) + " of " + std::to_string(all) + " solves");
  };
  table = run_bench(sets, solvers, options, std::move(table));
  progress.finish();
  const auto count = [](const auto& of) {
    std::size_t problems = 0;
    for (const auto& set : of) problems += set.problems.size();
    return problems;
  };
  if (table.cancelled && count(table.sets) == 0) {
    std::cerr << "prospect: cancelled before the first problem was done; --resume goes on\n";
    return kCancelled;
  }

  const std::vector<GroupSummary> groups = summarize(table);
  write_bench_folder(folder, table, groups);
  if (arguments.keep_best) {
    for (std::size_t s = 0; s < table.sets.size(); ++s) {
      ProblemSet set = sets[s];  // whole, if the run was cancelled
      for (std::size_t p = 0; p < table.sets[s].problems.size(); ++p) {
        if (std::isfinite(table.best[s][p].cost))
          set.problems[p].best_known = table.best[s][p].cost;
      }
      keep_best_known(set);
    }
  }

  print_tables(table, groups, arguments.json, out);
  if (table.cancelled) {
    std::cerr << "prospect: cancelled; " << count(table.sets) << " of " << count(sets)
              << " problems are in " << out << "; --resume goes on\n";
    return kCancelled;
  }
  return end_of(table, arguments.publish);
}

}  // namespace

Command bench_command(CLI::App& program) {
  const auto given = std::make_shared<BenchArguments>();
  BenchArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "bench", "Whole sets of problems by several back ends: who solves what, and how fast");
  command
      ->add_option(
          "set", arguments.sets,
          "Built-in set (see `prospect list sets`), folder of problem files, "
          "problem file, .nl, file of problems as expressions (.json) [all built-in sets]; "
          "or `merge` or `compare` and the folders of benches")
      ->type_name("SET");
  add_configuration(command, arguments.configuration, " of the missions of the set missions");
  command
      ->add_option("--solver", arguments.solvers,
                   "Back ends, separated by commas; NAME,OPTION=VALUE sets an option of one")
      ->type_name("SOLVER")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--deadline", arguments.deadlines,
                   "Limits of a solve [s], separated by commas; 0: none [0.1,1; with --quick 0.1]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_within(0.0, 3600.0));
  add_clock(command, arguments.clock);
  command->add_option("--repeat", arguments.repeats, "How often each solve is made [3; 1]")
      ->check(whole_number_within(1, 1000));
  command->add_option("--max-evaluations", arguments.max_evaluations, "Of each solve")
      ->check(whole_number_within(1, 100000000))
      ->capture_default_str();
  command
      ->add_option("--tolerance", arguments.tolerance,
                   "Share of the best known cost within which a problem is solved")
      ->check(number_within(1e-9, 1.0))
      ->capture_default_str();
  command
      ->add_option(
          "--seed", arguments.seeds,
          "Of the back ends; several, separated by commas: each problem once with each [1]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(whole_number_within(0, std::numeric_limits<int>::max()));
  command
      ->add_option("--out", arguments.out,
                   "Folder of the results: bench.html, bench.csv and others [runs/bench]")
      ->type_name("DIR");
  command
      ->add_option("--capture", arguments.capture,
                   "Write the problems of the set missions to this new folder, as a set")
      ->type_name("DIR");
  command->add_flag("--quick", arguments.quick,
                    "A share of each built-in set, few back ends: less than a minute");
  command->add_flag("--publish", arguments.publish,
                    "Fail if other work kept the solves waiting, so that no such times get out");
  command->add_flag("--keep-best", arguments.keep_best,
                    "Keep the best costs found in best_known.json of the set's folder");
  command->add_flag("--resume", arguments.resume,
                    "Go on with the bench in that folder: what it holds is not solved again");
  command->add_flag("--overwrite", arguments.overwrite,
                    "Write over the bench in that folder: what it holds is lost");
  command->add_flag("--json", arguments.json, "Print JSON");
  command->add_flag("--quiet", arguments.quiet, "No progress line");
  return {command,
          [given](const Invocation& in) { return bench(*given, in.registries, in.signals); }};
}

}  // namespace prospect
