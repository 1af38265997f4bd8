// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/degrees.h"
#include "adapters/formats/datasets/depth_dataset.h"
#include "adapters/formats/datasets/scan_source.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/not_built_in.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/formats/worlds/octree_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/recordings/ground_picture.h"
#include "adapters/missions/recordings/map_page.h"
#include "adapters/missions/recordings/map_run.h"
#include "adapters/missions/recordings/recording_range.h"
#include "adapters/missions/recordings/scan_run.h"
#include "adapters/missions/recordings/stereo_depth_source.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"
#include "perception/odometry/stereo_odometry_options.h"
#include "perception/pipeline/straight_map.h"

namespace prospect {
namespace {

struct MapArguments {
  std::string dataset;  ///< a recording
  ConfigurationArguments configuration;
  DepthDatasetOptions options;         ///< but for what is below
  StereoDatasetOptions stereo;         ///< calibration and topics also of depth images and scans
  std::string out;                     ///< folder for maps and tables; empty: none
  std::optional<double> range;         ///< [m]; none: see the command line's help
  std::vector<double> camera;          ///< fx, fy, cx, cy [px]; empty: the recording's
  double camera_height = 0.0;          ///< [m]; 0: not known
  double camera_height_sigma = 0.05;   ///< standard deviation of it [m]
  std::optional<double> camera_pitch;  ///< down [deg]; none: not known
  double lidar_height = 0.0;           ///< [m]; 0: not known
  int first = 0;                       ///< frame to begin with
  int frames = 0;                      ///< at most so many; 0: all
  bool loops = false;                  ///< places that are seen again correct the poses
  bool json = false;
  bool quiet = false;
};

constexpr double kPriorWidth = 4.0;    // [standard deviations]
constexpr double kMostVoxels = 200.0;  // of a ray, see OccupancyMapperOptions
constexpr double kDepthRange = 4.0;    // of depth images where none is given [m]

/// A recording of depth images, of a stereo pair or of a lidar, opened, and how it is mapped.
struct MapInput {
  std::string layout, holds;  ///< "33 depth images of 640 x 480 px"
  std::vector<std::string> notes;
  bool scans = false, poses = true;
  int size = 0, without_pose = 0;
  std::optional<double> depth_scale;          ///< none of scans and of stereo pairs
  std::optional<StereoDepthAccuracy> stereo;  ///< of stereo pairs
  std::string doubt;                          ///< what contradicts the depth scale; empty: nothing
  std::function<MapRun(int frames, bool loops, const MapRunWatch& watch)> run;
};

nlohmann::ordered_json as_json(const GroundRecord& r) {
  return {{"frame", r.frame},
          {"stamp_s", r.stamp},
          {"hypothesis", r.hypothesis},
          {"height_m", r.height},
          {"sigma_height_m", r.sigma_height},
          {"pitch_deg", kDegrees * r.pitch},
          {"roll_deg", kDegrees * r.roll},
          {"sigma_tilt_deg", kDegrees * r.sigma_tilt},
          {"support", r.support},
          {"taken", r.taken},
          {"why", r.why}};
}

/// What was taken for the ground, and why, over time.
nlohmann::ordered_json ground_json(const MapRun& run, const MapSummary& s) {
  nlohmann::ordered_json json = {{"taken", nullptr}, {"none_because", nullptr}};
  if (s.taken) json["taken"] = as_json(*s.taken);
  if (!run.no_ground.empty()) json["none_because"] = run.no_ground;
  json["rejected"] = nlohmann::ordered_json::array();
  for (const GroundRecord& r : s.rejected_grounds) json["rejected"].push_back(as_json(r));
  json["changes"] = nlohmann::ordered_json::array();
  for (const GroundChange& c : run.changes) {
    json["changes"].push_back({{"frame", c.frame},
                               {"stamp_s", c.stamp},
                               {"hypothesis", c.hypothesis},
                               {"height_m", c.height},
                               {"reason", c.reason}});
  }
  json["over_time"] = nlohmann::ordered_json::array();
  for (const GroundRecord& r : run.ground) json["over_time"].push_back(as_json(r));
  return json;
}

/// What the depths of a stereo pair are worth.
nlohmann::ordered_json stereo_json(const StereoDepthAccuracy& stereo) {
  return {{"nearest_m", stereo.range.min},
          {"farthest_m", stereo.range.max},
          {"depth_noise_per_m", stereo.noise}};
}

nlohmann::ordered_json as_json(const MapArguments& arguments, double resolution,
                               const MapInput& input, const MapRun& run, const MapSummary& s) {
  const auto of_map = [&](int cells) {
    return run.maps.ground ? nlohmann::ordered_json(cells) : nlohmann::ordered_json();
  };
  return {
      {"dataset", arguments.dataset},
      {"layout", input.layout},
      {"notes", input.notes},
      {"depth_scale",
       input.depth_scale ? nlohmann::ordered_json(*input.depth_scale) : nlohmann::ordered_json()},
      {"stereo", input.stereo ? stereo_json(*input.stereo) : nlohmann::ordered_json()},
      {"without_pose", input.without_pose},
      {"poses", input.poses},
      {"resolution_m", resolution},
      {"frames", s.frames},
      {"ok", s.ok},
      {"degraded", s.degraded},
      {"rejected", s.rejected},
      {"mapped_percent", s.frames > 0 ? 100.0 * (s.frames - s.rejected) / s.frames : std::nan("")},
      {"ground_found", input.scans ? nlohmann::ordered_json() : nlohmann::ordered_json(s.ground)},
      {"ground", input.scans ? nlohmann::ordered_json() : ground_json(run, s)},
      {"height_median_m", s.height_median},
      {"height_min_m", s.height_min},
      {"height_max_m", s.height_max},
      {"height_error_m", s.height_error},
      {"tilt_spread_deg", kDegrees * s.tilt_spread},
      {"tilt_worst_deg", kDegrees * s.tilt_worst},
      {"free_cells", of_map(s.free_cells)},
      {"occupied_cells", of_map(s.occupied_cells)},
      {"low_cells", of_map(s.low_cells)},
      {"wall_cells", of_map(s.walls.cells)},
      {"wall_thickness_median_m", s.walls.median},
      {"wall_thickness_p90_m", s.walls.p90},
      {"walls_doubled", s.walls.doubled},
      {"loops", run.loops ? nlohmann::ordered_json{{"found", run.loops->found},
                                                   {"used", run.loops->used},
                                                   {"moved_m", run.loops->farthest}}
                          : nlohmann::ordered_json()},
      {"without_loops", nullptr},
      {"processor_ms",
       {{"hypotheses", times_json(s.hypotheses)},
        {"check", times_json(s.check)},
        {"ground", times_json(s.ground_plane)},
        {"scan", times_json(s.scan)},
        {"insert", times_json(s.insert)},
        {"snapshot", times_json(s.snapshot)},
        {"frame", times_json(s.frame)}}}};
}

/// For the page, which has no times, so that it is the same for the same recording.
nlohmann::ordered_json untimed(nlohmann::ordered_json json) {
  json.erase("processor_ms");
  if (json["ground"].is_object()) json["ground"].erase("over_time");  // it is in the run
  return json;
}

/// What of a summary is of the map, and not of the recording.
nlohmann::ordered_json of_map_alone(const nlohmann::ordered_json& json) {
  nlohmann::ordered_json out;
  for (const char* name : {"free_cells", "occupied_cells", "low_cells", "wall_cells",
                           "wall_thickness_median_m", "wall_thickness_p90_m", "walls_doubled"}) {
    out[name] = json.at(name);
  }
  return out;
}

void print_loops(const MapRunLoops& loops, const MapSummary& with, const MapSummary& without,
                 double resolution) {
  const double cell = resolution * resolution;
  std::printf("loops        %d of %d used; a pose moved by %.2f m at most; without loops %.2f m^2",
              loops.used, loops.found, loops.farthest, without.occupied_cells * cell);
  std::printf(" occupied, with them %.2f\n", with.occupied_cells * cell);
}

void print_ground(const MapRun& run, const MapSummary& s) {
  std::printf("ground       found in %d of %d\n", s.ground, s.frames);
  const auto plane = [](const GroundRecord& r) {
    std::printf(
        "hypothesis %d, %.3f m below the first camera, that pitched %.1f deg down and rolled "
        "%.1f deg; %d frames: %s\n",
        r.hypothesis, r.height, kDegrees * r.pitch, kDegrees * r.roll, r.support, r.why.c_str());
  };
  if (s.taken) {
    std::printf("  taken      ");
    plane(*s.taken);
    std::printf("  known to   %.3f m and %.2f deg, if depth scale and lens are right\n",
                s.taken->sigma_height, kDegrees * s.taken->sigma_tilt);
  } else if (s.frames > 0) {
    std::printf("  none       %s\n", run.no_ground.c_str());
  }
  for (const GroundRecord& r : s.rejected_grounds) {
    std::printf("  rejected   ");
    plane(r);
  }
  for (const GroundChange& c : run.changes) {
    std::printf("  frame %-4d hypothesis %d, %.3f m: %s\n", c.frame, c.hypothesis, c.height,
                c.reason.c_str());
  }
}

void print(const MapInput& input, const MapRun& run, const MapSummary& s) {
  std::printf("frames       %d: %d ok, %d degraded, %d rejected\n", s.frames, s.ok, s.degraded,
              s.rejected);
  if (!input.scans) print_ground(run, s);
  if (s.ground > 0) {
    std::printf("height       %.3f m in the median, %.3f to %.3f m", s.height_median, s.height_min,
                s.height_max);
    if (run.maps.ground) std::printf("; %.3f m rms off the poses'", s.height_error);
    std::printf("\ntilt         %.2f deg rms about the mean, at most %.2f deg\n",
                kDegrees * s.tilt_spread, kDegrees * s.tilt_worst);
  }
  if (!run.maps.ground) {
    std::printf("map          none: %s\n", run.no_ground.empty()
                                               ? "the recording has no poses, so the ground is "
                                                 "measured only"
                                               : "no ground was found");
  } else {
    const double r = run.maps.ground->frame().resolution;
    std::printf(
        "map          %.2f m^2 free, %.2f m^2 occupied; %d of %d occupied cells lower than "
        "0.2 m\n",
        s.free_cells * r * r, s.occupied_cells * r * r, s.low_cells, s.occupied_cells);
    if (s.walls.cells == 0) {
      std::printf("walls        none long enough to measure\n");
    } else {
      std::printf(
          "walls        %.2f m thick in the median, 90 %%: %.2f m; %.1f %% doubled of %d "
          "cells\n",
          s.walls.median, s.walls.p90, 100.0 * s.walls.doubled, s.walls.cells);
    }
  }
  const auto row = [](const char* name, const TimePercentiles& t) {
    if (!std::isfinite(t.p50)) return;
    std::printf("%-12s %6.1f %6.1f %6.1f %6.1f\n", name, t.p50, t.p95, t.p99, t.max);
  };
  std::printf("processor time [ms]\n");
  std::printf("%-12s %6s %6s %6s %6s\n", "", "p50", "p95", "p99", "max");
  if (!input.scans) {
    row("  hypotheses", s.hypotheses);
    row("  ground", s.ground_plane);
  }
  if (run.maps.ground) {
    row("  check", s.check);
    row("  scan", s.scan);
    row("  insert", s.insert);
    row("  snapshot", s.snapshot);
    row("  frame", s.frame);
  }
}

/// Refuses an option that says nothing of such a recording.
void refuse(bool given, const char* option, const std::string& dataset, const char* instead) {
  if (given) throw InputError(std::string(option) + ": " + dataset + " is " + instead);
}

std::string range_note(double range) {
  char line[80];
  std::snprintf(line, sizeof line, "mapped to %.3g m; --range states another", range);
  return line;
}

/// Options of one kind of recording, with another one: `what` the recording is.
void refuse_stereo_options(const MapArguments& arguments, const char* what) {
  const StereoDatasetOptions& stereo = arguments.stereo;
  refuse(stereo.rectified, "--rectified", arguments.dataset, what);
  refuse(stereo.sync.has_value(), "--sync", arguments.dataset, what);
  refuse(stereo.rate.has_value(), "--rate", arguments.dataset, what);
}

DepthDataset open_depth(const MapArguments& arguments) {
  refuse_stereo_options(arguments,
                        "a recording of depth images; expected it with a stereo pair only");
  DepthDatasetOptions options = arguments.options;
  options.camera_height = arguments.camera_height;
  options.topics = arguments.stereo.topics;
  options.calibration = arguments.stereo.calibration;
  if (!arguments.camera.empty()) {
    PinholeCamera camera;
    camera.fx = arguments.camera[0];
    camera.fy = arguments.camera[1];
    camera.cx = arguments.camera[2];
    camera.cy = arguments.camera[3];
    options.camera = camera;
  }
  return DepthDataset::open(arguments.dataset, options);
}

DepthDataset open_stereo(const MapArguments& arguments) {
  refuse(!arguments.camera.empty(), "--camera", arguments.dataset,
         "a recording of a stereo pair; expected --calibration");
  refuse(arguments.options.depth_scale.has_value(), "--depth-scale", arguments.dataset,
         "a recording of a stereo pair; expected it with depth images only");
  StereoDatasetOptions stereo = arguments.stereo;
  stereo.fixed_frame = arguments.options.fixed_frame;
  DepthDatasetOptions options;
  options.camera_height = arguments.camera_height;
  return DepthDataset::open(open_stereo_depth(arguments.dataset, stereo), options);
}

MapInput depth_input(const MapArguments& arguments, const PerceptionOptions& perception,
                     bool stereo) {
  refuse(arguments.lidar_height > 0.0, "--lidar-height", arguments.dataset,
         stereo ? "a recording of a stereo pair; expected --camera-height"
                : "a recording of depth images; expected --camera-height");
  const DepthDataset dataset = stereo ? open_stereo(arguments) : open_depth(arguments);
  check_first_frame(arguments.first, dataset.size(), arguments.dataset);
  MapInput input;
  input.layout = dataset.layout();
  input.notes = dataset.notes();
  MapRunOptions run_options;
  run_options.mapper = perception.depth_mapping;
  run_options.mapper.map = perception.mapping;
  run_options.movers = perception.movers;
  const double resolution = perception.mapping.resolution;
  run_options.mapper.map.max_range = arguments.range.value_or(kDepthRange);
  if (dataset.stereo()) {
    const double sharp = sharp_range(*dataset.stereo(), resolution);
    const double range = arguments.range.value_or(std::min(sharp, kMostVoxels * resolution));
    if (!arguments.range) input.notes.push_back(range_note(range));
    set_stereo_accuracy(*dataset.stereo(), range, run_options.mapper);
    // A pair may be carried by a car.
    run_options.mapper.max_speed = StereoOdometryOptions().max_speed;
  }
  GroundPrior& prior = run_options.prior;
  double low = prior.height - prior.height_tolerance, high = prior.height + prior.height_tolerance;
  if (arguments.camera_height > 0.0) {
    run_options.height = arguments.camera_height;
    run_options.sigma_height = arguments.camera_height_sigma;
    // What else there is, is looked for, too, so that it can be said why it is not the ground.
    low = std::min(low, arguments.camera_height - kPriorWidth * arguments.camera_height_sigma);
    high = std::max(high, arguments.camera_height + kPriorWidth * arguments.camera_height_sigma);
  }
  const double pitch = arguments.camera_pitch ? *arguments.camera_pitch / kDegrees : 0.35;
  prior = ground_prior(0.5 * (low + high), pitch, 0.0, 0.5 * (high - low),
                       arguments.camera_pitch ? 0.26 : prior.tilt_tolerance);
  char holds[80];
  std::snprintf(holds, sizeof holds, "%d %s of %.0f x %.0f px", dataset.size(),
                stereo ? "stereo pairs" : "depth images", dataset.camera().width,
                dataset.camera().height);
  input.holds = holds;
  input.poses = dataset.has_poses();
  input.size = dataset.size();
  input.without_pose = dataset.without_pose();
  if (!stereo) input.depth_scale = dataset.depth_scale();
  input.stereo = dataset.stereo();
  if (dataset.depth_scale_doubtful()) input.doubt = dataset.notes().back();
  input.run = [=, first = arguments.first](int frames, bool loops, const MapRunWatch& watch) {
    MapRunOptions options = run_options;
    options.loops = loops;
    return run_mapping(dataset, options, first, frames, watch);
  };
  return input;
}

MapInput scan_input(const MapArguments& arguments, const PerceptionOptions& perception) {
  refuse_stereo_options(arguments, "a recording of a lidar; expected it with a stereo pair only");
  for (const auto& [given, option] :
       {std::pair(arguments.camera_height > 0.0, "--camera-height"),
        std::pair(arguments.camera_pitch.has_value(), "--camera-pitch"),
        std::pair(!arguments.camera.empty(), "--camera"),
        std::pair(!arguments.stereo.calibration.empty(), "--calibration"),
        std::pair(arguments.options.depth_scale.has_value(), "--depth-scale")}) {
    refuse(given, option, arguments.dataset,
           "a recording of a lidar; expected it with a camera only");
  }
  const ScanSource source =
      open_scan_source(arguments.dataset, {arguments.stereo.topics, arguments.options.fixed_frame});
  if (!source.missing.empty()) throw InputError(source.missing[0]);
  MapInput input;
  input.scans = true;
  input.size = static_cast<int>(source.stamps.size());
  check_first_frame(arguments.first, input.size, arguments.dataset);
  const ScanPlacement placement = place_scans(source, arguments.lidar_height, arguments.first);
  ScanMapperOptions options = perception.scan_mapping;
  options.map = perception.mapping;
  const double farthest = kMostVoxels * options.map.resolution;
  options.map.max_range = arguments.range.value_or(
      source.max_range > 0.0 ? std::min(source.max_range, farthest) : farthest);
  char line[120];
  std::snprintf(line, sizeof line, "%d %s, the first of %zu points", input.size,
                source.planar ? "scans of one plane" : "clouds", source.points);
  input.layout = source.layout;
  input.holds = line;
  input.notes = source.notes;
  input.notes.insert(input.notes.end(), placement.notes.begin(), placement.notes.end());
  if (!arguments.range) input.notes.push_back(range_note(options.map.max_range));
  input.without_pose = static_cast<int>(source.without_pose);
  const MoverTrackerOptions movers = perception.movers;
  input.run = [=, first = arguments.first](int frames, bool loops, const MapRunWatch& watch) {
    return run_scan_mapping(source, placement, {options, loops, movers}, first, frames, watch);
  };
  return input;
}

/// As configured, by default with finer voxels than in missions, as nobody waits for the map, and
/// with a flat floor: recorded poses are mended so that the floor is z = 0.
PerceptionOptions perception_of(const MapArguments& arguments, ConfigurationUse use) {
  PerceptionOptions perception;
  perception.mapping.resolution = 0.05;
  perception.mapping.slopes = false;
  return read_told_perception(arguments.configuration, perception, use);
}

/// What is written besides the octree: names and contents.
std::vector<std::pair<std::string, std::string>> files_of(const MapRun& run,
                                                          const nlohmann::ordered_json& json,
                                                          std::string page) {
  std::vector<std::pair<std::string, std::string>> files = {{"ground.csv", ground_csv(run)},
                                                            {"summary.json", json.dump(2) + "\n"},
                                                            {"map.html", std::move(page)}};
  if (!run.maps.ground) return files;
  GroundPicture exploration = exploration_picture(*run.maps.ground, "exploration.png");
  GroundPicture obstacles = obstacle_picture(*run.maps.ground, "obstacles.png");
  files.emplace_back("exploration.png", std::move(exploration.png));
  files.emplace_back("exploration.yaml", std::move(exploration.yaml));
  files.emplace_back("obstacles.png", std::move(obstacles.png));
  files.emplace_back("obstacles.yaml", std::move(obstacles.yaml));
  return files;
}

int map(const MapArguments& arguments, SignalGuard& signals) {
  if (arguments.loops && !StraightMap::is_built_in()) {
    throw NotBuiltIn("--loops", "Ceres (libceres-dev)");
  }
  Progress progress(arguments.quiet);
  progress.show("reading " + arguments.dataset);
  const bool scans = is_used_for_scans(arguments.dataset, arguments.stereo.topics);
  const bool stereo =
      !scans && is_used_for_stereo_depth(arguments.dataset, arguments.stereo.topics);
  const PerceptionOptions perception =
      perception_of(arguments, scans    ? ConfigurationUse::kMapScans
                               : stereo ? ConfigurationUse::kMapStereo
                                        : ConfigurationUse::kMapDepth);
  const double resolution = perception.mapping.resolution, farthest = kMostVoxels * resolution;
  const double range = arguments.range.value_or(scans || stereo ? 0.0 : kDepthRange);
  if (range > farthest) {
    char line[160];
    std::snprintf(line, sizeof line,
                  "--range is %g m; expected at most %g m (%.0f voxels) with --resolution %g",
                  range, farthest, kMostVoxels, resolution);
    throw InputError(line);
  }
  MapInput input =
      scans ? scan_input(arguments, perception) : depth_input(arguments, perception, stereo);
  progress.finish();
  refuse(arguments.loops && !input.poses, "--loops", arguments.dataset,
         "a recording without poses; expected them, as of an odometry");
  signals.note();
  std::optional<OutputFolder> out;
  if (!arguments.out.empty()) {
    out = OutputFolder::own(arguments.out, {"map"});
    out->begin({"ground.csv", "summary.json", "map.html", "map.bt", "exploration.png",
                "exploration.yaml", "obstacles.png", "obstacles.yaml"});
  }
  const int frames = frames_from(arguments.first, arguments.frames, input.size);
  MapRunWatch watch{{}, signals.came()};
  watch.progress = [&](int done, const MapRunFrame& frame) {
    progress.show(std::to_string(done) + " of " + std::to_string(frames) + " frames  " +
                  (scans                       ? ""
                   : frame.mapped.ground.found ? "ground found  "
                                               : "ground not found  ") +
                  std::string(to_string(frame.mapped.state)));
  };
  // As the poses have it, and then, if wanted, with what places say that are seen again.
  MapRun run = input.run(frames, false, watch);
  std::optional<MapRun> drawn;
  if (arguments.loops && !run.cancelled && run.maps.ground) {
    drawn = std::exchange(run, input.run(frames, true, watch));
  }
  progress.finish();
  input.notes.insert(input.notes.end(), run.notes.begin(), run.notes.end());
  const MapSummary summary = summarize(run);
  auto json = as_json(arguments, resolution, input, run, summary);
  nlohmann::ordered_json drawn_json;
  std::optional<MapSummary> drawn_summary;
  if (drawn) {
    drawn_summary = summarize(*drawn);
    drawn_json = untimed(as_json(arguments, resolution, input, *drawn, *drawn_summary));
    json["without_loops"] = of_map_alone(drawn_json);
  }
  std::string written;
  if (out) {
    const auto files = files_of(
        run, json,
        drawn ? map_page(run, untimed(json), *drawn, drawn_json) : map_page(run, untimed(json)));
    if (run.maps.ground) {
      write_octree(*run.maps.octree, out->claim("map.bt"));
      written = "map.bt ";
    }
    for (const auto& [name, content] : files) {
      const std::string problem = out->write(name, content);
      if (!problem.empty()) {
        std::cerr << "prospect: " << arguments.out << '/' << name << ": " << problem << '\n';
        return kFailed;
      }
      written += name + " ";
    }
    if (!run.cancelled) out->complete();
  }
  if (arguments.json) {
    std::cout << json.dump(2) << '\n';
  } else {
    std::printf("%s, %s%s\n", input.layout.c_str(), input.holds.c_str(),
                input.poses ? "" : ", no poses");
    for (const std::string& note : input.notes) std::printf("note         %s\n", note.c_str());
    print(input, run, summary);
    if (drawn) print_loops(*run.loops, summary, *drawn_summary, resolution);
    if (out) std::printf("written to   %s: %s\n", out->path().c_str(), written.c_str());
  }
  if (run.cancelled) {
    std::cerr << "prospect: " << cancelled_note(run.frames.size(), frames) << '\n';
    return kCancelled;
  }
  if (!input.doubt.empty()) {
    std::cerr << "prospect: " << arguments.dataset << ": " << input.doubt
              << "; expected a depth scale that agrees with what is known\n";
    return kFailed;
  }
  if (!run.no_ground.empty()) {
    std::cerr << "prospect: " << arguments.dataset << ": no ground in any of " << summary.frames
              << " frames: " << run.no_ground
              << "; expected a floor, or --camera-height and --camera-pitch as they are\n";
    return kFailed;
  }
  if (input.without_pose > input.size) {
    std::cerr << "prospect: " << arguments.dataset << ": " << input.without_pose << " of "
              << input.size + input.without_pose
              << " frames have no pose and are left out; expected poses of most of them\n";
    return kFailed;
  }
  if (2 * summary.rejected > summary.frames) {
    std::cerr << "prospect: " << arguments.dataset << ": " << summary.rejected << " of "
              << summary.frames << " frames rejected, most often as " << summary.rejected_reason
              << "; expected most of them in the map\n";
    return kFailed;
  }
  return kDone;
}

}  // namespace

Command map_command(CLI::App& program) {
  const auto given = std::make_shared<MapArguments>();
  MapArguments& arguments = *given;
  CLI::App* command = program.add_subcommand(
      "map",
      "Octree, exploration and obstacle map from recorded depth images, stereo pairs or lidar "
      "scans");
  command
      ->add_option(
          "dataset", arguments.dataset,
          "Recording in 7-Scenes, TUM RGB-D or depth/NNN.png layout, ROS 2 bag, CARMEN log, "
          "or of a stereo pair, as for `prospect odometry`; see `prospect inspect`")
      ->type_name("FILE")
      ->required();
  command->add_option("--out", arguments.out, "Folder for a page, the maps and tables [none]")
      ->type_name("DIR");
  add_configuration(command, arguments.configuration, "; of it, perception");
  CLI::Option* resolution =
      add_key(command, arguments.configuration, {"--resolution", "perception.mapping.resolution"});
  resolution->description(resolution->get_description() + " [0.05]");
  command
      ->add_option("--range", arguments.range,
                   "Farther away nothing is learned [m] [of depth images 4, of a stereo pair where "
                   "two deviations of a depth are a voxel, of a lidar its own; to 200 voxels]")
      ->check(number_within(0.5, 200.0));
  command
      ->add_option("--camera", arguments.camera,
                   "Intrinsics where no file states them: FX FY CX CY [px]")
      ->expected(4)
      ->check(number_within(1.0, 1e5));
  add_recording_options(command, arguments.stereo);
  add_topics(command, arguments.stereo.topics,
             {"left", "right", "left_info", "right_info", "depth", "depth_info", "depth_1",
              "depth_2", "depth_3", "scan", "pose"});
  add_fixed_frame(command, arguments.options.fixed_frame);
  command
      ->add_option("--depth-scale", arguments.options.depth_scale,
                   "Numbers of the images a metre [the layout's, 1000 or 5000, checked against "
                   "poses or the camera's height]")
      ->check(number_within(1e-3, 1e6));
  command
      ->add_option("--camera-height", arguments.camera_height,
                   "Above the floor in the first frame [m] [0.2 to 2]")
      ->check(number_within(0.05, 10.0));
  command
      ->add_option("--camera-height-sigma", arguments.camera_height_sigma,
                   "How sure that is: standard deviation [m]")
      ->check(number_within(0.001, 1.0))
      ->capture_default_str();
  command
      ->add_option("--camera-pitch", arguments.camera_pitch,
                   "Down, in the first frames, to 15 deg [deg] [-15 to 55]")
      ->check(number_within(-90.0, 90.0));
  command
      ->add_option("--lidar-height", arguments.lidar_height,
                   "Above the floor, in the first scan [m] [as the poses say]")
      ->check(number_within(0.01, 100.0));
  command->add_option("--from", arguments.first, "Frame to begin with, from 0")
      ->check(whole_number_within(0, 1000000000))
      ->capture_default_str();
  command->add_option("--frames", arguments.frames, "At most so many [all]")
      ->check(whole_number_within(1, 1000000000));
  command->add_flag("--loops", arguments.loops,
                    "The poses drift: places that are seen again correct them, and the map");
  command->add_flag("--json", arguments.json, "Print the summary as JSON");
  command->add_flag("--quiet", arguments.quiet, "No progress line");
  return {command, [given](const Invocation& in) { return map(*given, in.signals); }};
}

}  // namespace prospect
