// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/stereo_odometry.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "engine/support/stopwatch.h"
#include "models/knobs.h"
#include "models/reason.h"
#include "perception/odometry/camera_time_offset.h"
#include "perception/odometry/corner_detector.h"
#include "perception/odometry/disparity_offset.h"
#include "perception/odometry/drift_measurement.h"
#include "perception/odometry/frame_clock.h"
#include "perception/odometry/frame_location.h"
#include "perception/odometry/frozen_images.h"
#include "perception/odometry/image_grid.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/keyframe.h"
#include "perception/odometry/keyframe_policy.h"
#include "perception/odometry/landmark_search.h"
#include "perception/odometry/median.h"
#include "perception/odometry/motion_prior.h"
#include "perception/odometry/point_observation.h"
#include "perception/odometry/pose_drift.h"
#include "perception/odometry/pose_estimation.h"
#include "perception/odometry/pose_judgement.h"
#include "perception/odometry/recall.h"
#include "perception/odometry/residual_noise.h"
#include "perception/odometry/se3.h"
#include "perception/odometry/second_motion.h"
#include "perception/odometry/shared_errors.h"
#include "perception/odometry/still_view.h"
#include "perception/odometry/track.h"
#include "perception/odometry/track_passes.h"
#include "perception/odometry/track_survival.h"
#include "perception/odometry/trusted_pose.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2f;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Poses of so many frames stand in the joint covariance beside the anchors, for
/// covariance_since(), under a number of their own.
constexpr std::uint64_t kRememberedFrames = 20;
/// Level of the pyramids, of the smallest images by which a frame is located.
constexpr int kSmallest = 2;
/// Probability of another motion from which on the pose is degraded.
constexpr double kDoubt = 0.01;
/// Landmarks of the world that tell a pose that is its own from that of something which moves: so
/// many at least, and a tenth of all, for some agree with anything.
constexpr int kLeastKnown = 3, kKnownShare = 10;
/// Part of the accelerations that an IMU leaves unknown before any motion was seen.
constexpr double kLeftByImu = 1.0 / 6.0;
std::uint64_t of_frame(std::uint64_t frame) { return (std::uint64_t{1} << 63) | frame; }

/// What is made of the images of a frame.
struct FrameImages {
  ImagePyramid left;
  std::shared_ptr<const ImagePyramid> right;  // its lowest level only

  FrameImages(const ImageView& left_image, const ImageView& right_image, int levels)
      : left(left_image, levels), right(std::make_shared<const ImagePyramid>(right_image, 1)) {}
  const PyramidLevel& coarse() const { return left.level(left.levels() - 1); }
  const PyramidLevel& middle() const { return left.level(std::min(2, left.levels() - 1)); }
};

/// A frame's place, and whether it is to be taken.
struct Candidate {
  FrameLocation location;
  PoseJudgement judgement;
};

std::string wrong_size(const PinholeCamera& camera, const ImageView& left, const ImageView& right) {
  const auto wrong = [&](const ImageView& image) {
    return image.empty() || image.stride < image.width ||
           image.width != static_cast<int>(camera.width) ||
           image.height != static_cast<int>(camera.height);
  };
  if (wrong(left)) return "the left image has the wrong size";
  if (wrong(right)) return "the right image has the wrong size";
  return {};
}

}  // namespace

struct StereoOdometry::Impl {
  Impl(const StereoCamera& stereo_camera, const StereoOdometryOptions& all_options,
       const Isometry3d& initial_T_WC)
      : camera(stereo_camera),
        options(all_options),
        recalls(options.recovery_keyframes),
        clock(options.max_gap),
        as_before(options.motion),
        as_measured(options.motion),
        as_by_imu({kLeftByImu * options.motion.acceleration,
                   kLeftByImu * options.motion.turn_acceleration}),
        time_offset(options.time_offset),
        drift(calibration_covariance(options.calibration,
                                     options.disparity_offset.prior_sigma(camera.left.fx))),
        survival(options.survival) {
    camera.sigma_u = camera.sigma_v = options.sigma_corner;
    camera.sigma_d = options.sigma_disparity;
    trusted.T_CW = keyframe.T_CW = initial_T_WC.inverse();
  }

  StereoCamera camera;
  StereoOdometryOptions options;

  // The map.
  bool started = false;
  std::vector<Track> tracks;
  std::uint64_t next_id = 1, newest_anchor = 0;
  Keyframe keyframe;
  RecallMemory recalls;
  std::optional<LandmarkSearch> search;

  // The newest frames.
  std::uint64_t frame = 0;
  FrameClock clock;
  FrozenImages images;  // the last ones that were new
  TrustedPose trusted;
  std::vector<LandmarkSighting> sightings;  // of this frame, as in the header
  std::vector<std::uint64_t> given_up;

  // What moves.
  // The motion from the one before, from the one that is given, from that by an IMU.
  MotionPrior as_before, as_measured, as_by_imu;
  std::optional<Isometry3d> by_imu;  // to the next frame
  SecondMotion second;
  bool may_be_carried = false;    // what the newest frame tracks
  bool in_smaller_image = false;  // the newest frame was located there only
  /// Landmarks that were there when the map began, or were found with enough of such.
  std::unordered_set<std::uint64_t> of_world;
  std::optional<double> unknown_since;  // when it was last known to be the world; none: it is [s]

  // What is learned on the way.
  double offset = 0.0;  // of all disparities, see disparity_offset.h [px]
  CameraTimeOffset time_offset;
  ResidualNoise noise;
  PoseDrift drift;
  Matrix6d covariance = Matrix6d::Zero();  // at the trusted pose, against the start
  struct Remembered {
    Isometry3d T_CW;
    SecondMotion::Sum second;
  };
  std::map<std::uint64_t, Remembered> remembered;  // measured frames, by their number
  SecondMotion::Sum second_at_keyframe;
  double keyframe_stamp = 0.0;  // [s]
  TrackSurvival survival;
  double row_error = 0.0;

  OdometryFrame process(double stamp, const ImageView& left, const ImageView& right,
                        const std::optional<Isometry3d>& motion);

  /// The frame is done.
  OdometryFrame finished(OdometryFrame& out, Localization state, const std::string& reason) const {
    out.state = state;
    if (!reason.empty()) add_reason(out.reason, reason);
    out.T_WC = trusted.T_CW.inverse();
    out.covariance = covariance + second.covariance(trusted.T_CW);
    out.row_error = row_error;
    out.disparity_offset = offset;
    out.disparity_offset_sigma = std::sqrt(drift.calibration_variance(kDisparityError));
    out.camera_time_offset_known = time_offset.known();
    out.camera_time_offset = time_offset.value();
    out.camera_time_offset_sigma = time_offset.sigma();
    out.camera_time_offset_depth = time_offset.depth_sigma();
    return out;
  }

  /// Nothing was measured at `stamp`: hold the pose, and let its covariance grow with what the
  /// robot may have done since. It goes on as it did or otherwise, but not each frame anew: the
  /// deviation grows with the time, not with its root.
  void hold(double stamp) {
    if (!started) return;  // the first pose is where the map begins
    const double since = std::max(0.0, stamp - trusted.stamp);
    const double before = std::clamp(since - clock.step(), 0.0, since);
    const double squares = since * since - before * before;
    double t = SecondMotion::kUnknownSpeed, w = SecondMotion::kUnknownTurn;
    if (trusted.velocity) {
      t = 0.2 + trusted.velocity->head<3>().norm();
      w = 0.2 + trusted.velocity->tail<3>().norm();
    }
    covariance.diagonal().head<3>().array() += squares * t * t;
    covariance.diagonal().tail<3>().array() += squares * w * w;
  }

  /// Cells of the image with sides of `cell` [px].
  ImageGrid grid(double cell) const { return {camera.left.width, camera.left.height, cell}; }
  /// Side of those that hold a corner each [px].
  double corner_cell() const {
    return prospect::corner_cell(static_cast<int>(camera.left.width),
                                 static_cast<int>(camera.left.height), options.corners);
  }

  TrackObservations observations() const {
    return observe_tracks(
        tracks, {options.sigma_corner, options.sigma_corner, options.sigma_disparity}, offset);
  }

  /// What is expected of the motion to the frame at `stamp`.
  MotionExpectation expectation(double stamp, const std::optional<Isometry3d>& motion) const {
    MotionExpectation expected;
    expected.T_CW = trusted.T_CW;
    expected.dt = stamp - trusted.stamp;
    expected.before = &trusted;
    expected.moving_T_CW = second.expected(stamp);
    if (motion && motion->matrix().allFinite()) {
      expected.T_CW = motion->inverse() * trusted.T_CW;
      expected.prior = &as_measured;
    } else if (by_imu) {
      expected.T_CW = by_imu->inverse() * trusted.T_CW;
      if (trusted.velocity && !clock.gap()) expected.prior = &as_by_imu;
    } else if (trusted.velocity && !clock.gap()) {
      expected.T_CW = trusted.continued(stamp);
      expected.prior = &as_before;
    }
    return expected;
  }

  /// Where the frame was taken: from where the robot should be by `motion` or as it moved before;
  /// if that fails, once more as if nothing had been measured, from where it was, and from the
  /// newest views that were kept; then by smaller images. Changes the tracks to those that were
  /// found.
  Candidate locate(double stamp, const FrameImages& now, const std::optional<Isometry3d>& motion,
                   OdometryTimes& times) {
    const MotionExpectation expected = expectation(stamp, motion);
    const auto from = [&](std::vector<Track>& points, const Isometry3d& prior, bool trust_prior,
                          int level = 0) {
      const ImagePyramid smaller =
          level > 0 ? ImagePyramid(images.right()->view(), level + 1) : ImagePyramid();
      const FrameLocator locator(camera, options, offset, options.seed + frame, now.left,
                                 level > 0 ? smaller : *now.right, times);
      Candidate candidate{locator.locate(points, prior, trust_prior, expected, level), {}};
      candidate.judgement =
          judge_pose(candidate.location, points, trusted, stamp, camera.left, options);
      return candidate;
    };
    const auto turned = [&](const Isometry3d& T_CW, const PyramidLevel& before) {
      return turned_by_shift(T_CW, before, now.coarse(), camera.left);
    };
    const auto gone_on = [&] {
      return trusted.velocity ? trusted.continued(stamp) : turned(trusted.T_CW, trusted.coarse);
    };
    const bool measured = (motion && motion->matrix().allFinite()) || by_imu;
    in_smaller_image = false;
    Candidate candidate = from(tracks, measured ? expectation(stamp, motion).T_CW : gone_on(),
                               measured || (trusted.velocity && !clock.gap()));
    if (candidate.judgement.state != Localization::kLost) return candidate;
    if (!second.seen()) {  // a pose that is not taken says nothing of what moves
      for (Track& t : tracks) t.moving = false;
    }

    const auto retry = [&](std::vector<Track> points, const Isometry3d& prior, int level = 0) {
      Candidate other = from(points, prior, false, level);
      if (other.judgement.state == Localization::kLost) return false;
      candidate = std::move(other);
      tracks = std::move(points);
      return true;
    };
    if (measured && trusted.velocity && retry(tracks, gone_on())) return candidate;
    // After a while of blur or darkness a robot that has gone on is nowhere near.
    const double since = stamp - trusted.stamp;
    if (trusted.velocity && since > TrustedPose::kLikely &&
        retry(tracks, trusted.continued(stamp, since))) {
      return candidate;
    }
    if (retry(tracks, turned(trusted.T_CW, trusted.coarse))) return candidate;
    for (auto recall = recalls.all().rbegin(); recall != recalls.all().rend(); ++recall) {
      if (retry(recall->tracks, turned(recall->T_CW, recall->coarse))) return candidate;
    }
    // What blur or noise hides is there in smaller images.
    for (int level = 1; level <= std::min(kSmallest, now.left.levels() - 2); ++level) {
      if (!retry(tracks, gone_on(), level)) continue;
      in_smaller_image = true;
      add_reason(candidate.judgement.reason, "points are found in a smaller image only");
      break;
    }
    return candidate;
  }

  /// The frame's pose is the newest that is trusted.
  void take(const Candidate& candidate, double stamp, const FrameImages& now,
            const std::optional<Isometry3d>& motion, OdometryFrame& out) {
    const bool unproven = may_be_carried = carried(candidate.location, now, motion);
    const bool unknown = !known_world(stamp);
    if (unproven || unknown) second.unknown(stamp - trusted.stamp);
    if (!unproven) take_second(candidate.location, stamp, motion);
    covariance = covariance_of(candidate.location.pose);
    trusted.take(candidate.location.pose.T_CW, stamp, now.coarse());
    trusted.middle = now.middle();
    if (unproven) {
      trusted.velocity.reset();
      add_reason(out.reason, "what is tracked rests, the view does not: it may be carried");
    }
    if (unknown) add_reason(out.reason, "hardly anything seen before is tracked: it may move");
    out.covariance_since_keyframe =
        drift.since(keyframe.anchor, trusted.T_CW * keyframe.T_CW.inverse()) +
        second.covariance_since(second_at_keyframe, trusted.T_CW);
    remember_pose();
  }

  /// Whether what is tracked is known to be the world: enough of it was there before what was found
  /// last, or went with such. Where all that was seen before has vanished, what came instead may
  /// move on its own. After as long as a loss makes a new map it is the world all the same: what
  /// the camera did meanwhile is counted. Before the pose is taken.
  bool known_world(double stamp) {
    int found = 0, known = 0;
    for (const Track& t : tracks) {
      found += t.inlier;
      known += t.inlier && of_world.contains(t.id);
    }
    const bool late = options.restart_after > 0.0 && unknown_since &&
                      stamp - *unknown_since > options.restart_after;
    if ((known < kLeastKnown || kKnownShare * known < found) && !late) {
      if (!unknown_since) unknown_since = trusted.stamp;
      return false;
    }
    unknown_since.reset();
    for (const Track& t : tracks) {
      if (t.inlier) of_world.insert(t.id);
    }
    return true;
  }

  /// Only of landmarks that may be seen again.
  void forget_of_world() {
    std::unordered_set<std::uint64_t> kept;
    const auto keep = [&](const std::vector<Track>& points) {
      for (const Track& t : points) {
        if (of_world.contains(t.id)) kept.insert(t.id);
      }
    };
    keep(tracks);
    for (const Recall& recall : recalls.all()) keep(recall.tracks);
    of_world = std::move(kept);
  }

  /// What the frame says of the motion's prior, and of what moves against the world. Before the
  /// pose is taken.
  void take_second(const FrameLocation& location, double stamp,
                   const std::optional<Isometry3d>& motion) {
    const MotionExpectation expected = expectation(stamp, motion);
    if (expected.prior != nullptr) {
      const Vector6d change = log_se3(location.pose.T_CW * expected.T_CW.inverse());
      MotionPrior& prior = expected.prior == &as_before     ? as_before
                           : expected.prior == &as_measured ? as_measured
                                                            : as_by_imu;
      prior.add(change, expected.dt);
    }
    if (location.second) {
      if (!second.seen()) {
        second.begin(trusted.T_CW, trusted.stamp, trusted.velocity, location.second->log_odds);
      }
      second.see(location.pose.T_CW, location.second->T_CW, stamp);
    } else if (second.seen() &&
               stamp - second.stamp() > (options.max_misses + 0.5) * clock.period()) {
      forget_second();
    }
  }
  /// What was moving is out of sight.
  void forget_second() {
    second.end();
    std::erase_if(tracks, [](const Track& t) { return t.moving; });
  }
  /// Whether the camera, at this pose, moves against the landmarks that were and are seen by less
  /// than a pixel.
  bool rests(const Isometry3d& T_CW) const {
    std::vector<double> flow;
    for (const Track& t : tracks) {
      if (!t.inlier) continue;
      const std::optional<double> moved = image_flow(camera, t.position, trusted.T_CW, T_CW);
      if (moved) flow.push_back(*moved);
    }
    return !flow.empty() && median(flow) < kRestingFlow;
  }

  /// Whether what is tracked rests while the view does not: it may be carried. Before the pose is
  /// taken.
  bool carried(const FrameLocation& location, const FrameImages& now,
               const std::optional<Isometry3d>& motion) const {
    if (location.second || second.seen() || !rests(location.pose.T_CW)) return false;
    if (motion && rests(motion->inverse() * trusted.T_CW)) return false;
    return still_view(trusted.middle, now.middle()).moves(may_be_carried);
  }

  /// Covariance of a pose against the start.
  Matrix6d covariance_of(const PoseEstimate& pose) {
    noise.add(pose.chi2_per_dof, pose.degrees);
    const TrackObservations seen = observations();
    return drift.measure(DriftMeasurement(camera, tracks, seen, pose, options.pose,
                                          options.shared_errors, noise.variance())
                             .of_pose());
  }

  /// The right image shows few of the landmarks near their rows: where it shows them otherwise,
  /// which is what a time between the images does.
  void find_rows(const ImageView& right) {
    if (!time_offset.estimated()) return;
    const auto tracked =
        std::count_if(tracks.begin(), tracks.end(), [](const Track& t) { return t.inlier; });
    const auto shown = std::count_if(tracks.begin(), tracks.end(),
                                     [](const Track& t) { return t.inlier && t.in_right; });
    if (2 * shown >= tracked) return;
    track_rows(tracks, trusted.T_CW, ImagePyramid(right, options.pyramid_levels), camera, offset,
               options);
  }

  /// What the newest pose says about the disparity offset; then all landmarks move with it.
  void update_offset(const PoseEstimate& pose) {
    const double prior = options.disparity_offset.prior_sigma(camera.left.fx);
    if (!(prior > 0.0)) return;
    const TrackObservations seen = observations();
    const Vector3d here = pose.T_CW.inverse().translation();
    std::vector<char> speaks(seen.index.size(), 0);
    int speaking = 0;
    for (std::size_t k = 0; k < seen.index.size(); ++k) {
      const Track& t = tracks[seen.index[k]];
      const double moved = (here - t.anchor->T_CW.inverse().translation()).norm();
      speaks[k] =
          pose.inlier[k] && moved >= options.disparity_offset.min_baseline * t.in_anchor.z();
      speaking += speaks[k];
    }
    if (speaking < options.disparity_offset.min_points) return;
    const auto evidence = DriftMeasurement(camera, tracks, seen, pose, options.pose,
                                           options.shared_errors, noise.variance())
                              .of_disparity_zero(speaks);
    if (!evidence) return;
    const double walk = options.disparity_offset.walk_sigma;
    const double most = options.disparity_offset.max_offset;
    offset =
        std::clamp(offset + drift.estimate(*evidence, walk * walk, prior * prior), -most, most);
    for (Track& t : tracks) place_track(t, camera, offset);
    for (Recall& recall : recalls.all()) {
      for (Track& t : recall.tracks) place_track(t, camera, offset);
    }
  }

  /// Enters what the frame shows of the landmarks in the sightings and in what is learned of how
  /// long they live.
  void count() {
    for (Track& t : tracks) {
      if (t.moving) {
        t.misses = t.tracked ? 0 : t.misses + 1;
        continue;
      }
      if (!t.in_view) {
        ++t.misses;  // out of view for long: gone, it would be found from a keyframe
        continue;
      }
      const Vector3d Y = trusted.T_CW * t.position;
      if (t.inlier) {
        sightings.push_back({t.id, t.left.cast<double>(), true, false});
      } else if (Y.z() > 0.0) {
        sightings.push_back({t.id, camera.left.project(Y), false, false});
      }
      if (in_full_view(t, trusted.T_CW, camera, options.max_scale)) {
        if (t.misses == 0) {
          survival.add(t.found, t.inlier);
        } else {
          survival.add_missed(t.inlier);
        }
      }
      t.found += t.inlier;
      t.misses = t.inlier ? 0 : t.misses + 1;
    }
    survival.forget();
  }

  /// One landmark an image cell: the oldest, which ties this frame to the earliest keyframe.
  void thin_out() {
    const ImageGrid cells = grid(corner_cell());
    std::vector<char> taken(cells.cells(), 0);
    std::erase_if(tracks, [&](const Track& t) {
      if (t.moving) return false;
      char& full = taken[cells.cell(t.left)];
      if (full) {
        given_up.push_back(t.id);
        return true;
      }
      full = 1;
      return false;
    });
  }

  /// A keyframe begins at the trusted pose, with the landmarks that are there; new ones are to be
  /// found where its image has none.
  void begin_keyframe(FrameImages now, bool in_background) {
    keyframe = {++newest_anchor, trusted.T_CW, {}};
    second_at_keyframe = second.sum();
    keyframe_stamp = trusted.stamp;
    std::vector<Vector2f> occupied;
    for (Track& t : tracks) {
      Keyframe::see(t);
      if (t.inlier || (t.moving && t.tracked)) occupied.push_back(t.left);
    }
    auto anchor = std::make_shared<Anchor>();
    anchor->id = newest_anchor;
    anchor->left = std::move(now.left);
    anchor->T_CW = trusted.T_CW;
    search.emplace(std::move(anchor), trusted.coarse, images.left(), std::move(now.right),
                   std::move(occupied), options, in_background);
  }

  /// A view to come back to.
  void remember_view(const Isometry3d& T_CW, const PyramidLevel& coarse) {
    Recall recall{T_CW, coarse, tracks};
    std::erase_if(recall.tracks, [](const Track& t) { return t.moving; });
    recalls.add(std::move(recall));
  }

  /// Enters the landmarks that were found; waits for them. The keyframe is that of the newest
  /// image, or an earlier one. Returns how many there are.
  int enter_landmarks(bool of_newest_image) {
    LandmarkSearch done = std::move(*search);
    search.reset();
    const LandmarkSearch::Found found = done.found();
    std::vector<double> rows;
    for (const StereoMatch& m : found.matches) {
      Track t;
      t.id = next_id++;
      t.anchor = done.anchor();
      t.pixel = found.corners[m.index];
      t.disparity = m.disparity;
      t.slope = m.slope.cast<double>();
      t.disparity_variance = options.texture_noise * m.variance;
      place_track(t, camera, offset);
      t.left = t.pixel;
      t.right = static_cast<float>(t.pixel.x() - m.disparity);
      t.in_view = t.tracked = t.inlier = t.has_right = true;
      Keyframe::see(t);
      if (of_newest_image) sightings.push_back({t.id, t.pixel.cast<double>(), true, true});
      tracks.push_back(std::move(t));
      rows.push_back(m.row_error);
    }
    if (!rows.empty()) row_error = median(rows);
    remember_view(done.anchor()->T_CW, done.coarse());
    return static_cast<int>(found.matches.size());
  }

  /// No longer in the joint covariance: anchors that no landmark comes from, and errors of
  /// landmarks that are gone.
  void forget_anchors() {
    std::vector<std::uint64_t> used = {keyframe.anchor}, errors = numbers_of_areas();
    for (const Track& t : tracks) {
      used.push_back(t.anchor->id);
      errors.push_back(t.id);
    }
    for (const Recall& recall : recalls.all()) {
      for (const Track& t : recall.tracks) used.push_back(t.anchor->id);
    }
    std::erase_if(remembered, [&](const auto& r) { return r.first + kRememberedFrames < frame; });
    for (const auto& [number, pose] : remembered) used.push_back(of_frame(number));
    for (std::vector<std::uint64_t>* numbers : {&used, &errors}) {
      std::sort(numbers->begin(), numbers->end());
      numbers->erase(std::unique(numbers->begin(), numbers->end()), numbers->end());
    }
    drift.keep(used, errors);
  }

  /// The newest pose, just measured, for covariance_since().
  void remember_pose() {
    drift.add(of_frame(frame));
    remembered[frame] = {trusted.T_CW, second.sum()};
  }

  /// A map begins at the trusted pose, with this frame alone. False if it has fewer than `least`
  /// points; the map that was there is then there still.
  bool begin_map(double stamp, FrameImages now, int least, OdometryFrame& out) {
    Stopwatch watch;
    const Keyframe kept_keyframe = keyframe;
    std::vector<Track> kept_tracks = std::exchange(tracks, {});
    RecallMemory kept_recalls = std::exchange(recalls, RecallMemory(options.recovery_keyframes));
    trusted.velocity.reset();
    trusted.coarse = now.coarse();
    trusted.middle = now.middle();
    trusted.stamp = stamp;
    begin_keyframe(std::move(now), false);
    out.matched = enter_landmarks(true);
    out.times.keyframe += watch.lap();
    if (out.matched < least) {
      keyframe = kept_keyframe;
      tracks = std::move(kept_tracks);
      recalls = std::move(kept_recalls);
      sightings.clear();
      return false;
    }
    started = true;
    of_world.clear();
    for (const Track& t : tracks) of_world.insert(t.id);
    unknown_since.reset();
    drift.begin(keyframe.anchor, covariance);
    remembered.clear();
    remember_pose();
    out.keyframe = true;
    out.expected = out.tracked = out.confirmed = out.matched;
    return true;
  }

  /// The first frame, or one until there are points to begin with.
  OdometryFrame first_frame(double stamp, FrameImages now, OdometryFrame& out) {
    out.keyframe_reason = "first frame";
    if (!begin_map(stamp, std::move(now), options.lost_points, out)) {
      return finished(out, Localization::kLost, "too few points to begin with");
    }
    if (out.matched < options.degraded_points) {
      return finished(out, Localization::kDegraded, "few points");
    }
    return finished(out, Localization::kOk, {});
  }

  /// A frame that was not located; after long a map begins anew.
  OdometryFrame lost_frame(double stamp, FrameImages now, OdometryFrame& out) {
    forget_second();
    time_offset.interrupt();
    for (Track& t : tracks) t.tracked = t.inlier = t.has_right = false;
    hold(stamp);
    const double since_good = stamp - trusted.stamp;
    if (!(options.restart_after > 0.0 && since_good > options.restart_after)) {
      return finished(out, Localization::kLost, {});
    }
    out.keyframe_reason = "restart";
    // Up to half of new landmarks are never found again. With fewer the next frame would be lost,
    // and with it the views by which the old map can be found.
    if (!begin_map(stamp, std::move(now), 2 * options.lost_points, out)) {
      return finished(out, Localization::kLost, {});
    }
    out.restarted = true;
    if (out.matched < options.degraded_points) add_reason(out.reason, "few points");
    return finished(out, Localization::kDegraded, "a new map begins");
  }
};

OdometryFrame StereoOdometry::Impl::process(double stamp, const ImageView& left,
                                            const ImageView& right,
                                            const std::optional<Isometry3d>& motion) {
  OdometryFrame out;
  out.stamp = stamp;
  ++frame;
  sightings.clear();
  given_up.clear();
  const std::string untimely = clock.tick(stamp);
  if (!untimely.empty()) return finished(out, Localization::kLost, untimely);
  const std::string wrong = wrong_size(camera.left, left, right);
  if (!wrong.empty()) {
    hold(stamp);
    return finished(out, Localization::kLost, wrong);
  }

  Stopwatch watch;
  const std::string frozen = started ? images.find(left, right) : std::string();
  if (!frozen.empty()) {
    hold(stamp);
    out.times.pyramids = watch.lap();
    const bool long_ago = stamp - trusted.stamp > 3.0 * std::max(clock.period(), 1e-3);
    return finished(out, long_ago ? Localization::kLost : Localization::kDegraded, frozen);
  }
  images.keep(left, right);
  FrameImages now(left, right, options.pyramid_levels);
  out.times.pyramids = watch.lap();

  if (search && search->ready()) {
    out.matched = enter_landmarks(false);
    forget_anchors();
    out.times.keyframe = watch.lap();
  }
  if (!started) return first_frame(stamp, std::move(now), out);

  const Candidate candidate = locate(stamp, now, motion, out.times);
  const FrameLocation& location = candidate.location;
  out.expected = location.expected;
  out.tracked = location.tracked;
  out.confirmed = location.confirmed;
  out.chi2_per_dof = location.pose.chi2_per_dof;
  out.reason = candidate.judgement.reason;
  Localization state = candidate.judgement.state;
  if (state == Localization::kLost) return lost_frame(stamp, std::move(now), out);
  if (clock.gap()) {
    add_reason(out.reason, "frames are missing");
    state = Localization::kDegraded;
  }

  watch.lap();
  take(candidate, stamp, now, motion, out);
  if (!out.reason.empty()) state = Localization::kDegraded;
  if (second.probability() > kDoubt) {
    add_reason(out.reason, "two motions compete");
    state = Localization::kDegraded;
  }
  if (trusted.velocity) {
    find_rows(right);
    time_offset.update(camera, tracks, trusted.T_CW, *trusted.velocity, stamp);
  } else {
    time_offset.interrupt();
  }
  if (time_offset.out_of_step()) {
    out.out_of_step = time_offset.reason(clock.period());
    add_reason(out.reason, out.out_of_step);
    state = Localization::kDegraded;
  }
  count();
  // Patches of what is blurred would not be found again.
  if (!search && !in_smaller_image) {
    const KeyframeEvidence evidence = keyframe.evidence(
        location, tracks, grid(static_cast<int>(corner_cell() * 2.0)), camera.left.width);
    out.keyframe_reason = keyframe_reason(evidence, options.keyframes);
    // What it shows may tell.
    if (may_be_carried && out.keyframe_reason.empty() &&
        stamp - keyframe_stamp > TrustedPose::kLikely) {
      out.keyframe_reason = "the view changes";
    }
  }
  out.keyframe = !out.keyframe_reason.empty();
  if (out.keyframe) {
    update_offset(location.pose);
    std::erase_if(tracks, [](const Track& t) { return t.misses >= 1; });
    thin_out();
    begin_keyframe(std::move(now), options.background_mapping);
    drift.add(keyframe.anchor);
    drift.fade(numbers_of_areas(), options.shared_errors.memory);
    forget_of_world();
    if (!options.background_mapping) out.matched = enter_landmarks(true);
  } else {
    std::erase_if(tracks, [&](const Track& t) { return t.misses > options.max_misses; });
    if (!in_smaller_image &&
        recalls.shift(tracks) > options.keyframes.max_shift * camera.left.width) {
      remember_view(trusted.T_CW, trusted.coarse);
    }
  }
  forget_anchors();
  out.times.keyframe += watch.lap();
  return finished(out, state, {});
}

StereoOdometry::StereoOdometry(const StereoCamera& camera, const StereoOdometryOptions& options,
                               const Isometry3d& initial_T_WC) {
  validate(camera);
  check_knobs("stereo odometry", options);
  impl_ = std::make_unique<Impl>(camera, options, initial_T_WC);
}
StereoOdometry::~StereoOdometry() = default;
StereoOdometry::StereoOdometry(StereoOdometry&&) noexcept = default;
StereoOdometry& StereoOdometry::operator=(StereoOdometry&&) noexcept = default;

OdometryFrame StereoOdometry::process(double stamp, const ImageView& left, const ImageView& right,
                                      const std::optional<Isometry3d>& motion) {
  ProcessorStopwatch watch;
  OdometryFrame frame = impl_->process(stamp, left, right, motion);
  impl_->by_imu.reset();
  frame.times.processor = watch.lap();
  return frame;
}

void StereoOdometry::expect(const std::optional<Isometry3d>& motion) {
  impl_->by_imu = motion && motion->matrix().allFinite() ? motion : std::nullopt;
}

std::shared_ptr<const LandmarkMap> StereoOdometry::landmarks(double horizon) const {
  auto map = std::make_shared<LandmarkMap>();
  const PinholeCamera& left = impl_->camera.left;
  map->image_cell = impl_->corner_cell() / left.fx;
  const TrackSurvival::Fit fit = impl_->survival.fit();
  // Before the second frame the rate is not known: that of most recordings.
  const double period = impl_->clock.period() > 0.0 ? impl_->clock.period() : 0.1;
  const int views = static_cast<int>(std::clamp(std::round(horizon / period), 1.0, 1000.0));
  for (const Track& t : impl_->tracks) {
    if (t.moving) continue;
    Landmark landmark;
    landmark.id = t.id;
    landmark.position = t.position;
    landmark.covariance = t.covariance;
    const Vector3d to_camera = t.anchor->T_CW.inverse().translation() - t.position;
    landmark.creation_range = to_camera.norm();
    landmark.creation_direction = to_camera / std::max(1e-9, landmark.creation_range);
    landmark.survival = TrackSurvival::probability(fit, t.found, t.misses > 0, views);
    map->landmarks.push_back(landmark);
  }
  return map;
}

const std::vector<LandmarkSighting>& StereoOdometry::sightings() const { return impl_->sightings; }

const std::vector<std::uint64_t>& StereoOdometry::given_up() const { return impl_->given_up; }

MotionInView StereoOdometry::motion_in_view() const {
  MotionInView motion;
  const std::optional<Isometry3d> other = impl_->second.expected(impl_->trusted.stamp);
  if (!other) return motion;
  for (const Track& t : impl_->tracks) {
    if (t.moving) {
      motion.moving.push_back(*other * t.position);
    } else if (t.inlier) {
      motion.still.push_back(impl_->trusted.T_CW * t.position);
    }
  }
  return motion;
}

std::optional<Matrix6d> StereoOdometry::covariance_since(int frames) const {
  const auto& remembered = impl_->remembered;
  const auto now = remembered.find(impl_->frame);
  if (frames < 1 || now == remembered.end()) return std::nullopt;
  const auto then = remembered.find(impl_->frame - static_cast<std::uint64_t>(frames));
  if (then == remembered.end()) return std::nullopt;
  return impl_->drift.since(of_frame(then->first), now->second.T_CW * then->second.T_CW.inverse()) +
         impl_->second.covariance_since(then->second.second, now->second.T_CW);
}

std::optional<MotionAhead> StereoOdometry::motion_ahead() const {
  const Impl& now = *impl_;
  if (!now.remembered.contains(now.frame)) return std::nullopt;
  constexpr double kShare = 0.1;  // of the distance
  std::vector<double> depths;
  for (const Track& t : now.tracks) {
    if (t.tracked && !t.moving) depths.push_back((now.trusted.T_CW * t.position).z());
  }
  if (depths.empty()) return std::nullopt;
  MotionAhead ahead;
  ahead.T_CC.translation().z() = kShare * median(depths);
  PoseEstimate pose;
  pose.T_CW = ahead.T_CC.inverse() * now.trusted.T_CW;
  std::vector<Track> tracks;
  for (Track t : now.tracks) {
    if (!t.tracked || t.moving) continue;
    const auto seen = predict_track(t, pose.T_CW, now.camera, now.options.max_scale);
    if (!seen) continue;
    t.left = seen->pixel;
    t.has_right = false;
    // A patch that was not sought yet: what its texture left to the disparity is of both images.
    if (t.left_covariance.isZero(0.0)) {
      t.left_covariance = 0.5 * t.disparity_variance * Eigen::Matrix2d::Identity();
    }
    tracks.push_back(std::move(t));
  }
  const TrackObservations seen = observe_tracks(
      tracks, {now.options.sigma_corner, now.options.sigma_corner, now.options.sigma_disparity},
      now.offset);
  pose.inlier.assign(seen.index.size(), 1);
  for (const PointObservation& o : seen.seen) pose.measured.push_back(o.measured);
  ahead.tracked = static_cast<int>(seen.index.size());
  if (ahead.tracked < now.options.lost_points) return std::nullopt;
  PoseDrift drift = now.drift;
  drift.measure(DriftMeasurement(now.camera, tracks, seen, pose, now.options.pose,
                                 now.options.shared_errors, now.noise.variance())
                    .of_pose());
  ahead.covariance = drift.since(of_frame(now.frame), ahead.T_CC.inverse());
  if (!ahead.covariance.allFinite()) return std::nullopt;
  return ahead;
}

}  // namespace prospect
