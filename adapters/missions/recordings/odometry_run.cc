// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/odometry_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <utility>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/files/csv.h"
#include "adapters/missions/recordings/recording_pipeline.h"
#include "adapters/missions/recordings/recording_range.h"

namespace prospect {
namespace {

/// Hands the samples of a recording over, those up to a pair and the next one before it.
class ImuFeed {
 public:
  ImuFeed(const ImuRecording& recording, double begin) : samples_(recording.samples) {
    constexpr double kBefore = 0.5;  // [s]
    while (next_ < samples_.size() && samples_[next_].stamp < begin - kBefore) ++next_;
    if (!samples_.empty()) seen_ = OdometryRun::Imu{};
  }
  void until(double stamp, PerceptionPipeline& perception) {
    if (!seen_) return;
    for (bool before = true; before && next_ < samples_.size(); ++next_) {
      before = samples_[next_].stamp <= stamp;
      ++seen_->samples;
      perception.imu(samples_[next_]);
    }
    const std::optional<Eigen::Vector3d> up = perception.inertial().up_in_W();
    if (up && !first_) first_ = up;
    seen_->tilt = up ? std::acos(std::clamp(up->dot(*first_), -1.0, 1.0))
                     : std::numeric_limits<double>::quiet_NaN();
  }
  void held(const PerceptionPipeline& perception) {
    if (!seen_) return;
    const InputCount& count = perception.input(InputSource::kImu);
    seen_->taken = count.taken;
    seen_->reason = count.reason;
    seen_->gyro_bias = perception.inertial().gyro_bias();
    seen_->gyro_bias_sigma = perception.inertial().gyro_bias_sigma();
    seen_->against = perception.inertial().contradicted();
  }
  const std::optional<OdometryRun::Imu>& seen() const { return seen_; }

 private:
  const std::vector<ImuSample>& samples_;
  std::size_t next_ = 0;
  std::optional<Eigen::Vector3d> first_;
  std::optional<OdometryRun::Imu> seen_;
};

}  // namespace

OdometryRun run_odometry(const StereoDataset& dataset, const StereoOdometryOptions& options,
                         int first, int max_frames,
                         const std::function<void(const OdometryStep&)>& observe,
                         const std::function<bool()>& cancelled, const InertialOptions& inertial) {
  cv::setNumThreads(1);  // one core, and nothing that depends on scheduling
  OdometryRun run;
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  const int n = frames_from(first, max_frames, dataset.size());
  if (n == 0) return run;
  const auto begin = associate({{dataset.stamp(first), start}}, dataset.ground_truth());
  if (!begin.empty()) start = begin[0].truth;
  auto owned = std::make_unique<StereoOdometry>(dataset.camera(), options, start);
  const StereoOdometry& odometry = *owned;
  PerceptionOptions perception_options = recording_options(start);
  perception_options.inertial = inertial;
  PerceptionPipeline perception(std::move(owned), dataset.camera(), perception_options);
  ImuFeed imu(dataset.imu(), dataset.stamp(first));
  OdometryConsistency consistency;
  Elements pairs("pairs");
  for (int i = first; i < first + n; ++i) {
    run.cancelled = cancelled && cancelled();
    if (run.cancelled) break;
    const double stamp = dataset.stamp(i);
    StereoDataset::Pair pair;
    if (!pairs.read([&] { pair = dataset.read(i); })) {
      OdometryFrame left_out;
      left_out.stamp = stamp;
      left_out.reason = pairs.why();
      left_out.T_WC = run.frames.empty() ? start : run.frames.back().T_WC;
      run.frames.push_back(left_out);
      continue;
    }
    imu.until(stamp, perception);
    const InputResult result =
        perception.stereo({stamp, stamp, pair.left.view(), pair.right.view()});
    run.frames.push_back(perception.frame());
    const bool processed = result.state == InputState::kTaken;
    if (!processed) {
      OdometryFrame left_out;
      left_out.stamp = stamp;
      left_out.reason = result.reason;
      left_out.T_WC = run.frames.back().T_WC;
      run.frames.back() = left_out;
    }
    const OdometryFrame& frame = run.frames.back();
    if (frame.state != Localization::kLost) run.trajectory.push_back({frame.stamp, frame.T_WC});
    const auto associated = associate({{frame.stamp, frame.T_WC}}, dataset.ground_truth());
    const auto truth = associated.empty() ? std::nullopt : std::optional(associated[0].truth);
    if (processed) consistency.add(odometry, frame, truth);
    if (observe) observe({i - first + 1, frame, odometry, pair, truth});
  }
  imu.held(perception);
  run.imu = imu.seen();
  run.consistency = consistency.result();
  run.pairs = associate(run.trajectory, dataset.ground_truth());
  run.pairs_w_first = associate(run.trajectory, dataset.ground_truth_w_first());
  if (pairs.bad() > 0) run.notes.push_back(pairs.note());
  if (run.cancelled) run.notes.push_back(cancelled_note(run.frames.size(), n));
  return run;
}

OdometrySummary summarize(const OdometryRun& run) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  OdometrySummary s;
  s.camera_time_offset = s.camera_time_offset_sigma = nan;
  std::vector<double> pyramids, tracking, pose, keyframe, frame, processor, processor_keyframe;
  bool was_lost = false;
  std::map<std::string, int> reasons;
  for (const OdometryFrame& f : run.frames) {
    ++s.frames;
    const bool lost = f.state == Localization::kLost;
    s.ok += f.state == Localization::kOk;
    s.degraded += f.state == Localization::kDegraded;
    s.lost += lost;
    if (lost) ++reasons[f.reason];
    s.losses += lost && !was_lost;
    was_lost = lost;
    s.restarts += f.restarted;
    s.keyframes += f.keyframe;
    pyramids.push_back(f.times.pyramids);
    tracking.push_back(f.times.tracking);
    pose.push_back(f.times.pose);
    frame.push_back(f.times.pyramids + f.times.tracking + f.times.pose);
    if (f.keyframe) keyframe.push_back(f.times.keyframe);
    (f.keyframe ? processor_keyframe : processor).push_back(f.times.processor);
    s.disparity_offset = f.disparity_offset;
    s.disparity_offset_sigma = f.disparity_offset_sigma;
    const bool timed = f.camera_time_offset_known;
    s.camera_time_offset = timed ? f.camera_time_offset : nan;
    s.camera_time_offset_sigma = timed ? f.camera_time_offset_sigma : nan;
    if (!f.out_of_step.empty()) s.out_of_step = f.out_of_step;
  }
  s.consistency = run.consistency;
  s.pyramids = percentiles(pyramids);
  s.tracking = percentiles(tracking);
  s.pose = percentiles(pose);
  s.keyframe = percentiles(keyframe);
  s.frame = percentiles(frame);
  s.processor = percentiles(processor);
  s.processor_keyframe = percentiles(processor_keyframe);
  const int located = s.frames - s.lost;
  s.covered = s.frames > 0 ? static_cast<double>(located) / s.frames : nan;
  s.covered_truth = s.frames > 0 ? static_cast<double>(run.pairs.size()) / s.frames : nan;
  s.mostly_lost = 2 * s.lost > s.frames || (s.lost > 0 && located < 2);
  if (located == 0) {
    s.disparity_offset = s.disparity_offset_sigma = nan;
    s.camera_time_offset = s.camera_time_offset_sigma = nan;
  }
  int most = 0;
  for (const auto& [reason, count] : reasons) {
    if (count <= most) continue;
    most = count;
    s.lost_reason = reason;
  }
  s.estimated_length = run.trajectory.size() < 2 ? nan : 0.0;
  for (std::size_t i = 1; i < run.trajectory.size(); ++i) {
    s.estimated_length +=
        (run.trajectory[i].T.translation() - run.trajectory[i - 1].T.translation()).norm();
  }
  s.true_length = run.pairs.size() < 2 ? nan : path_length(run.pairs);
  const TrajectoryErrors errors = trajectory_errors(run.pairs);
  s.ate_first = errors.ate_first;
  s.ate_fit = errors.ate_fit;
  s.end = errors.end;
  s.scale = scale_of(run.pairs);
  s.truth_turns_wrong = quaternion_order_problem(run.pairs, run.pairs_w_first);
  s.rpe_1m = relative_error(run.pairs, 1.0);
  s.rpe_10m = relative_error(run.pairs, 10.0);
  for (RelativeError* e : {&s.rpe_1m, &s.rpe_10m}) {
    if (e->segments == 0) e->translation = e->rotation = nan;
  }
  return s;
}

std::string frames_csv(const OdometryRun& run) {
  std::string text =
      "frame,stamp_s,state,keyframe,restarted,expected,tracked,confirmed,new,chi2_per_dof,"
      "x_m,y_m,z_m,sigma_position_m,disparity_offset_px,reason\n";
  char line[512];
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const OdometryFrame& f = run.frames[i];
    const Eigen::Vector3d t = f.T_WC.translation();
    std::snprintf(line, sizeof line, "%zu,%.9f,%s,%d,%d,%d,%d,%d,%d,%.3f,%.6f,%.6f,%.6f,%.6f,%.4f,",
                  i, f.stamp, to_string(f.state).data(), f.keyframe, f.restarted, f.expected,
                  f.tracked, f.confirmed, f.matched, f.chi2_per_dof, t.x(), t.y(), t.z(),
                  std::sqrt(f.covariance.topLeftCorner<3, 3>().trace()), f.disparity_offset);
    text += line + csv::field(f.reason) + '\n';
  }
  return text;
}

}  // namespace prospect
