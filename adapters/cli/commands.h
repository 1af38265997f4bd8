#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adapters/cli/world_arguments.h"
#include "adapters/config/registries.h"
#include "adapters/datasets/depth_source.h"
#include "adapters/datasets/stereo_source.h"
#include "adapters/files/exit_code.h"
#include "solvers/registry.h"

namespace prospect {

struct World;

struct ExploreArguments {
  std::string world = "office";
  std::string configuration;          ///< file; empty: defaults
  std::vector<std::string> settings;  ///< "planner.weights.w_l=0": above the file
  std::string solver;                 ///< empty: as configured
  std::string sensors;                ///< "model", "camera"; empty: as configured
  std::uint64_t seed = 1;
  std::string out;          ///< run folder; empty: runs/WORLD_SOLVER_SEED
  bool overwrite = false;   ///< also a drive that it holds
  double time_limit = 0.0;  ///< [s]; 0: as configured
  WorldArguments reading;
  std::vector<double> go;   ///< x [m], y [m], and yaw [deg] if it matters; empty: as configured
  std::string until;        ///< "0.95", "120m2"; empty: as configured
  bool back = false;        ///< return to the start once the task is over
  std::string map;          ///< OctoMap to begin with; empty: none
  bool log = false;         ///< mission.mcap in the run folder; drive always writes it
  bool log_images = false;  ///< with the cameras' images in it
  std::optional<int> live;  ///< port of the live view; none: there is none
  std::string live_host = "127.0.0.1", live_token;  ///< LiveOptions
  int save_problems = 0;  ///< write the problem of every so manyeth planning step; 0: none
  bool json = false;
  bool quiet = false;
  std::string command_line;  ///< as typed, for the run folder
};
int explore(const ExploreArguments& arguments, const Registries& registries);

struct DriveArguments {
  ExploreArguments mission;
  std::string base = "simulator";   ///< "simulator", "gazebo", "dds"
  std::string ros;                  ///< file of topics, of "dds"
  std::vector<std::string> faults;  ///< injected_fault.h
  bool measure = false;             ///< Gazebo's truth measures, against mission.world
};
int drive(const DriveArguments& arguments, const Registries& registries);
struct RelayArguments {
  std::string ros;                    ///< file of topics
  std::string configuration;          ///< file: the robot's motion; empty: defaults
  std::vector<std::string> settings;  ///< "robot.motion.a_max=0.5": above the file
};
/// The dead-man beside the motors of a robot behind topics, until it is interrupted.
int relay(const RelayArguments& arguments, const Registries& registries);
/// One line on standard error of what the world's source holds besides, if anything.
void tell_left_out(const World& world);

struct ReportArguments {
  std::string run;                   ///< folder, or the log of a mission
  std::vector<std::string> figures;  ///< "path", "map"
  std::vector<std::string> formats = {"png", "svg"};
  std::string color;  ///< of the path; empty: plain
  std::string out;    ///< folder; empty: that of the run
};
int report(const ReportArguments& arguments, const Registries& registries);
/// What ReportArguments::color may be.
std::vector<std::string> path_colors();

struct ExportArguments {
  std::string world = "office";
  std::string sdf;  ///< file
  WorldArguments reading;
  std::string configuration;          ///< file; empty: defaults
  std::vector<std::string> settings;  ///< "robot.depth.max_range=6": above the file
  std::uint64_t seed = 1;             ///< of the marks on surfaces, as in a mission
};
int export_world(const ExportArguments& arguments, const Registries& registries);

struct SolveArguments {
  std::vector<std::string> problems;  ///< problem files, WORLD@STEP
  std::string configuration;          ///< of the missions of WORLD@STEP
  std::vector<std::string> settings;  ///< "planner.weights.w_l=0": above the file
  std::vector<std::string> solvers;   ///< empty: one of each family
  double deadline = 0.0;              ///< [s], 0: none
  int max_evaluations = 400;
  std::uint64_t seed = 1;
  bool json = false;
  bool quiet = false;
};
int solve(const SolveArguments& arguments, const Registries& registries);

struct BenchArguments {
  /// Empty: all built-in ones; or "merge" or "compare" and the folders of benches.
  std::vector<std::string> sets;
  std::string configuration;          ///< file, of the missions that are driven for a set
  std::vector<std::string> settings;  ///< "planner.weights.w_l=0": above the file
  std::vector<std::string> solvers;   ///< names, each followed by its options; empty: one of a kind
  std::vector<double> deadlines;      ///< [s], 0: none; empty: as the help says
  int repeats = 0;                    ///< 0: as the help says
  int max_evaluations = 10000;
  std::vector<int> seeds;  ///< of the back ends; empty: 1
  double tolerance = 0.01;
  std::string out;      ///< folder; empty: runs/bench
  std::string capture;  ///< folder to write the problems of `missions` to, instead of a bench
  bool quick = false;
  bool keep_best = false;
  bool resume = false;
  bool overwrite = false;
  bool json = false;
  bool quiet = false;
};
int bench(const BenchArguments& arguments, const Registries& registries);

struct ReplayArguments {
  static constexpr int kToTheEnd = 2147483647;
  std::string run;                    ///< folder, or the log of a mission
  std::vector<std::string> settings;  ///< "planner.N=12"
  std::string solver;                 ///< empty: as recorded
  std::string world;                  ///< empty: as recorded
  int from = 0, to = kToTheEnd;       ///< planning steps
  std::string out;                    ///< folder; empty: RUN/replay
  bool quiet = false;
  std::vector<std::string> plugins;  ///< files, as given
  std::vector<std::string> program;  ///< words that start this program anew
};
int replay(const ReplayArguments& arguments, const Registries& registries);

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
  bool quiet = false;
  std::vector<std::string> plugins;  ///< files, as given
  std::vector<std::string> program;  ///< words that start this program anew
};
int study(const StudyArguments& arguments, const Registries& registries);

struct OdometryArguments {
  std::string dataset;  ///< a recording
  StereoDatasetOptions options;
  std::string out;  ///< folder for trajectories and tables; empty: none
  int first = 0;    ///< frame to begin with
  int frames = 0;   ///< at most so many; 0: all
  bool calibrate = false;
  bool json = false;
  bool quiet = false;
};
int odometry(const OdometryArguments& arguments);

struct MapArguments {
  std::string dataset;                 ///< a recording
  DepthDatasetOptions options;         ///< but for what is below
  StereoDatasetOptions stereo;         ///< calibration and topics also of depth images and scans
  std::string out;                     ///< folder for maps and tables; empty: none
  double resolution = 0.05;            ///< [m]
  std::optional<double> range;         ///< [m]; none: see the command line's help
  std::vector<double> camera;          ///< fx, fy, cx, cy [px]; empty: the recording's
  double camera_height = 0.0;          ///< [m]; 0: not known
  double camera_height_sigma = 0.05;   ///< standard deviation of it [m]
  std::optional<double> camera_pitch;  ///< down [deg]; none: not known
  double lidar_height = 0.0;           ///< [m]; 0: not known
  int first = 0;                       ///< frame to begin with
  int frames = 0;                      ///< at most so many; 0: all
  bool json = false;
  bool quiet = false;
};
int map(const MapArguments& arguments);

struct InspectArguments {
  std::string path;
  StereoDatasetOptions stereo;
  DepthDatasetOptions depth;
  bool json = false;
};
/// Exit codes: 0 it can be used, 1 something is missing, 2 nothing known.
int inspect(const InspectArguments& arguments);

/// `what`: one of list_kinds(), in full; "": all of them, names only unless `json`.
int list(const std::string& what, bool json, const Registries& registries);
std::vector<std::string> list_kinds();
/// The version of the program, and what it was built from and runs with.
int print_version(bool json);
/// Prints the page docs/reference/configuration.md; throws InputError if a file or settings are
/// given.
int print_reference(const std::string& file, const std::vector<std::string>& settings);
/// Prints the effective configuration of a file (empty: the defaults) and of settings above it.
int print_configuration(const std::string& file, const std::vector<std::string>& settings,
                        const Registries& registries);

}  // namespace prospect
