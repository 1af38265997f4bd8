// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/content_hash.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/missions/study/study_files.h"
#include "adapters/missions/study/study_run.h"
#include "adapters/program/cli/absent_solver.h"
#include "adapters/program/cli/build_info.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"

namespace prospect {
namespace {

struct StudyArguments {
  std::string file;  ///< study (YAML)
  std::string out;   ///< folder; empty: runs/NAME
  int jobs = 1;
  std::string shard = "1/1";
  bool dry_run = false;
  bool retry_failed = false;
  bool gather = false;
  bool steps = false;        ///< with gather: steps.h5, too
  bool any_version = false;  ///< with gather: other versions' missions for what is missing
  std::vector<std::string> formats = StudyGathering().formats;  ///< with gather: of figures
  bool quiet = false;
  std::vector<std::string> plugins;  ///< files, as given
  std::vector<std::string> program;  ///< words that start this program anew
};

StudyShard shard_of(const std::string& text) {
  StudyShard shard;
  const std::size_t slash = text.find('/');
  const bool sound = slash != std::string::npos &&
                     parse_number(std::string_view(text).substr(0, slash), shard.number) &&
                     parse_number(std::string_view(text).substr(slash + 1), shard.of) &&
                     shard.of >= 1 && shard.number >= 1 && shard.number <= shard.of;
  if (!sound) {
    throw InputError("--shard: '" + text + "'; expected I/N, I from 1 to N, such as 3/8");
  }
  return shard;
}

/// What cells depend on besides configuration, input and seed.
std::string program_of(const BuildInfo& build, const std::vector<std::string>& plugins) {
  std::string program =
      build.version + ' ' + build.commit + (build.commit_changed ? " changed" : "");
  for (const std::string& plugin : plugins) {
    program += ' ' + hash_text(file_hash(plugin));
  }
  return program;
}

/// "1.5 h", "20 min", "45 s".
std::string expected_text(double seconds) {
  char text[64];
  if (!std::isfinite(seconds)) return "unknown";
  if (seconds < 90.0) {
    std::snprintf(text, sizeof text, "%.0f s", seconds);
  } else if (seconds < 5400.0) {
    std::snprintf(text, sizeof text, "%.0f min", seconds / 60.0);
  } else {
    std::snprintf(text, sizeof text, "%.1f h", seconds / 3600.0);
  }
  return text;
}

/// "office, seed 3, without".
std::string cell_text(const StudyPlan& plan, const StudyCell& cell) {
  return plan.study.inputs[cell.input].name + ", seed " + std::to_string(cell.seed) + ", " +
         plan.label(plan.setup(cell));
}

int print_dry_run(const StudyPlan& plan, const CellStore& store, const StudyShard& shard,
                  int jobs) {
  ExpectedTimes times(plan);
  std::map<std::string, CellRecord> records;
  for (const std::string& id : cells_of(plan, {})) {
    const CellRecord& record = records[id] = store.record(id);
    if (record.status == CellRecord::Status::kDone) times.add(id, record.wall_s);
  }
  const std::vector<std::string> own = cells_of(plan, shard);
  const std::set<std::string> ids(own.begin(), own.end());
  std::set<std::string> told;
  std::size_t missing = 0, failed = 0;
  double left = 0.0;
  for (const StudyCell& cell : plan.cells) {
    if (!ids.count(cell.id) || !told.insert(cell.id).second) continue;
    const CellRecord& record = records[cell.id];
    std::printf("%s  %-7s  %s\n", cell.id.c_str(), to_string(record.status).c_str(),
                cell_text(plan, cell).c_str());
    failed += record.status == CellRecord::Status::kFailed;
    if (record.status != CellRecord::Status::kMissing) continue;
    ++missing;
    left += times.of(cell.id);
  }
  std::printf("%zu cells: %zu done, %zu failed, %zu to run; expected time %s with %d job%s\n",
              ids.size(), ids.size() - missing - failed, failed, missing,
              missing == 0 ? "0 s" : expected_text(left / jobs).c_str(), jobs,
              jobs == 1 ? "" : "s");
  return kDone;
}

int gather(const StudyPlan& plan, const CellStore& store, const Registries& registries,
           const StudyGathering& gathering) {
  const StudyFiles written = write_study(plan, store, registries, gathering);
  for (const std::string& file : written.files) std::printf("%s\n", file.c_str());
  std::printf("%zu %s, %zu failed, %zu missing", written.done,
              plan.study.kind == Study::Kind::kBenches ? "solves" : "runs", written.failed,
              written.missing);
  if (written.of_other_versions > 0) {
    std::printf(", %zu by other versions", written.of_other_versions);
  }
  std::printf("\n");
  return written.failed == 0 && written.missing == 0 ? kDone : kFailed;
}

int study(const StudyArguments& arguments, const Registries& registries, SignalGuard& signals) {
  const StudyShard shard = shard_of(arguments.shard);
  const Study read = read_study(arguments.file);
  const BuildInfo build = build_info();
  Progress progress(arguments.quiet);
  const StudyPlan plan = plan_study(read, registries, program_of(build, arguments.plugins),
                                    [&](const std::string& what) { progress.show(what); });
  progress.finish();
  std::vector<std::string> notices;
  for (const StudySetup& setup : plan.setups) {
    const std::vector<std::string>& told = setup.configuration.notices;
    notices.insert(notices.end(), told.begin(), told.end());
  }
  tell_notices(std::move(notices));
  for (const StudySetup& setup : plan.setups) {
    if (tell_if_absent(plan.solver(setup), registries.solvers)) return kNotBuiltIn;
  }
  const std::string folder =
      arguments.out.empty() ? (std::filesystem::path("runs") / read.name).string() : arguments.out;
  if (arguments.gather && !std::filesystem::is_directory(folder)) {
    throw InputError(folder + ": no such folder; expected that of a study (--out)");
  }
  if (arguments.dry_run) {
    return print_dry_run(plan, CellStore::existing(folder, read.kind), shard, arguments.jobs);
  }
  if (build.commit_changed) {
    std::cerr << "prospect: built from files that differ from the commit: cells of other such "
                 "builds count as the same\n";
  }
  if (!arguments.gather) signals.note();  // what is gathered is there the next time, too
  const CellStore store(folder, read.kind);
  if (arguments.gather) {
    return gather(plan, store, registries,
                  {arguments.steps, arguments.any_version, arguments.formats});
  }
  StudyRunOptions options;
  options.shard = shard;
  options.jobs = arguments.jobs;
  options.retry_failed = arguments.retry_failed;
  options.program = arguments.program;
  options.plugins = arguments.plugins;
  options.version = build.version + (build.commit.empty() ? "" : "+" + build.commit.substr(0, 12)) +
                    (build.commit_changed ? "-changed" : "");
  options.cancelled = signals.came();
  options.progress = [&](const StudyProgress& p) {
    progress.show(read.name + ": " + std::to_string(p.done + p.failed) + " of " +
                  std::to_string(p.cells) + " cells" +
                  (p.failed > 0 ? ", " + std::to_string(p.failed) + " failed" : "") + ", " +
                  std::to_string(p.running) + " running, " + expected_text(p.left_s) + " left");
  };
  options.ended = [&](const StudyCell& cell, const CellRecord& record) {
    if (record.status != CellRecord::Status::kFailed) return;
    progress.finish();
    std::cerr << "prospect: " << cell_text(plan, cell) << ": failed: " << record.why << " ("
              << store.path(cell.id, ".log") << ")\n";
  };
  const StudyRunResult result = run_study(plan, store, options);
  progress.finish();
  std::printf("%s: %zu cells: %zu there before, %zu run, %zu failed", folder.c_str(), result.cells,
              result.there, result.ran, result.failed);
  const std::size_t left =
      result.cells - result.there - result.ran - result.failed - result.elsewhere;
  if (result.elsewhere > 0) std::printf(", %zu run by another process", result.elsewhere);
  if (left > 0) std::printf(", %zu left", left);
  std::printf("\n");
  if (!result.stopped.empty()) {
    std::cerr << "prospect: stopped: " << result.stopped << '\n';
  } else if (result.cancelled || left > 0) {
    std::cerr << "prospect: broken off; the same command goes on\n";
  }
  if (result.cancelled) return kCancelled;
  const bool whole = result.failed == 0 && result.elsewhere == 0 && left == 0;
  return whole ? kDone : kFailed;
}

}  // namespace

Command study_command(CLI::App& program) {
  const auto given = std::make_shared<StudyArguments>();
  StudyArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "study", "Missions, or solves of problems, over conditions and a grid of values, in pairs");
  command->add_option("study", arguments.file, "Study file (YAML)")->type_name("FILE")->required();
  command
      ->add_option("--out", arguments.out,
                   "Folder of the study; what it holds is not run again [runs/NAME]")
      ->type_name("DIR");
  command->add_option("--jobs", arguments.jobs, "Cells at a time")
      ->check(whole_number_within(1, 4096))
      ->capture_default_str();
  command
      ->add_option("--shard", arguments.shard,
                   "Only the I-th of N parts of the cells, for one of N workers: I/N")
      ->type_name("I/N")
      ->capture_default_str();
  command->add_flag("--dry-run", arguments.dry_run, "Say what would be run, and how long it takes");
  command->add_flag("--retry-failed", arguments.retry_failed, "Run cells again that failed");
  CLI::Option* gather =
      command->add_flag("--gather", arguments.gather,
                        "Run nothing: results.csv, study.html and figures of what is there");
  command
      ->add_flag("--any-version", arguments.any_version,
                 "With --gather: what this version has not run is taken from the newest run of the "
                 "same mission by another one")
      ->needs(gather);
  command
      ->add_flag("--steps", arguments.steps,
                 "With --gather: steps.h5, too, with every column of every run")
      ->needs(gather);
  add_figure_formats(command, arguments.formats)->needs(gather);
  command->add_flag("--quiet", arguments.quiet, "No progress line");
  return {command, [given](const Invocation& in) {
            given->plugins = in.plugins;
            given->program = in.program;
            return study(*given, in.registries, in.signals);
          }};
}

}  // namespace prospect
