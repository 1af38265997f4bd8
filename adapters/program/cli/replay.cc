// SPDX-License-Identifier: Apache-2.0

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "adapters/formats/files/child_process.h"
#include "adapters/formats/files/content_hash.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/formats/files/whole_file.h"
#include "adapters/formats/worlds/world_hash.h"
#include "adapters/missions/config/recorded_configuration.h"
#include "adapters/missions/replay/drive_replay.h"
#include "adapters/missions/replay/replay_page.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/program/cli/absent_solver.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"
#include "adapters/program/cli/told_world.h"
#include "models/range_text.h"

namespace prospect {
namespace {

struct ReplayArguments {
  static constexpr int kToTheEnd = 2147483647;
  std::string run;               ///< folder, or the log of a mission
  ConfigurationArguments other;  ///< keys of the planner, above what was recorded
  std::string world;             ///< empty: as recorded
  int from = 0, to = kToTheEnd;  ///< planning steps
  std::string out;               ///< folder; empty: RUN/replay
  bool quiet = false;
  std::vector<std::string> plugins;  ///< files, as given
  std::vector<std::string> program;  ///< words that start this program anew
};

namespace fs = std::filesystem;

/// A folder of its own for a mission that is driven again, gone with this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "prospect_replay_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw InputError(name + ": cannot be created; expected a folder for temporary files");
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string file(const std::string& name) const { return (fs::path(path_) / name).string(); }

 private:
  std::string path_;
};

/// The world of a run: as it was then, or refused.
std::shared_ptr<const World> world_of(const RecordedRun& run, const std::string& source,
                                      const Configuration& configuration, Progress& progress) {
  std::shared_ptr<const World> world =
      told_world(source, configuration, ConfigurationUse::kAny, progress);
  const std::string hash = hash_text(world_hash(*world));
  if (!run.world_hash.empty() && run.world_hash != hash) {
    throw InputError(source + ": holds another world than that of " + run.source +
                     "; expected the same (--world FILE says where it is)");
  }
  return world;
}

/// The whole mission once more, by a process of its own, as explore drives it.
int replay_unchanged(const RecordedRun& run, const Configuration& recorded,
                     const std::string& world, const ReplayArguments& arguments, Progress& progress,
                     SignalGuard& signals) {
  signals.note();
  const TemporaryFolder folder;
  const std::string configuration = folder.file("config.yaml"), out = folder.file("run"),
                    log = folder.file("log.txt");
  const std::string wrong =
      write_whole_file(configuration, recorded_yaml(recorded, ConfigurationUse::kExplore));
  if (!wrong.empty()) fail(configuration, "cannot be written (" + wrong + "); expected room");
  std::vector<std::string> words = arguments.program;
  words.insert(words.end(), {"explore", world, "--config", configuration, "--seed",
                             std::to_string(run.seed), "--out", out, "--quiet"});
  if (run.log) words.push_back("--mcap");
  for (const std::string& plugin : arguments.plugins)
    words.insert(words.end(), {"--plugin", plugin});
  const std::function<bool()> cancelled = signals.came();
  ChildProcess process(words, {.errors = log});
  std::optional<ChildProcess::End> end;
  while (!(end = process.ended())) {
    if (cancelled()) return kCancelled;
    progress.show(run.source + ": driven again");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  progress.finish();
  if (end->code == kCancelled) return kCancelled;
  std::error_code error;
  if (end->signal != 0 || end->code > 1 || !fs::is_regular_file(out + "/summary.json", error)) {
    std::ifstream said(log);
    std::cerr << said.rdbuf();
    std::cerr << "prospect: " << run.source << ": could not be driven again\n";
    return end->signal == 0 && end->code > 1 ? end->code : kFailed;
  }
  RecordedRun now;
  if (run.log) {
    const LogRows rows = rows_of_log(out + "/mission.mcap", {});
    now.header = rows.header;
    now.rows = rows.rows;
  } else {
    now = read_recorded_run(out, {});
  }
  // A mission that was broken off is compared as far as it went.
  if (!run.whole && now.rows.size() > run.rows.size()) now.rows.resize(run.rows.size());
  const RunDifference difference = first_difference(run, now.header, now.rows);
  if (difference.step >= 0) {
    std::printf("%s: step %d differs: %s\n", run.source.c_str(), difference.step,
                difference.what.c_str());
    return kFailed;
  }
  std::printf("%s: %zu steps, the same bits%s\n", run.source.c_str(), run.rows.size(),
              run.whole ? "" : "; the mission was broken off there");
  return kDone;
}

/// What the run was driven with, and `settings` on top.
Configuration configuration_of(const RecordedRun& run, const Registries& registries,
                               const std::vector<YamlSetting>& settings = {}) {
  std::vector<YamlSetting> all = settings_before_their_keys();
  all.insert(all.end(), settings.begin(), settings.end());
  return configuration_from_text(run.configuration, run.source + ": configuration", registries,
                                 all);
}

Configuration other_configuration(const RecordedRun& run, const ReplayArguments& arguments,
                                  const Registries& registries) {
  const std::vector<YamlSetting> settings = arguments.other.settings();
  for (const YamlSetting& setting : settings) {
    if (!setting.assignment.starts_with("planner.")) {
      throw InputError("--set " + setting.assignment +
                       ": is not of the planner; expected planner.KEY=VALUE: world, robot and "
                       "sensors of a replay are those recorded");
    }
  }
  Configuration other = configuration_of(run, registries, settings);
  // What was recorded is nobody's to mend.
  std::erase_if(other.notices, [](const auto& notice) { return !notice.starts_with("--set "); });
  tell_notices(other.notices);
  return other;
}

/// Where table and page go.
OutputFolder replay_folder(const RecordedRun& run, const ReplayArguments& arguments) {
  const fs::path out = !arguments.out.empty() ? fs::path(arguments.out)
                       : run.log              ? fs::path(run.source).parent_path() / "replay"
                                              : fs::path(run.source) / "replay";
  OutputFolder folder = OutputFolder::shared(out.string(), {"replay"});
  folder.claim_all({"replay.csv", "replay.html"});
  return folder;
}

/// Table and page of what was planned anew.
void write_replay(const RecordedRun& run, const Replay& replay, const ReplayArguments& arguments,
                  OutputFolder& folder) {
  std::string changed;
  for (const YamlSetting& setting : arguments.other.settings()) {
    changed += (changed.empty() ? "" : ", ") + setting.assignment;
  }
  if (changed.empty()) changed = "nothing changed";
  const auto write = [&](const char* name, const std::string& content) {
    const std::string file = (fs::path(folder.path()) / name).string();
    const std::string wrong = folder.write(name, content);
    if (!wrong.empty()) fail(file, "cannot be written (" + wrong + "); expected a writable folder");
    std::printf("%s\n", file.c_str());
  };
  write("replay.csv", replay_csv(replay));
  write("replay.html", replay_page(replay, run.world + ", seed " + std::to_string(run.seed),
                                   "recorded", "other", changed));
  std::printf("%zu steps planned anew with %s: open loop, along the recorded beliefs\n",
              replay.steps.size(), changed.c_str());
}

int replay_changed(const RecordedRun& run, const std::string& source,
                   const ReplayArguments& arguments, const Invocation& in, Progress& progress) {
  const Registries& registries = in.registries;
  const Configuration configuration = configuration_of(run, registries);
  const Configuration other = other_configuration(run, arguments, registries);
  for (const Configuration* c : {&configuration, &other}) {
    if (tell_if_absent(c->solver, registries.solvers)) return kNotBuiltIn;
  }
  const std::shared_ptr<const World> world = world_of(run, source, configuration, progress);
  in.signals.note();
  OutputFolder folder = replay_folder(run, arguments);
  ReplayOptions options;
  options.from = arguments.from;
  options.to = arguments.to;
  options.solvers = &registries.solvers;
  options.cancelled = in.signals.came();
  options.progress = [&](const StepRecord& step) { progress.show(step, other.solver); };
  const Replay replay = replay_beside(run, world, configuration, other, options);
  progress.finish();
  if (options.cancelled()) return kCancelled;
  write_replay(run, replay, arguments, folder);
  if (replay.difference.step >= 0) {
    std::printf("%s: step %d differs: %s; not replayed from there on\n", run.source.c_str(),
                replay.difference.step, replay.difference.what.c_str());
    return kFailed;
  }
  return kDone;
}

/// A run in real time: its planner's calls once more, as recorded, and by another planner.
int replay_drive(const RecordedRun& run, bool unchanged, const ReplayArguments& arguments,
                 const Invocation& in, Progress& progress) {
  const Registries& registries = in.registries;
  if (!arguments.world.empty()) {
    throw InputError("--world: a run in real time is not driven again; expected none");
  }
  const Configuration configuration = other_configuration(run, arguments, registries);
  if (tell_if_absent(configuration.solver, registries.solvers)) return kNotBuiltIn;
  if (unchanged && configuration.planner.deadline > 0.0) {
    throw InputError(run.source + ": planned within planner.deadline, " +
                     exact_text(configuration.planner.deadline) +
                     " s, so its plans rest on the clock; expected what to plan anew with, such as "
                     "--set planner.deadline=0");
  }
  in.signals.note();
  std::optional<OutputFolder> folder;
  if (!unchanged) folder = replay_folder(run, arguments);
  ReplayOptions options;
  options.from = arguments.from;
  options.to = arguments.to;
  options.cancelled = in.signals.came();
  options.progress = [&](const StepRecord& step) { progress.show(step, configuration.solver); };
  const DriveReplay made = replay_calls(run, configuration, registries, options);
  progress.finish();
  for (const std::string& note : made.notes) std::cerr << "prospect: " << note << '\n';
  if (options.cancelled()) return kCancelled;
  if (!unchanged) {
    write_replay(run, made.replay, arguments, *folder);
  } else if (made.difference.step >= 0) {
    std::printf("%s: step %d differs: %s\n", run.source.c_str(), made.difference.step,
                made.difference.what.c_str());
  } else {
    std::printf("%s: %d plans from the recorded beliefs, the same bits\n", run.source.c_str(),
                made.plans);
  }
  if (!made.missing.empty()) {
    std::printf("%s: %s, is not in the log: %d of %d plans were made again\n", run.source.c_str(),
                made.missing.c_str(), made.plans, made.steps);
  }
  const bool differs = unchanged && made.difference.step >= 0;
  return differs || !made.missing.empty() ? kFailed : kDone;
}

int replay(const ReplayArguments& arguments, const Invocation& in) {
  if (arguments.from > arguments.to) {
    throw InputError("--from, --to: " + std::to_string(arguments.from) + " comes after " +
                     std::to_string(arguments.to) + "; expected the first step, then the last");
  }
  Progress progress(arguments.quiet);
  progress.show("reading " + arguments.run);
  const RecordedRun run = read_recorded_run(arguments.run, in.registries);
  progress.finish();
  const std::string world = arguments.world.empty() ? run.world_source : arguments.world;
  const bool unchanged =
      arguments.other.empty() && arguments.from == 0 && arguments.to == ReplayArguments::kToTheEnd;
  if (run.real_time) return replay_drive(run, unchanged, arguments, in, progress);
  if (!unchanged) return replay_changed(run, world, arguments, in, progress);
  const Configuration configuration = configuration_of(run, in.registries);
  if (tell_if_absent(configuration.solver, in.registries.solvers)) return kNotBuiltIn;
  world_of(run, world, configuration, progress);
  return replay_unchanged(run, configuration, world, arguments, progress, in.signals);
}

}  // namespace

Command replay_command(CLI::App& program) {
  const auto given = std::make_shared<ReplayArguments>();
  ReplayArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "replay", "A recorded mission again, bit for bit; or other plans along its beliefs");
  command->add_option("run", arguments.run, "Folder of a run, or the log of a mission (.mcap)")
      ->type_name("FILE")
      ->required();
  add_set(command, arguments.other);
  add_key(command, arguments.other, {"--solver", "planner.solver", "SOLVER"});
  command->add_option("--from", arguments.from, "First planning step that is reported [0]")
      ->check(whole_number_within(0, 1000000000));
  command->add_option("--to", arguments.to, "The last one, where the mission is ended [its end]")
      ->check(whole_number_within(0, 1000000000));
  command->add_option("--world", arguments.world, "Where the world of the run is [as recorded]")
      ->type_name("WORLD");
  command
      ->add_option("--out", arguments.out, "Folder for table and page [replay in that of the run]")
      ->type_name("DIR");
  command->add_flag("--quiet", arguments.quiet, "No progress line");
  return {command, [given](const Invocation& in) {
            given->plugins = in.plugins;
            given->program = in.program;
            return replay(*given, in);
          }};
}

}  // namespace prospect
