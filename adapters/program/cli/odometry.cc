// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/degrees.h"
#include "adapters/formats/datasets/stereo_dataset.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/not_built_in.h"
#include "adapters/formats/files/output_folder.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/recordings/calibration_report.h"
#include "adapters/missions/recordings/odometry_calibration.h"
#include "adapters/missions/recordings/odometry_loops.h"
#include "adapters/missions/recordings/odometry_page.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "adapters/missions/recordings/recording_range.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"
#include "perception/pipeline/straight_map.h"

namespace prospect {
namespace {

constexpr const char* kWithLoops = "trajectory_with_loops.tum";

struct OdometryArguments {
  std::string dataset;  ///< a recording
  ConfigurationArguments configuration;
  StereoDatasetOptions options;
  std::string out;  ///< folder for trajectories and tables; empty: none
  int first = 0;    ///< frame to begin with
  int frames = 0;   ///< at most so many; 0: all
  bool calibrate = false;
  bool loops = false;  ///< views that come again straighten a second trajectory
  bool json = false;
  bool quiet = false;
};

nlohmann::ordered_json imu_json(const OdometryRun& run, const std::string& from) {
  if (!run.imu) return {};
  const OdometryRun::Imu& imu = *run.imu;
  return {{"from", from},
          {"samples", imu.samples},
          {"taken", imu.taken},
          {"left_out_because",
           imu.reason.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(imu.reason)},
          {"gyro_bias_rad_s", {imu.gyro_bias.x(), imu.gyro_bias.y(), imu.gyro_bias.z()}},
          {"gyro_bias_sigma_rad_s", imu.gyro_bias_sigma},
          {"up_moved_deg", kDegrees * imu.tilt},
          {"frames_contradicted", imu.against}};
}

void print_imu(const OdometryRun& run) {
  if (!run.imu) return;
  const OdometryRun::Imu& imu = *run.imu;
  std::printf(
      "IMU          %zu of %zu samples taken; it contradicts %d frames; bias of its gyro "
      "%.4f, %.4f, %.4f +- %.4f rad/s\n",
      imu.taken, imu.samples, imu.against, imu.gyro_bias.x(), imu.gyro_bias.y(), imu.gyro_bias.z(),
      imu.gyro_bias_sigma);
  if (!imu.reason.empty()) std::printf("             left out: %s\n", imu.reason.c_str());
  if (std::isfinite(imu.tilt)) {
    std::printf("             what is up by it has moved by %.2f deg\n", kDegrees * imu.tilt);
  }
}

nlohmann::ordered_json as_json(const std::string& name, const StereoDataset& dataset,
                               const std::vector<std::string>& notes, const OdometrySummary& s) {
  return {{"dataset", name},
          {"layout", dataset.layout()},
          {"notes", notes},
          {"frames", s.frames},
          {"ok", s.ok},
          {"degraded", s.degraded},
          {"lost", s.lost},
          {"losses", s.losses},
          {"restarts", s.restarts},
          {"keyframes", s.keyframes},
          {"covered_percent", 100.0 * s.covered},
          {"ground_truth", !dataset.ground_truth().empty()},
          {"covered_by_truth_percent", 100.0 * s.covered_truth},
          {"lost_reason", s.lost_reason.empty() ? nlohmann::ordered_json()
                                                : nlohmann::ordered_json(s.lost_reason)},
          {"estimated_length_m", s.estimated_length},
          {"true_length_m", s.true_length},
          {"scale", s.scale.samples > 0 ? s.scale.ratio : std::nan("")},
          {"calibration_refused", s.scale.verdict == ScaleAgreement::Verdict::kDisagree},
          {"end_error_m", s.end.translation},
          {"end_error_percent", 100.0 * s.end.share},
          {"end_rotation_deg", kDegrees * s.end.rotation},
          {"rpe_1m_percent", 100.0 * s.rpe_1m.translation},
          {"rpe_1m_deg_per_m", kDegrees * s.rpe_1m.rotation},
          {"rpe_10m_percent", 100.0 * s.rpe_10m.translation},
          {"rpe_10m_deg_per_m", kDegrees * s.rpe_10m.rotation},
          {"ate_first_pose_rmse_m", s.ate_first.rmse},
          {"ate_best_fit_rmse_m", s.ate_fit.rmse},
          {"consistency", consistency_json(s.consistency)},
          {"disparity_offset_px", s.disparity_offset},
          {"disparity_offset_sigma_px", s.disparity_offset_sigma},
          {"camera_time_offset_ms", 1e3 * s.camera_time_offset},
          {"camera_time_offset_sigma_ms", 1e3 * s.camera_time_offset_sigma},
          {"out_of_step", s.out_of_step},
          {"ms",
           {{"frame", times_json(s.frame)},
            {"pyramids", times_json(s.pyramids)},
            {"tracking", times_json(s.tracking)},
            {"pose", times_json(s.pose)},
            {"keyframe", times_json(s.keyframe)},
            {"processor", times_json(s.processor)},
            {"processor_keyframe", times_json(s.processor_keyframe)}}}};
}

void print(const OdometrySummary& s, bool truth) {
  std::printf("frames       %d: %d ok, %d degraded, %d lost (%d times); %d keyframes\n", s.frames,
              s.ok, s.degraded, s.lost, s.losses, s.keyframes);
  std::printf("covered      %.1f %% of the frames have a pose", 100.0 * s.covered);
  if (truth) std::printf(", %.1f %% are held against the truth", 100.0 * s.covered_truth);
  std::printf("\n");
  if (s.restarts > 0) std::printf("new maps     %d after a loss\n", s.restarts);
  if (std::isfinite(s.true_length)) {
    std::printf("length       %.3f m estimated, %.3f m true", s.estimated_length, s.true_length);
    if (s.scale.samples > 0) std::printf("; scale %.4f +- %.4f", s.scale.ratio, s.scale.sigma);
    std::printf("\n");
    std::printf("end error    %.4f m", s.end.translation);
    if (std::isfinite(s.end.share)) std::printf(", %.3f %% of the path", 100.0 * s.end.share);
    std::printf("; %.3f deg\n", kDegrees * s.end.rotation);
    if (s.rpe_1m.segments > 0) {
      std::printf("per 1 m      %.3f %%, %.4f deg/m over %d segments\n",
                  100.0 * s.rpe_1m.translation, kDegrees * s.rpe_1m.rotation, s.rpe_1m.segments);
    }
    if (s.rpe_10m.segments > 0) {
      std::printf("per 10 m     %.3f %%, %.4f deg/m over %d segments\n",
                  100.0 * s.rpe_10m.translation, kDegrees * s.rpe_10m.rotation, s.rpe_10m.segments);
    }
    std::printf("ATE          %.4f m rmse with the first pose aligned, %.4f m with the best fit\n",
                s.ate_first.rmse, s.ate_fit.rmse);
  } else {
    if (std::isfinite(s.estimated_length)) {
      std::printf("length       %.3f m estimated", s.estimated_length);
    } else {
      std::printf("length       none: fewer than two frames have a pose");
    }
    std::printf("; %s\n", truth ? "no two poses to hold against the truth" : "no ground truth");
  }
  if (s.consistency.pose.count > 0) {
    std::printf("NEES         %.2f of the pose", s.consistency.pose.mean);
    for (const ConsistencyResult::Motion& m : s.consistency.motions) {
      if (m.consistency.count == 0) continue;
      std::printf(", %.2f over %d frames", m.consistency.mean, m.frames);
    }
    std::printf(" (1: as claimed)\n");
  }
  if (std::isfinite(s.disparity_offset)) {
    std::printf("disparities  measured %.3f +- %.3f px too small, corrected\n", s.disparity_offset,
                s.disparity_offset_sigma);
  }
  if (std::isfinite(s.camera_time_offset)) {
    std::printf("right camera %.1f +- %.1f ms later than the left one\n",
                1e3 * s.camera_time_offset, 1e3 * s.camera_time_offset_sigma);
  } else {
    std::printf(
        "right camera not known how much later than the left one: the motion does not tell\n");
  }
  if (!s.out_of_step.empty()) std::printf("out of step  %s\n", s.out_of_step.c_str());
  const auto row = [](const char* name, const TimePercentiles& t) {
    if (!std::isfinite(t.p50)) return;
    std::printf("%-13s %6.1f %6.1f %6.1f %6.1f\n", name, t.p50, t.p95, t.p99, t.max);
  };
  std::printf("time [ms]        p50    p95    p99    max\n");
  row("  frame", s.frame);
  row("    pyramids", s.pyramids);
  row("    tracking", s.tracking);
  row("    pose", s.pose);
  row("  keyframe", s.keyframe);
  std::printf("processor time [ms], all of a frame\n");
  row("  without one", s.processor);
  row("  keyframes", s.processor_keyframe);
}

/// What loops made of the trajectory, beside what it is without them.
struct LoopedTrajectory {
  OdometryLoopsResult loops;
  TrajectoryErrors final, online;

  LoopedTrajectory(OdometryLoopsResult result, const Trajectory& truth)
      : loops(std::move(result)),
        final(trajectory_errors(associate(loops.final, truth))),
        online(trajectory_errors(associate(loops.online, truth))) {}
};

nlohmann::ordered_json loops_json(const LoopedTrajectory& looped) {
  const auto& [loops, final, online] = looped;
  return {{"views", loops.views},
          {"found", loops.found},
          {"used", loops.used},
          {"moved_m", loops.farthest},
          {"end_error_m", final.end.translation},
          {"end_rotation_deg", kDegrees * final.end.rotation},
          {"ate_first_pose_rmse_m", final.ate_first.rmse},
          {"ate_best_fit_rmse_m", final.ate_fit.rmse},
          {"ate_first_pose_rmse_online_m", online.ate_first.rmse},
          {"ate_best_fit_rmse_online_m", online.ate_fit.rmse}};
}

void print_loops(const LoopedTrajectory& looped) {
  const auto& [loops, final, online] = looped;
  std::printf("loops        %d of %d used, among %d views; a pose moved by %.2f m at most\n",
              loops.used, loops.found, loops.views, loops.farthest);
  if (std::isfinite(final.ate_fit.rmse)) {
    std::printf(
        "with loops   ATE %.4f m rmse with the first pose aligned, %.4f m with the best fit; "
        "end error %.4f m\n",
        final.ate_first.rmse, final.ate_fit.rmse, final.end.translation);
    std::printf(
        "  as it went ATE %.4f m rmse with the first pose aligned, %.4f m with the best fit\n",
        online.ate_first.rmse, online.ate_fit.rmse);
  }
  std::printf("  processor  %.1f ms a view in the median, %.1f ms at most\n", loops.processor.p50,
              loops.processor.max);
}

int odometry(const OdometryArguments& arguments, SignalGuard& signals) {
  if (arguments.loops && !StraightMap::is_built_in()) {
    throw NotBuiltIn("--loops", "Ceres (libceres-dev)");
  }
  const PerceptionOptions perception =
      read_told_perception(arguments.configuration, {}, ConfigurationUse::kOdometry);
  const StereoOdometryOptions& options = perception.odometry;
  Progress progress(arguments.quiet);
  progress.show("reading " + arguments.dataset);
  const StereoDataset dataset = StereoDataset::open(arguments.dataset, arguments.options);
  check_first_frame(arguments.first, dataset.size(), arguments.dataset);
  progress.finish();
  signals.note();
  std::optional<OutputFolder> out;
  if (!arguments.out.empty()) {
    out = OutputFolder::own(arguments.out, {"odometry"});
    std::vector<std::string> names = {"trajectory.tum", "trajectory.kitti", "frames.csv",
                                      "odometry.html", "summary.json"};
    if (arguments.loops) names.push_back(kWithLoops);
    out->begin(names);
  }
  const int frames = frames_from(arguments.first, arguments.frames, dataset.size());
  std::optional<OdometryCalibration> calibration;
  if (arguments.calibrate) calibration.emplace(dataset.camera(), options);
  std::optional<OdometryPage> page;
  if (out) page.emplace(frames);
  std::optional<OdometryLoops> loops;
  if (arguments.loops) loops.emplace(dataset.camera());
  const auto observe = [&](const OdometryStep& step) {
    const OdometryFrame& frame = step.frame;
    if (calibration) calibration->add(step.odometry, frame, step.true_T_WC);
    if (page) page->add(step);
    if (loops) loops->add(step);
    progress.show(std::to_string(step.done) + " of " + std::to_string(frames) + " frames  " +
                  std::to_string(frame.tracked) + " points  " +
                  std::string(to_string(frame.state)));
  };
  const OdometryRun run = run_odometry(dataset, options, arguments.first, frames, observe,
                                       signals.came(), perception.inertial);
  progress.finish();
  const OdometrySummary summary = summarize(run);
  std::vector<std::string> notes = dataset.notes();
  notes.insert(notes.end(), run.notes.begin(), run.notes.end());
  auto json = as_json(arguments.dataset, dataset, notes, summary);
  json["imu"] = imu_json(run, dataset.imu().from);
  std::optional<OdometryCalibrationResult> calibrated;
  if (calibration) {
    calibrated = calibration->result();
    json["calibration"] = calibration_json(*calibrated);
  }
  std::optional<LoopedTrajectory> looped;
  if (loops) {
    looped.emplace(loops->result(), dataset.ground_truth());
    json["loops"] = loops_json(*looped);
    json["ms"]["loops"] = times_json(looped->loops.processor);
  }
  if (page) {
    auto timeless = json;
    timeless.erase("ms");
    std::vector<std::pair<const char*, std::string>> files = {
        {"trajectory.tum", tum_text(run.trajectory)},
        {"trajectory.kitti", kitti_text(run.trajectory)},
        {"frames.csv", frames_csv(run)},
        {"odometry.html", page->html(timeless, looped ? &looped->loops : nullptr)},
        {"summary.json", json.dump(2) + "\n"}};
    if (looped) files.emplace_back(kWithLoops, tum_text(looped->loops.final));
    for (const auto& [name, content] : files) {
      const std::string problem = out->write(name, content);
      if (!problem.empty()) {
        std::cerr << "prospect: " << arguments.out << '/' << name << ": " << problem << '\n';
        return kFailed;
      }
    }
    if (!run.cancelled) out->complete();
  }
  if (arguments.json) {
    std::cout << json.dump(2) << '\n';
  } else {
    std::printf("%s, %d pairs of %.0f x %.0f px\n", dataset.layout().c_str(), dataset.size(),
                dataset.camera().left.width, dataset.camera().left.height);
    for (const std::string& note : notes) std::printf("note         %s\n", note.c_str());
    print(summary, !dataset.ground_truth().empty());
    print_imu(run);
    if (looped) print_loops(*looped);
    if (calibrated) std::fputs(calibration_text(*calibrated).c_str(), stdout);
    if (out) std::printf("written to   %s\n", out->path().c_str());
  }
  if (run.cancelled) {
    std::cerr << "prospect: " << cancelled_note(run.frames.size(), frames) << '\n';
    return kCancelled;
  }
  if (!summary.truth_turns_wrong.empty()) {
    std::cerr << "prospect: " << arguments.dataset << ": " << summary.truth_turns_wrong << '\n';
    return kBadInput;
  }
  if (summary.scale.verdict == ScaleAgreement::Verdict::kDisagree) {
    std::cerr << "prospect: " << arguments.dataset << ": "
              << to_string(summary.scale, "the path is estimated", "the ground truth")
              << "; expected 5 % at most: "
              << (summary.out_of_step.empty()
                      ? "the baseline or focal length of its calibration is wrong"
                      : summary.out_of_step)
              << '\n';
    return kBadInput;
  }
  if (summary.mostly_lost) {
    std::cerr << "prospect: " << arguments.dataset << ": " << summary.lost << " of "
              << summary.frames << " frames lost, most often as " << summary.lost_reason
              << "; expected a pose of most of them\n";
    return kFailed;
  }
  return kDone;
}

}  // namespace

Command odometry_command(CLI::App& program) {
  const auto given = std::make_shared<OdometryArguments>();
  OdometryArguments& arguments = *given;
  CLI::App* command =
      program.add_subcommand("odometry", "Visual odometry over a recording of a stereo pair");
  command
      ->add_option(
          "dataset", arguments.dataset,
          "Recording: KITTI odometry or raw, EuRoC, ROS 2 bag, or two folders of images or videos "
          "with a calibration; see `prospect inspect`")
      ->type_name("FILE")
      ->required();
  add_configuration(command, arguments.configuration, "; of it, perception");
  add_recording_options(command, arguments.options);
  add_topics(command, arguments.options.topics,
             {"left", "right", "left_info", "right_info", "truth", "imu"});
  command
      ->add_option("--out", arguments.out,
                   "Folder for a page, the trajectory (TUM and KITTI), a table of frames and a "
                   "summary [none]")
      ->type_name("DIR");
  command->add_option("--from", arguments.first, "Frame to begin with, from 0")
      ->check(whole_number_within(0, 1000000000))
      ->capture_default_str();
  command->add_option("--frames", arguments.frames, "At most so many [all]")
      ->check(whole_number_within(1, 1000000000));
  command->add_flag("--calibrate", arguments.calibrate,
                    "Hold what the planner predicts of landmarks and motion against what "
                    "came of it");
  command->add_flag("--loops", arguments.loops,
                    "Straighten a second trajectory by views that come again; the first one stays");
  command->add_flag("--json", arguments.json, "Print the summary as JSON");
  command->add_flag("--quiet", arguments.quiet, "No progress line");
  return {command, [given](const Invocation& in) { return odometry(*given, in.signals); }};
}

}  // namespace prospect
