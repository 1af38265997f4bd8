#include "adapters/cli/command_line.h"

#include <fcntl.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/bench/problem_set.h"
#include "adapters/cli/command_line_files.h"
#include "adapters/cli/commands.h"
#include "adapters/cli/parse_command_line.h"
#include "adapters/cli/shell_words.h"
#include "adapters/files/input_error.h"
#include "adapters/files/not_built_in.h"
#include "models/nearest_name.h"

namespace {

/// One `prospect: ` line a problem, on stderr.
int refuse(const std::vector<std::string>& lines, int code) {
  for (std::string line : lines) {
    for (char& c : line) {
      if (c == '\n' || c == '\r') c = ' ';  // a file's name may hold one
    }
    std::cerr << "prospect: " << line << '\n';
  }
  return code;
}

/// A file that is opened must not become what was closed as standard output or error.
void open_standard_files() {
  for (int file = 0; file >= 0 && file <= 2;) file = open("/dev/null", O_RDWR);
}

/// The code, but for output that was not taken: one line, and kFailed where all else was done.
int checked_output(int code) {
  errno = 0;
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
  if (written) return code;
  const std::string reason = errno != 0 ? std::string(" (") + std::strerror(errno) + ")" : "";
  refuse({"standard output: cannot be written" + reason + "; expected room for it"}, code);
  return code == prospect::kDone ? static_cast<int>(prospect::kFailed) : code;
}

/// The option takes one of these, or a list of them; its type says so: "model|camera".
CLI::Option* one_of(CLI::Option* option, const std::vector<std::string>& choices) {
  std::string type;
  for (const std::string& choice : choices) type += (type.empty() ? "" : "|") + choice;
  return option->type_name(type)->check(CLI::Validator(
      [=](std::string& text) -> std::string {
        if (std::find(choices.begin(), choices.end(), text) != choices.end()) return "";
        return "unknown '" + text + "'" + prospect::did_you_mean(text, choices) +
               prospect::expected_one_of(choices);
      },
      ""));
}

/// A finite number in [min, max]: CLI::Range lets nan through.
CLI::Validator number_within(double min, double max) {
  std::ostringstream range;
  range << "a number from " << min << " to " << max;
  const std::string expected = range.str();
  return {[=](std::string& text) -> std::string {
            double value = 0.0;
            const char* last = text.data() + text.size();
            const auto [end, error] = std::from_chars(text.data(), last, value);
            const bool sound = error == std::errc() && end == last && value >= min && value <= max;
            return sound ? "" : "is '" + text + "'; expected " + expected;
          },
          ""};
}

/// A whole number in [min, max]: CLI11 wraps a negative one around.
CLI::Validator whole_number_within(std::uint64_t min, std::uint64_t max) {
  return {[=](std::string& text) -> std::string {
            std::uint64_t value = 0;
            const char* last = text.data() + text.size();
            const auto [end, error] = std::from_chars(text.data(), last, value);
            const bool sound = error == std::errc() && end == last && value >= min && value <= max;
            return sound ? ""
                         : "is '" + text + "'; expected a whole number from " +
                               std::to_string(min) + " to " + std::to_string(max);
          },
          ""};
}

void add_set(CLI::App* command, std::vector<std::string>& settings) {
  command
      ->add_option("--set", settings,
                   "A value above the configuration file, such as planner.weights.w_l=0; may be "
                   "given several times. Keys: `prospect config`")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

/// Topics of a bag as USE=TOPIC, separated by commas.
void add_topics(CLI::App* command, std::map<std::string, std::string>& topics,
                const std::vector<std::string>& uses) {
  std::string list;
  for (const std::string& use : uses) list += (list.empty() ? "" : ", ") + use;
  command
      ->add_option_function<std::vector<std::string>>(
          "--topics",
          [&topics, uses, list](const std::vector<std::string>& entries) {
            for (const std::string& entry : entries) {
              const auto equals = entry.find('=');
              const std::string use = entry.substr(0, equals);
              if (equals == std::string::npos || equals + 1 == entry.size() ||
                  std::find(uses.begin(), uses.end(), use) == uses.end()) {
                throw CLI::ValidationError(
                    "--topics", "is '" + entry + "'; expected USE=TOPIC, with USE of: " + list);
              }
              topics[use] = entry.substr(equals + 1);
            }
          },
          "Of a ROS 2 bag: " + list + " [found by type and name]")
      ->type_name("USE=TOPIC")
      ->delimiter(',')
      ->allow_extra_args(false);
}

/// What a recording of a stereo pair does not say by itself.
void add_recording_options(CLI::App* command, prospect::StereoDatasetOptions& options) {
  command
      ->add_option("--calibration", options.calibration,
                   "File of the calibration: calib.txt, ROS camera_info (left.yaml,right.yaml), "
                   "OpenCV stereo or Kalibr camchain YAML; of depth images a camera_info [the "
                   "recording's own]")
      ->type_name("FILE");
  command->add_flag("--rectified", options.rectified,
                    "The images are rectified already, by that camera_info");
  command
      ->add_option("--sync", options.sync,
                   "How far stamps of a pair may differ [s] [a tenth of a period]")
      ->check(number_within(0.0, 10.0));
  command->add_option("--rate", options.rate, "Of images that are only numbered [Hz] [10]")
      ->check(number_within(0.01, 10000.0));
}

/// The frame of a bag in which poses are wanted.
void add_fixed_frame(CLI::App* command, std::string& frame) {
  command
      ->add_option(
          "--fixed-frame", frame,
          "Of a bag's TF, in which the sensor moves [map, else a topic of poses, else odom "
          "or what is above the sensor]")
      ->type_name("FRAME");
}

/// How a world is read.
void add_world_options(CLI::App* command, prospect::WorldArguments& arguments) {
  using namespace prospect;
  command->add_option("--start", arguments.start, "Start x [m] y [m] yaw [deg]")
      ->expected(3)
      ->check(number_within(-1e6, 1e6));
  command
      ->add_option("--floor", arguments.floor,
                   "Storey of an octree, mesh or Gazebo world, by the height of its ground in the "
                   "file [m] [the lowest large one]")
      ->check(number_within(-1e5, 1e5));
  command
      ->add_option("--resolution", arguments.resolution,
                   "Of the world's voxels [m]; of an image without .yaml: of a pixel [0.1; of "
                   "meshes 0.05]")
      ->check(number_within(0.01, 10.0));
  one_of(command->add_option("--unknown", arguments.unknown,
                             "What the world's file does not know: solid or free [solid]"),
         {"solid", "free"});
  command
      ->add_option("--ground", arguments.ground_margin,
                   "How far the ground of a mesh or Gazebo world without end counts beyond what "
                   "stands on it [m]")
      ->check(number_within(0.0, 1000.0));
}

/// What explore and drive take alike.
void add_mission_options(CLI::App* command, prospect::ExploreArguments& arguments) {
  using namespace prospect;
  command
      ->add_option("world", arguments.world,
                   "Built-in name, world file, OctoMap (.bt .ot), ROS map (.yaml .pgm .png .bmp), "
                   "mesh (.obj "
                   ".dae .gltf .glb .stl .ply) or Gazebo world")
      ->type_name("WORLD")
      ->capture_default_str();
  command->add_option("--config", arguments.configuration, "Configuration file (YAML)")
      ->type_name("FILE");
  add_set(command, arguments.settings);
  command->add_option("--solver", arguments.solver, "Back end, see `prospect list solvers`")
      ->type_name("SOLVER");
  one_of(command->add_option("--sensors", arguments.sensors,
                             "model: odometry as a model of its errors; camera: rendered "
                             "images through perception"),
         {"model", "camera"});
  command->add_option("--seed", arguments.seed, "Seed of all noise")
      ->check(whole_number_within(0, std::numeric_limits<std::uint64_t>::max()))
      ->capture_default_str();
  command->add_option("--out", arguments.out, "Run folder [runs/WORLD_SOLVER_SEED]")
      ->type_name("DIR");
  command->add_flag("--overwrite", arguments.overwrite,
                    "Write over a drive in that folder, which nothing can repeat");
  command->add_option("--time-limit", arguments.time_limit, "Of the robot's clock [s]")
      ->check(number_within(1.0, 1e6));
  add_world_options(command, arguments.reading);
  command
      ->add_option("--go", arguments.go,
                   "Go to x [m],y [m], or x,y,yaw [deg], instead of exploring")
      ->delimiter(',')
      ->expected(2, 3)
      ->allow_extra_args(false)
      ->check(number_within(-1e5, 1e5));
  command->add_option("--until", arguments.until,
                      "What is enough: a share of the reachable area (0.95) or an area "
                      "(120m2)");
  command->add_flag("--return", arguments.back, "Back to the start once the task is over");
  command
      ->add_option("--map", arguments.map,
                   "OctoMap (.bt .ot) of the same world to begin with, such as the map.bt of a run")
      ->type_name("FILE");
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

/// The command line as typed, but for the token, which is nobody's to read in a run folder.
std::string typed_line(int argc, char** argv) {
  std::string line;
  bool token = false;
  for (int i = 0; i < argc; ++i) {
    const std::string word = argv[i];
    constexpr std::string_view kOption = "--live-token";
    const bool holds = word.starts_with(std::string(kOption) + "=");
    line += i > 0 ? " " : "";
    line += token ? "..." : holds ? std::string(kOption) + "=..." : prospect::shell_word(word);
    token = word == kOption;
  }
  return line;
}

int run(int argc, char** argv, const prospect::LoadPlugin& load,
        const std::vector<std::string>& program) {
  using namespace prospect;
  CLI::App app{"Plans for robots that explore by sight.", "prospect"};
  app.require_subcommand(0, 1);
  bool version = false, version_json = false;
  CLI::Option* version_flag = app.add_flag(
      "--version", version, "The version, its commit, compiler and libraries, and exit");
  app.add_flag("--json", version_json, "With --version: as JSON")->needs(version_flag);

  ExploreArguments explore_arguments;
  CLI::App* explore_command =
      app.add_subcommand("explore", "A simulated mission until the reachable space is explored");
  add_mission_options(explore_command, explore_arguments);
  explore_command->add_flag("--mcap", explore_arguments.log,
                            "Log the mission to mission.mcap in the run folder, as drive does");

  DriveArguments drive_arguments;
  CLI::App* drive_command = app.add_subcommand(
      "drive", "The same mission in real time: threads for perception, plans and commands");
  add_mission_options(drive_command, drive_arguments.mission);
  one_of(drive_command->add_option("--base", drive_arguments.base,
                                   "What is driven: the simulator as a robot with a clock, the "
                                   "robot of the Gazebo that runs, or one behind topics of ROS 2"),
         {"simulator", "gazebo", "dds"});
  drive_command
      ->add_option("--ros", drive_arguments.ros, "With --base dds: the robot's topics (YAML)")
      ->type_name("FILE");
  drive_command->add_flag("--measure", drive_arguments.measure,
                          "With --base gazebo: measure by Gazebo's truth, against WORLD, which it "
                          "runs; nothing else is taken from it but the start");
  drive_command
      ->add_option("--fault", drive_arguments.faults,
                   "Break something of the simulated robot, or of Gazebo's: SOURCE:VERB, from FROM "
                   "s on, for FOR s "
                   "(depth:off@10+2)")
      ->type_name("FAULT")
      ->allow_extra_args(false);

  RelayArguments relay_arguments;
  CLI::App* relay_command = app.add_subcommand(
      "relay", "The dead-man of a base behind topics of ROS 2, beside its motors");
  relay_command->add_option("--ros", relay_arguments.ros, "The robot's topics (YAML)")
      ->type_name("FILE")
      ->required();
  relay_command
      ->add_option("--config", relay_arguments.configuration,
                   "Configuration file (YAML): the limits of the robot's motion that the topics' "
                   "file leaves out")
      ->type_name("FILE");
  add_set(relay_command, relay_arguments.settings);

  ReportArguments report_arguments;
  CLI::App* report_command = app.add_subcommand(
      "report", "Figures of a run for print, as PNG and SVG; the page of a mission's log");
  report_command
      ->add_option("run", report_arguments.run, "Folder of a run, or the log of a mission (.mcap)")
      ->type_name("FILE")
      ->required();
  one_of(report_command->add_option(
             "--figure", report_arguments.figures,
             "path: the path over the map; map: the map at the end; separated by commas"),
         {"path", "map"})
      ->delimiter(',')
      ->allow_extra_args(false);
  one_of(report_command->add_option("--format", report_arguments.formats,
                                    "png, svg or both [png,svg]"),
         {"png", "svg"})
      ->delimiter(',')
      ->allow_extra_args(false);
  one_of(report_command->add_option("--colour", report_arguments.color,
                                    "What the path's colour says [plain]"),
         path_colors());
  report_command
      ->add_option("--out", report_arguments.out, "Folder to write to [that of the run or log]")
      ->type_name("DIR");

  ExportArguments export_arguments;
  CLI::App* export_command = app.add_subcommand(
      "export", "A world with the robot in it, for Gazebo 11: SDF, surfaces, textures");
  export_command
      ->add_option("world", export_arguments.world, "As explore takes it, but no mesh file")
      ->type_name("WORLD")
      ->capture_default_str();
  export_command->add_option("--sdf", export_arguments.sdf, "File to write; others go beside it")
      ->type_name("FILE")
      ->required();
  export_command
      ->add_option("--config", export_arguments.configuration, "Configuration file (YAML)")
      ->type_name("FILE");
  add_set(export_command, export_arguments.settings);
  add_world_options(export_command, export_arguments.reading);
  export_command->add_option("--seed", export_arguments.seed, "Of the marks on surfaces")
      ->check(whole_number_within(0, std::numeric_limits<std::uint64_t>::max()))
      ->capture_default_str();

  SolveArguments solve_arguments;
  CLI::App* solve_command =
      app.add_subcommand("solve", "One planning problem, several back ends, side by side");
  solve_command
      ->add_option("problem", solve_arguments.problems,
                   "Problem file (explore --save-problems), or WORLD@STEP: the problem that a "
                   "mission in WORLD meets at planning step STEP")
      ->type_name("PROBLEM")
      ->required();
  solve_command
      ->add_option("--config", solve_arguments.configuration,
                   "Configuration file (YAML) of the mission of WORLD@STEP")
      ->type_name("FILE");
  add_set(solve_command, solve_arguments.settings);
  solve_command->add_option("--solver", solve_arguments.solvers, "Back ends, separated by commas")
      ->type_name("SOLVER")
      ->delimiter(',')
      ->allow_extra_args(false);
  solve_command
      ->add_option("--deadline", solve_arguments.deadline, "Wall-clock limit of each solve [s]")
      ->check(number_within(0.0, 3600.0));
  solve_command->add_option("--max-evaluations", solve_arguments.max_evaluations, "Of each solve")
      ->check(whole_number_within(1, 100000000))
      ->capture_default_str();
  solve_command->add_option("--seed", solve_arguments.seed, "Of the mission and the solvers")
      ->check(whole_number_within(0, std::numeric_limits<int>::max()))
      ->capture_default_str();
  solve_command->add_flag("--json", solve_arguments.json, "Print JSON");
  solve_command->add_flag("--quiet", solve_arguments.quiet, "No progress line");

  BenchArguments bench_arguments;
  CLI::App* bench_command = app.add_subcommand(
      "bench", "Whole sets of problems by several back ends: who solves what, and how fast");
  bench_command
      ->add_option("set", bench_arguments.sets,
                   "Built-in set (see `prospect list sets`), folder of problem files, "
                   "problem file, file of problems as expressions (.json) [all built-in sets]; "
                   "or `merge` or `compare` and the folders of benches")
      ->type_name("SET");
  bench_command
      ->add_option("--config", bench_arguments.configuration,
                   "Configuration file (YAML) of the missions of the set missions")
      ->type_name("FILE");
  add_set(bench_command, bench_arguments.settings);
  bench_command
      ->add_option("--solver", bench_arguments.solvers,
                   "Back ends, separated by commas; NAME,OPTION=VALUE sets an option of one")
      ->type_name("SOLVER")
      ->delimiter(',')
      ->allow_extra_args(false);
  bench_command
      ->add_option("--deadline", bench_arguments.deadlines,
                   "Wall-clock limits of a solve [s], separated by commas; 0: none [0.1,1; with "
                   "--quick 0.1]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_within(0.0, 3600.0));
  bench_command
      ->add_option("--repeat", bench_arguments.repeats, "How often each solve is made [3; 1]")
      ->check(whole_number_within(1, 1000));
  bench_command->add_option("--max-evaluations", bench_arguments.max_evaluations, "Of each solve")
      ->check(whole_number_within(1, 100000000))
      ->capture_default_str();
  bench_command
      ->add_option("--tolerance", bench_arguments.tolerance,
                   "Share of the best known cost within which a problem is solved")
      ->check(number_within(1e-9, 1.0))
      ->capture_default_str();
  bench_command
      ->add_option(
          "--seed", bench_arguments.seeds,
          "Of the back ends; several, separated by commas: each problem once with each [1]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(whole_number_within(0, std::numeric_limits<int>::max()));
  bench_command
      ->add_option("--out", bench_arguments.out,
                   "Folder of the results: bench.html, bench.csv and others [runs/bench]")
      ->type_name("DIR");
  bench_command
      ->add_option("--capture", bench_arguments.capture,
                   "Write the problems of the set missions to this new folder, as a set")
      ->type_name("DIR");
  bench_command->add_flag("--quick", bench_arguments.quick,
                          "A share of each built-in set, few back ends: less than a minute");
  bench_command->add_flag("--keep-best", bench_arguments.keep_best,
                          "Keep the best costs found in best_known.json of the set's folder");
  bench_command->add_flag("--resume", bench_arguments.resume,
                          "Go on with the bench in that folder: what it holds is not solved again");
  bench_command->add_flag("--overwrite", bench_arguments.overwrite,
                          "Write over the bench in that folder: what it holds is lost");
  bench_command->add_flag("--json", bench_arguments.json, "Print JSON");
  bench_command->add_flag("--quiet", bench_arguments.quiet, "No progress line");

  ReplayArguments replay_arguments;
  CLI::App* replay_command = app.add_subcommand(
      "replay", "A recorded mission again, bit for bit; or other plans along its beliefs");
  replay_command
      ->add_option("run", replay_arguments.run, "Folder of a run, or the log of a mission (.mcap)")
      ->type_name("FILE")
      ->required();
  add_set(replay_command, replay_arguments.settings);
  replay_command
      ->add_option("--solver", replay_arguments.solver,
                   "Back end of the other plans, see `prospect list solvers`")
      ->type_name("SOLVER");
  replay_command
      ->add_option("--from", replay_arguments.from, "First planning step that is reported [0]")
      ->check(whole_number_within(0, 1000000000));
  replay_command
      ->add_option("--to", replay_arguments.to,
                   "The last one, where the mission is ended [its end]")
      ->check(whole_number_within(0, 1000000000));
  replay_command
      ->add_option("--world", replay_arguments.world, "Where the world of the run is [as recorded]")
      ->type_name("WORLD");
  replay_command
      ->add_option("--out", replay_arguments.out,
                   "Folder for table and page [replay in that of the run]")
      ->type_name("DIR");
  replay_command->add_flag("--quiet", replay_arguments.quiet, "No progress line");

  StudyArguments study_arguments;
  CLI::App* study_command = app.add_subcommand(
      "study", "Missions, or solves of problems, over conditions and a grid of values, in pairs");
  study_command->add_option("study", study_arguments.file, "Study file (YAML)")
      ->type_name("FILE")
      ->required();
  study_command
      ->add_option("--out", study_arguments.out,
                   "Folder of the study; what it holds is not run again [runs/NAME]")
      ->type_name("DIR");
  study_command->add_option("--jobs", study_arguments.jobs, "Cells at a time")
      ->check(whole_number_within(1, 4096))
      ->capture_default_str();
  study_command
      ->add_option("--shard", study_arguments.shard,
                   "Only the I-th of N parts of the cells, for one of N workers: I/N")
      ->type_name("I/N")
      ->capture_default_str();
  study_command->add_flag("--dry-run", study_arguments.dry_run,
                          "Say what would be run, and how long it takes");
  study_command->add_flag("--retry-failed", study_arguments.retry_failed,
                          "Run cells again that failed");
  CLI::Option* gather =
      study_command->add_flag("--gather", study_arguments.gather,
                              "Run nothing: results.csv, study.html and figures of what is there");
  study_command
      ->add_flag("--any-version", study_arguments.any_version,
                 "With --gather: what this version has not run is taken from the newest run of the "
                 "same mission by another one")
      ->needs(gather);
  study_command
      ->add_flag("--steps", study_arguments.steps,
                 "With --gather: steps.h5, too, with every column of every run")
      ->needs(gather);
  study_command->add_flag("--quiet", study_arguments.quiet, "No progress line");

  InspectArguments inspect_arguments;
  CLI::App* inspect_command = app.add_subcommand(
      "inspect", "What a recording holds, and what is missing to use it; names maps and worlds");
  inspect_command->add_option("path", inspect_arguments.path, "Folder or file")
      ->type_name("FILE")
      ->required();
  add_recording_options(inspect_command, inspect_arguments.stereo);
  add_topics(
      inspect_command, inspect_arguments.stereo.topics,
      {"left", "right", "left_info", "right_info", "truth", "depth", "depth_info", "scan", "pose"});
  add_fixed_frame(inspect_command, inspect_arguments.depth.fixed_frame);
  inspect_command->add_flag("--json", inspect_arguments.json, "Print JSON");

  OdometryArguments odometry_arguments;
  CLI::App* odometry_command =
      app.add_subcommand("odometry", "Visual odometry over a recording of a stereo pair");
  odometry_command
      ->add_option(
          "dataset", odometry_arguments.dataset,
          "Recording: KITTI odometry or raw, EuRoC, ROS 2 bag, or two folders of images or videos "
          "with a calibration; see `prospect inspect`")
      ->type_name("FILE")
      ->required();
  add_recording_options(odometry_command, odometry_arguments.options);
  add_topics(odometry_command, odometry_arguments.options.topics,
             {"left", "right", "left_info", "right_info", "truth"});
  odometry_command
      ->add_option("--out", odometry_arguments.out,
                   "Folder for a page, the trajectory (TUM and KITTI), a table of frames and a "
                   "summary [none]")
      ->type_name("DIR");
  odometry_command->add_option("--from", odometry_arguments.first, "Frame to begin with, from 0")
      ->check(whole_number_within(0, 1000000000))
      ->capture_default_str();
  odometry_command->add_option("--frames", odometry_arguments.frames, "At most so many [all]")
      ->check(whole_number_within(1, 1000000000));
  odometry_command->add_flag("--calibrate", odometry_arguments.calibrate,
                             "Hold what the planner predicts of landmarks and motion against what "
                             "came of it");
  odometry_command->add_flag("--json", odometry_arguments.json, "Print the summary as JSON");
  odometry_command->add_flag("--quiet", odometry_arguments.quiet, "No progress line");

  MapArguments map_arguments;
  CLI::App* map_command = app.add_subcommand(
      "map",
      "Octree, exploration and obstacle map from recorded depth images, stereo pairs or lidar "
      "scans");
  map_command
      ->add_option(
          "dataset", map_arguments.dataset,
          "Recording in 7-Scenes, TUM RGB-D or depth/NNN.png layout, ROS 2 bag, CARMEN log, "
          "or of a stereo pair, as for `prospect odometry`; see `prospect inspect`")
      ->type_name("FILE")
      ->required();
  map_command
      ->add_option("--out", map_arguments.out, "Folder for a page, the maps and tables [none]")
      ->type_name("DIR");
  map_command->add_option("--resolution", map_arguments.resolution, "Of the maps [m]")
      ->check(number_within(0.01, 1.0))
      ->capture_default_str();
  map_command
      ->add_option("--range", map_arguments.range,
                   "Farther away nothing is learned [m] [of depth images 4, of a stereo pair where "
                   "two deviations of a depth are a voxel, of a lidar its own; to 200 voxels]")
      ->check(number_within(0.5, 200.0));
  map_command
      ->add_option("--camera", map_arguments.camera,
                   "Intrinsics where no file states them: FX FY CX CY [px]")
      ->expected(4)
      ->check(number_within(1.0, 1e5));
  add_recording_options(map_command, map_arguments.stereo);
  add_topics(map_command, map_arguments.stereo.topics,
             {"left", "right", "left_info", "right_info", "depth", "depth_info", "scan", "pose"});
  add_fixed_frame(map_command, map_arguments.options.fixed_frame);
  map_command
      ->add_option("--depth-scale", map_arguments.options.depth_scale,
                   "Numbers of the images a metre [the layout's, 1000 or 5000, checked against "
                   "poses or the camera's height]")
      ->check(number_within(1e-3, 1e6));
  map_command
      ->add_option("--camera-height", map_arguments.camera_height,
                   "Above the floor in the first frame [m] [0.2 to 2]")
      ->check(number_within(0.05, 10.0));
  map_command
      ->add_option("--camera-height-sigma", map_arguments.camera_height_sigma,
                   "How sure that is: standard deviation [m]")
      ->check(number_within(0.001, 1.0))
      ->capture_default_str();
  map_command
      ->add_option("--camera-pitch", map_arguments.camera_pitch,
                   "Down, in the first frames, to 15 deg [deg] [-15 to 55]")
      ->check(number_within(-90.0, 90.0));
  map_command
      ->add_option("--lidar-height", map_arguments.lidar_height,
                   "Above the floor, in the first scan [m] [as the poses say]")
      ->check(number_within(0.01, 100.0));
  map_command->add_option("--from", map_arguments.first, "Frame to begin with, from 0")
      ->check(whole_number_within(0, 1000000000))
      ->capture_default_str();
  map_command->add_option("--frames", map_arguments.frames, "At most so many [all]")
      ->check(whole_number_within(1, 1000000000));
  map_command->add_flag("--json", map_arguments.json, "Print the summary as JSON");
  map_command->add_flag("--quiet", map_arguments.quiet, "No progress line");

  std::string what;
  bool list_json = false;
  CLI::App* list_command = app.add_subcommand(
      "list", "What there is: solvers, worlds, terms, sets, modes, drive-modes or adapters");
  one_of(list_command->add_option("what", what, "Which of them, in full [all, in short]"),
         list_kinds());
  list_command->add_flag("--json", list_json, "Print JSON");

  std::string configuration;
  CLI::App* config_command =
      app.add_subcommand("config", "The full effective configuration, with units and defaults");
  config_command->add_option("file", configuration, "Configuration file (YAML) [the defaults]")
      ->type_name("FILE");
  std::vector<std::string> settings;
  add_set(config_command, settings);
  bool reference = false;
  config_command->add_flag("--reference", reference,
                           "Every key with unit, range, default and meaning instead (Markdown)");

  std::vector<std::string> plugins;
  for (CLI::App* command : app.get_subcommands({})) {
    command
        ->add_option("--plugin", plugins,
                     "Shared library with further back ends, terms or problems; may be given "
                     "several times")
        ->type_name("FILE")
        ->allow_extra_args(false);
  }

  // For the build: completions and manual pages.
  std::string shared_folder;
  CLI::App* files_command = app.add_subcommand("command-line-files")->group("");
  files_command->add_option("folder", shared_folder)->required();

  try {
    parse_command_line(app, argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  }
  if (version) return print_version(version_json);
  if (app.get_subcommands().empty()) {
    std::cout << app.help();
    return kDone;
  }
  if (*files_command) return write_command_line_files(app, shared_folder);
  Registries registries;
  for (const std::string& name : builtin_set_names()) registries.problems.reserve(name);
  for (const std::string& path : plugins) {
    const std::string warning =
        load(path, {registries.solvers, registries.terms, registries.problems});
    if (!warning.empty()) std::cerr << "prospect: " << warning << '\n';
  }
  for (ExploreArguments* mission : {&explore_arguments, &drive_arguments.mission}) {
    mission->command_line = typed_line(argc, argv);
  }
  if (*explore_command) return explore(explore_arguments, registries);
  if (*drive_command) return drive(drive_arguments, registries);
  if (*relay_command) return relay(relay_arguments, registries);
  if (*report_command) return report(report_arguments, registries);
  if (*export_command) return export_world(export_arguments, registries);
  if (*solve_command) return solve(solve_arguments, registries);
  if (*bench_command) return bench(bench_arguments, registries);
  if (*replay_command) {
    replay_arguments.plugins = plugins;
    replay_arguments.program = program;
    return replay(replay_arguments, registries);
  }
  if (*study_command) {
    study_arguments.plugins = plugins;
    study_arguments.program = program;
    return study(study_arguments, registries);
  }
  if (*inspect_command) return inspect(inspect_arguments);
  if (*odometry_command) return odometry(odometry_arguments);
  if (*map_command) return map(map_arguments);
  if (*list_command) return list(what, list_json, registries);
  if (reference) return print_reference(configuration, settings);
  return print_configuration(configuration, settings, registries);
}

}  // namespace

int prospect::run_command_line(int argc, char** argv, const LoadPlugin& load,
                               const std::vector<std::string>& program) {
  open_standard_files();
  try {
    return checked_output(run(argc, argv, load, program));
  } catch (const InputError& error) {
    return refuse(error.lines(), kBadInput);
  } catch (const std::invalid_argument& error) {
    return refuse({error.what()}, kBadInput);
  } catch (const NotBuiltIn& error) {
    return refuse({error.what()}, kNotBuiltIn);
  } catch (const std::exception& error) {
    return refuse({error.what()}, kFailed);
  }
}
