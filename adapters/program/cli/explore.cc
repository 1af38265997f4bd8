// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/explore.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/formats/files/content_hash.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/formats/worlds/world_hash.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/log/mission_log.h"
#include "adapters/missions/run/configured_record.h"
#include "adapters/missions/run/dds_run.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/missions/run/gazebo_run.h"
#include "adapters/missions/run/planned_problem.h"
#include "adapters/missions/run/run_folder.h"
#include "adapters/missions/run/user_run.h"
#include "adapters/program/cli/absent_solver.h"
#include "adapters/program/cli/build_info.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"
#include "adapters/program/cli/shell_words.h"
#include "adapters/program/cli/told_world.h"
#include "adapters/robots/gazebo/gazebo_robot_model.h"
#include "adapters/robots/gazebo/master_uri.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/views/live/live_server.h"
#include "adapters/views/report/progress_line.h"
#include "adapters/views/report/report.h"
#include "engine/task/task.h"
#include "runtime/clock.h"
#include "runtime/mission.h"

namespace prospect {
namespace {

/// "nlopt:LD_SLSQP" -> "nlopt-LD_SLSQP": fit for a folder's name.
std::string file_name(std::string text) {
  for (char& c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       c == '_' || c == '.' || c == '-';
    if (!plain) c = '-';
  }
  return text;
}

int exit_code(Outcome outcome) {
  switch (outcome) {
    case Outcome::kDone:
      return kDone;
    case Outcome::kCancelled:
      return kCancelled;
    case Outcome::kNotDone:
    case Outcome::kFailed:
      break;
  }
  return kFailed;
}

/// With that many decimals; "-" where there is no number.
std::string decimals(double value, int places) {
  if (!std::isfinite(value)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", places, value);
  return text;
}
std::string tenths(double value) { return decimals(value, 1); }

void print_summary(const Summary& s) {
  std::printf("%s, seed %llu, %s: %s\n", s.world.c_str(), static_cast<unsigned long long>(s.seed),
              s.solver.c_str(), to_string(s.end).data());
  std::printf("  task          %s, %s: %s\n", s.task.c_str(), s.done ? "done" : "not done",
              s.detail.c_str());
  if (s.measured) {
    std::printf("  coverage      %6s %% of %.1f m2 reachable\n", tenths(100.0 * s.coverage).c_str(),
                s.reachable_area_m2);
  }
  if (s.too_long_for_m2 > 0.0) {
    std::printf("  left out      %6.1f m2 that its length keeps the robot from\n",
                s.too_long_for_m2);
  }
  if (std::isfinite(s.floor_share)) {
    std::printf("  floor         %6s %% of the ground in the file is at this height\n",
                tenths(100.0 * s.floor_share).c_str());
  }
  if (!s.read_without.empty()) std::printf("  read without  %s\n", s.read_without.c_str());
  if (s.measured) {
    std::printf("  time          %6.1f s; to 90 / 95 / 99 %%: %s / %s / %s s\n", s.duration_s,
                tenths(s.time_to_90_s).c_str(), tenths(s.time_to_95_s).c_str(),
                tenths(s.time_to_99_s).c_str());
    std::printf("  path          %6.1f m\n", s.path_length_m);
    std::printf("  collisions    %6d    losses of localization %d\n", s.collisions, s.losses);
    std::printf("  localization  %6s m final, %s m RMS, %s %% of the path\n",
                decimals(s.localization_final_m, 3).c_str(),
                decimals(s.localization_rmse_m, 3).c_str(), decimals(s.drift_percent, 2).c_str());
  } else {
    std::printf("  time          %6.1f s\n", s.duration_s);
    std::printf("  path          %6.1f m, as estimated\n", s.path_length_m);
    std::printf("  not measured  area, collisions, error; losses of localization %d\n", s.losses);
  }
  std::printf("  planning      %6s ms p50, %s p95, %s max; %d steps, %d fallbacks\n",
              tenths(s.plan_ms_p50).c_str(), tenths(s.plan_ms_p95).c_str(),
              tenths(s.plan_ms_max).c_str(), s.steps, s.fallbacks);
  std::printf("  wall clock    %6.1f s, %s times faster than real time\n", s.wall_s,
              tenths(s.duration_s / s.wall_s).c_str());
}

/// Where it is, if it could be written.
void print_file(const char* what, const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) {
    std::printf("  %-13s %s\n", what, path.c_str());
  }
}

void print_driver(const ExplorationRunResult& result) {
  const DriverStatus& driver = *result.driver;
  std::printf("before the first motion\n%s", to_text(result.preflight).c_str());
  std::printf("in real time\n  commands      %d late plans, %d guard stops\n%s", driver.late_plans,
              driver.guard_stops, to_text(*result.health).c_str());
  if (result.faults_start) {
    std::printf("  faults        their times count from %.3f s\n", *result.faults_start);
  }
  if (result.real_time_factor) {
    std::printf("  simulated     %.2f s a second\n", *result.real_time_factor);
  }
}

/// What was more than part of ordinary work.
void tell_events(const std::vector<Event>& events) {
  for (const Event& event : events) {
    if (event.severity != Severity::kInfo) std::cerr << "prospect: " << to_text(event) << '\n';
  }
}

RunStart start_of(const ExploreArguments& arguments, const Configuration& configuration,
                  const std::string& name, const World* world, const MissionBase& base) {
  const BuildInfo build = build_info();
  RunStart start;
  start.world = name;
  if (world) {
    start.world_source = arguments.world;
    start.world_hash = hash_text(world_hash(*world));
  }
  start.solver = configuration.solver;
  start.seed = arguments.seed;
  start.real_time = base.in_real_time();
  start.command_line = arguments.command_line;
  start.version = build.version;
  start.commit = build.commit;
  start.commit_changed = build.commit_changed;
  start.started = utc_now();
  start.configuration = effective_yaml(configuration.entries);
  return start;
}

/// What a mission's messages are made with. In real time their stamps are times of day, or
/// Gazebo's; in lockstep they are the robot's clock.
MissionMessageOptions message_options(const Configuration& configuration, const MissionBase& base) {
  MissionMessageOptions options;
  options.robot = configuration.robot;
  const CameraRigOptions& rig = configuration.simulator.camera.rig;
  if (base.gazebo) {
    options.depth_cameras = gazebo_depth_cameras(configuration.robot, configuration.gazebo);
  } else {
    int number = 0;
    for (const DepthSensor& sensor : configuration.robot.depth_sensors()) {
      const PinholeCamera camera =
          depth_camera(sensor.footprint, rig.depth_width, rig.depth_height);
      if (is_rendered(sensor.footprint)) options.depth_cameras[number] = camera;
      ++number;
    }
  }
  options.resolution = configuration.perception.mapping.resolution;
  options.dt = configuration.planner.dt;
  if (base.in_real_time() && !base.gazebo) {
    using std::chrono::duration_cast;
    const auto day = std::chrono::system_clock::now().time_since_epoch();
    options.start = SteadyClock().now();
    options.epoch =
        duration_cast<std::chrono::nanoseconds>(day).count() - std::llround(1e9 * options.start);
  }
  return options;
}

/// Where the live view is, and who may reach it, on standard error.
void tell_live(const LiveServer& live, const ExploreArguments& arguments) {
  std::cerr << "prospect: live view: " << live.url() << '\n';
  const std::string& host = arguments.live_host;
  if (host != "localhost" && host != "::1" && !host.starts_with("127.")) {
    std::cerr << "prospect: live view: on " << host
              << ", not encrypted: whoever reaches it can watch, and read the token of who "
                 "commands\n";
  }
}

/// Shows each step in the progress line.
class ShownProgress final : public RunObserver {
 public:
  ShownProgress(Progress& progress, const std::string& solver)
      : progress_(progress), solver_(solver) {}
  void on_record(const StepRecord& record, const MissionStep&) override {
    progress_.show(record, solver_);
  }

 private:
  Progress& progress_;
  const std::string& solver_;
};

/// Writes the problem of every so manyeth step into the run folder.
class SavedProblems final : public RunObserver {
 public:
  SavedProblems(RunFolder& folder, int every, std::string world, std::uint64_t seed)
      : folder_(folder), every_(every), world_(std::move(world)), seed_(seed) {}
  void on_record(const StepRecord&, const MissionStep& step) override {
    if (step.index % every_ != 0) return;
    if (const auto saved = planned_problem(step, world_, seed_)) folder_.add(*saved);
  }

 private:
  RunFolder& folder_;
  const int every_;
  const std::string world_;
  const std::uint64_t seed_;
};

ConfigurationUse use_of(const MissionBase& base) {
  if (base.gazebo) return ConfigurationUse::kDriveGazebo;
  if (base.dds) return ConfigurationUse::kDriveDds;
  if (base.user) return ConfigurationUse::kDriveUser;
  return base.real_time ? ConfigurationUse::kDriveSimulator : ConfigurationUse::kExplore;
}

/// Where Gazebo's master is, as $GAZEBO_MASTER_URI says.
std::vector<YamlSetting> gazebo_environment() {
  const char* const uri = std::getenv("GAZEBO_MASTER_URI");
  if (uri == nullptr || *uri == '\0') return {};
  const GazeboAddress address = with_master_uri({}, uri);
  std::vector<YamlSetting> settings = {"gazebo.host=" + yaml_text(address.host),
                                       "gazebo.port=" + std::to_string(address.port)};
  for (YamlSetting& setting : settings) {
    setting.where = std::string("GAZEBO_MASTER_URI ") + uri;
    setting.unless_told = true;
  }
  return settings;
}

Configuration configuration_of(const ExploreArguments& arguments, const Registries& registries,
                               const MissionBase& base) {
  std::vector<YamlSetting> settings;
  if (base.gazebo) settings = gazebo_environment();
  if (base.user) {
    for (const std::string& told : base.user->settings) {
      settings.emplace_back(told, "the robot '" + base.user->name + "': " + told);
    }
  }
  return read_told(arguments.configuration, registries, use_of(base), std::move(settings));
}

/// What has come of a mission; the files that were written are those of `folder`.
void tell_result(const ExploreArguments& arguments, const ExplorationRunResult& result,
                 const std::string& folder) {
  if (!result.complaint.empty()) std::cerr << "prospect: sensors: " << result.complaint << '\n';
  tell_events(result.events);

  const Summary& summary = result.record.summary;
  if (arguments.json) {
    std::cout << summary_json(summary);
  } else {
    print_summary(summary);
    if (result.driver) print_driver(result);
    print_file("report", folder + "/report.html");
    if (arguments.log) print_file("log", folder + "/mission.mcap");
  }
}

/// Who reads keys of the configuration: this base, with what it has.
KeyReader reader_of(const Configuration& configuration, const MissionBase& base) {
  KeyReader reader = key_reader(configuration, use_of(base));
  reader.world = base.knows_world();
  if (base.dds) {
    reader.depth = !base.dds->depth.image.empty();
    reader.scans = !base.dds->scan.empty() || !base.dds->point_cloud.empty();
    for (const DdsOptions::MoreDepth& more : base.dds->more_depth) {
      if (more.depth.image.empty()) {
        reader.scans = true;
      } else {
        reader.depth = true;
      }
    }
    reader.view_told = base.dds->tells_view();
    reader.pairs = base.dds->has_stereo();
    reader.poses = base.dds->is_told_its_pose();
    reader.by_wheels = !reader.pairs && !reader.poses;
  } else if (base.user) {
    const std::vector<SensorStream>& streams = base.user->streams;
    const auto has = [&](SensorStream stream) {
      return std::find(streams.begin(), streams.end(), stream) != streams.end();
    };
    const std::size_t images = base.user->more_depth.size();
    reader.depth = has(SensorStream::kDepth) || images > 0;
    reader.scans = has(SensorStream::kScan) || configuration.robot.more_depth.size() > images;
    reader.pairs = has(SensorStream::kPair);
    reader.by_wheels = !reader.pairs && has(SensorStream::kWheels) && !has(SensorStream::kPose);
    reader.poses = !reader.pairs && !reader.by_wheels;
  }
  return reader;
}

ExplorationRunResult run_on(const MissionBase& base, const Configuration& configuration,
                            const std::shared_ptr<const World>& world,
                            const ExplorationRunOptions& options) {
  if (base.gazebo) return explore_gazebo(configuration, world, options);
  if (base.dds) return explore_dds(configuration, *base.dds, options);
  if (base.user) return explore_user(configuration, *base.user, options);
  return run_exploration(world, configuration, options);
}

/// Returns the exit code.
int tell_checks(const std::vector<CheckResult>& checks, bool json) {
  if (json) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const CheckResult& check : checks) {
      rows.push_back(
          {{"check", check.check}, {"verdict", to_string(check.verdict)}, {"why", check.why}});
    }
    std::cout << rows.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  } else {
    std::cout << to_text(checks);
  }
  const std::string failed = first_failed(checks);
  if (failed.empty()) return kDone;
  std::cerr << "prospect: not fit to drive: " << failed << '\n';
  return kFailed;
}

}  // namespace

int mission(const ExploreArguments& arguments, const Registries& registries,
            const MissionBase& base, SignalGuard& signals) {
  const Configuration configuration = configuration_of(arguments, registries, base);
  if (tell_if_absent(configuration.solver, registries.solvers)) return kNotBuiltIn;
  refuse_unread(configuration.entries, reader_of(configuration, base));
  Progress progress(arguments.quiet);
  std::shared_ptr<const World> world;
  if (base.knows_world()) {
    world = told_world(arguments.world, configuration, use_of(base), progress);
  }

  ExplorationRunOptions options;
  options.seed = arguments.seed;
  options.solvers = &registries.solvers;
  options.real_time = base.real_time;
  options.cancelled = signals.came();
  if (arguments.check) {
    options.checks_only = true;
    progress.show("looking at the robot");
    const std::vector<CheckResult> checks = run_on(base, configuration, world, options).preflight;
    progress.finish();
    return tell_checks(checks, arguments.json);
  }

  const std::string name = world       ? world->name
                           : base.dds  ? "dds"
                           : base.user ? base.user->name
                                       : "gazebo";
  const std::string out = arguments.out.empty()
                              ? "runs/" + file_name(name) + "_" + file_name(configuration.solver) +
                                    "_" + std::to_string(arguments.seed)
                              : arguments.out;
  std::optional<RunFolder> folder;
  // Not before: nothing is written for a refusal.
  std::optional<MissionLog> log;
  LiveFeed feed;
  DriveRequests requests;
  options.requests = &requests;
  std::optional<AcknowledgementBySignal> by_signal;
  if (base.in_real_time()) by_signal.emplace(requests);
  std::optional<LiveServer> live;
  ShownProgress shown_progress(progress, configuration.solver);
  std::optional<SavedProblems> problems;
  options.observers = [&](const Configuration& effective) {
    signals.note();  // from here on there is a run folder to end, and maybe a robot to stop
    if (arguments.live) {
      LiveMission shown{configured_record(effective), base.in_real_time(),
                        message_options(effective, base)};
      shown.start.summary.world = name;
      shown.start.summary.solver = effective.solver;
      shown.start.summary.seed = arguments.seed;
      live.emplace(
          LiveOptions{
              .port = *arguments.live, .host = arguments.live_host, .token = arguments.live_token},
          shown, feed, requests);
      tell_live(*live, arguments);
    }
    const RunStart start = start_of(arguments, effective, name, world.get(), base);
    folder.emplace(out, start,
                   arguments.overwrite ? RunFolder::EarlierDrive::kReplaced
                                       : RunFolder::EarlierDrive::kRefused);
    std::vector<RunObserver*> observers = {&*folder};
    if (arguments.log) {
      const std::string file = folder->claim("mission.mcap");
      // In real time nothing waits for the log; in lockstep nothing is dropped.
      const bool real_time = base.in_real_time();
      MissionLogOptions log_options{
          message_options(effective, base), arguments.log_images, real_time, {}};
      log_options.file.wait = !real_time || base.lockstep;
      log.emplace(file, start, log_options);
      if (const std::string wrong = log->error(); !wrong.empty()) {
        throw InputError(file + ": cannot be written (" + wrong + "); expected a writable folder");
      }
      observers.push_back(&*log);
    }
    if (live) observers.push_back(&feed);
    observers.push_back(&shown_progress);
    if (arguments.save_problems > 0) {
      problems.emplace(*folder, arguments.save_problems, name, arguments.seed);
      observers.push_back(&*problems);
    }
    return observers;
  };
  // Sensors of a mesh are made from pictures of all of it; others' robots are waited for.
  progress.show("making the robot ready in " + name);
  ExplorationRunResult result = run_on(base, configuration, world, options);
  if (world) {
    result.record.summary.read_without = world->left_out.text();
    result.record.summary.floor_share = world->floor_share;
  }
  progress.finish();
  if (live) feed.end(result.record.summary);
  folder->finish(result.record, result.map.get(), render_report);
  if (log) log->finish(result.record);
  if (!folder->error().empty()) std::cerr << "prospect: " << folder->error() << '\n';
  if (log) {
    for (const std::string& note : log->notes()) std::cerr << "prospect: " << note << '\n';
  }

  tell_result(arguments, result, folder->path());
  const bool whole = folder->error().empty() && (!log || log->error().empty());
  return whole ? exit_code(outcome(result.record.summary)) : kFailed;
}

namespace {

int explore(const ExploreArguments& arguments, const Invocation& in) {
  ExploreArguments logged = arguments;
  logged.log = arguments.log || arguments.log_images;
  return mission(logged, in.registries, {}, in.signals);
}

/// "--go 2,3.5": task.kind, task.goal, and no area of an exploration.
void add_go(CLI::App* command, ConfigurationArguments& arguments) {
  command
      ->add_option_function<std::vector<std::string>>(
          "--go",
          [&arguments](const std::vector<std::string>& words) {
            const std::string where = "--go " + joined(words, ",");
            arguments.spelled.emplace_back("task.kind=go", where);
            arguments.spelled.emplace_back("task.goal=[" + joined(words, ", ") + "]", where);
            arguments.spelled.emplace_back("task.area=~", where);
          },
          "Go to x [m],y [m], or x,y,yaw [deg], instead of exploring; keys task.kind, task.goal, "
          "task.area")
      ->type_name("NUMBER")
      ->delimiter(',')
      ->expected(2, 3)
      ->allow_extra_args(false);
}

/// "--until 0.95": mission.until.coverage; "--until 120m2": mission.until.area.
void add_until(CLI::App* command, ConfigurationArguments& arguments) {
  command->add_option_function<std::string>(
      "--until",
      [&arguments](const std::string& until) {
        const bool area = until.size() > 2 && until.ends_with("m2");
        const std::string value = area ? until.substr(0, until.size() - 2) : until;
        const std::string key = "mission.until.", where = "--until " + until;
        double number = 0.0;
        if (parse_number(value, number) && number == 0.0) {
          throw InputError(where + ": nothing is enough; expected more than 0");
        }
        arguments.spelled.emplace_back(key + (area ? "area=" : "coverage=") + value, where);
        arguments.spelled.emplace_back(key + (area ? "coverage" : "area") + "=~", where);
      },
      "What is enough: a share of the reachable area (0.95) or an area (120m2); keys "
      "mission.until.coverage, mission.until.area");
}

/// "--correct 20:3,0,30", again and again: simulator.corrections.
void add_correct(CLI::App* command, ConfigurationArguments& arguments) {
  command
      ->add_option_function<std::vector<std::string>>(
          "--correct",
          [&arguments](const std::vector<std::string>& corrections) {
            std::string list;
            for (const std::string& text : corrections) {
              const bool sound = std::count(text.begin(), text.end(), ':') == 1 &&
                                 text.find(':') < text.find(',') &&
                                 std::count(text.begin(), text.end(), ',') == 2;
              if (!sound) {
                throw InputError("--correct: '" + text +
                                 "'; expected T:X,Y,DEG, such as 20:3,0,30");
              }
              for (const char c : list.empty() ? text : ',' + text) {
                list += c == ':' || c == ',' ? ", " : std::string(1, c);
              }
            }
            arguments.spelled.emplace_back("simulator.corrections=[" + list + "]",
                                           "--correct " + joined(corrections, " "));
          },
          "Correct the map's frame at T s: what was at p is at p turned by DEG, moved by X, Y m; "
          "key simulator.corrections")
      ->type_name("T:X,Y,DEG")
      ->allow_extra_args(false);
}

}  // namespace

void add_check_option(CLI::App* command, ExploreArguments& arguments) {
  command->add_flag("--check", arguments.check,
                    "Make the checks before the first motion that need none, say what is seen, and "
                    "end; exit code 1 if one fails");
}

void add_fault_option(CLI::App* command, std::vector<std::string>& faults) {
  command
      ->add_option("--fault", faults,
                   "Break something of the robot: SOURCE:VERB, from FROM s on, for FOR s "
                   "(depth:off@10+2)")
      ->type_name("FAULT")
      ->allow_extra_args(false);
}

std::vector<InjectedFault> parsed_faults(const std::vector<std::string>& faults) {
  std::vector<InjectedFault> parsed;
  for (const std::string& text : faults) {
    try {
      parsed.push_back(parse_fault(text));
    } catch (const std::invalid_argument& e) {
      throw InputError(std::string("--fault: ") + e.what());
    }
  }
  return parsed;
}

void add_world_options(CLI::App* command, ExploreArguments& arguments) {
  command
      ->add_option("world", arguments.world,
                   "Built-in name, world file, OctoMap (.bt .ot), ROS map (.yaml .pgm .png .bmp), "
                   "mesh (.obj "
                   ".dae .gltf .glb .stl .ply), cloud of points (.pcd .ply) or Gazebo world")
      ->type_name("WORLD")
      ->capture_default_str();
  add_key(command, arguments.configuration, {"--sensors", "simulator.sensors"});
  add_world_keys(command, arguments.configuration);
  add_until(command, arguments.configuration);
  add_key(command, arguments.configuration, {"--map", "simulator.map", "FILE"});
  add_correct(command, arguments.configuration);
}

void add_mission_options(CLI::App* command, ExploreArguments& arguments) {
  add_configuration(command, arguments.configuration);
  add_key(command, arguments.configuration, {"--solver", "planner.solver", "SOLVER"});
  command->add_option("--seed", arguments.seed, "Seed of all noise")
      ->check(whole_number_within(0, std::numeric_limits<std::uint64_t>::max()))
      ->capture_default_str();
  command->add_option("--out", arguments.out, "Run folder [runs/WORLD_SOLVER_SEED]")
      ->type_name("DIR");
  command->add_flag("--overwrite", arguments.overwrite,
                    "Write over a drive in that folder, which nothing can repeat");
  add_key(command, arguments.configuration, {"--time-limit", "mission.time_limit"});
  add_go(command, arguments.configuration);
  add_key(command, arguments.configuration, {"--return", "mission.return_when_done"});
  command
      ->add_option("--save-problems", arguments.save_problems,
                   "Write the planning problem of every Nth step into the run folder")
      ->check(whole_number_within(1, 1000000));
  command->add_flag("--log-images", arguments.log_images,
                    "Images of the cameras in the log, too (explore: implies --mcap)");
  CLI::Option* live =
      command
          ->add_option("--live", arguments.live,
                       "Serve the mission's page, live, on this port; 0: a free one")
          ->type_name("PORT")
          ->check(whole_number_within(0, 65535));
  command
      ->add_option("--live-host", arguments.live_host,
                   "With --live: address of the interface; 0.0.0.0: all")
      ->type_name("ADDRESS")
      ->capture_default_str()
      ->needs(live);
  command
      ->add_option("--live-token", arguments.live_token,
                   "With --live: what allows to command, 16 or more letters and digits [random]")
      ->type_name("TOKEN")
      ->needs(live);
  command->add_flag("--json", arguments.json, "Print the summary as JSON");
  command->add_flag("--quiet", arguments.quiet, "No progress line");
}

Command explore_command(CLI::App& program) {
  const auto given = std::make_shared<ExploreArguments>();
  ExploreArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "explore", "A simulated mission until the reachable space is explored");
  add_world_options(command, arguments);
  add_mission_options(command, arguments);
  command->add_flag("--mcap", arguments.log,
                    "Log the mission to mission.mcap in the run folder, as drive does");
  return {command, [given](const Invocation& in) {
            given->command_line = in.typed;
            return explore(*given, in);
          }};
}

}  // namespace prospect
