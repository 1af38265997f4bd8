#include "perception/stereo_odometry.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <exception>
#include <future>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

#include "engine/support/stopwatch.h"
#include "perception/image_pyramid.h"
#include "perception/image_shift.h"
#include "perception/median.h"
#include "perception/point_observation.h"
#include "perception/pose_drift.h"
#include "perception/reason.h"
#include "perception/se3.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix2f;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector2f;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Where landmarks were made: the image their patches are taken from, and its pose.
struct Anchor {
  std::uint64_t id = 0;
  ImagePyramid left;
  Isometry3d T_CW;
};

struct Track {
  std::uint64_t id = 0;
  std::shared_ptr<const Anchor> anchor;
  Vector2f pixel;                           // in the anchor's left image
  double disparity;                         // measured there, before correction [px]
  Vector3d in_anchor;                       // [m], in the anchor's camera frame
  Vector3d position;                        // [m], in W
  Matrix3d covariance;                      // [m^2], in W
  Vector2f at_keyframe = Vector2f::Zero();  // where it was at the last keyframe, if it was
  bool seen_at_keyframe = false;
  int misses = 0;           // in a row
  int found = 0;            // in how many frames
  bool has_spoken = false;  // about the disparity offset

  // This frame.
  bool in_view = false;
  bool tracked = false;
  bool inlier = false;
  Vector2f left = Vector2f::Zero();
  float right = 0.0f;
  bool has_right = false;
};

/// A good pose and what was known then, to come back to.
struct Recall {
  Isometry3d T_CW;
  PyramidLevel coarse;  // the coarsest level of its left image
  std::vector<Track> tracks;
};

/// Corners without a landmark in the image of a keyframe, and where the right image has them.
struct Found {
  std::vector<Vector2f> corners;
  std::vector<StereoMatch> matches;
};

/// New landmarks on their way. What finds them may run on a thread of its own: it has images that
/// nobody changes any more, and changes nothing.
struct MappingTask {
  std::shared_ptr<const Anchor> anchor;
  PyramidLevel coarse;  // of the keyframe, as in Recall
  std::future<Found> found;
};

Image copy(const ImageView& view) {
  Image image(view.width, view.height);
  for (int v = 0; v < view.height; ++v) {
    std::memcpy(&image.pixels[static_cast<std::size_t>(v) * view.width], view.row(v), view.width);
  }
  return image;
}

bool same(const Image& image, const ImageView& view) {
  if (image.width != view.width || image.height != view.height) return false;
  for (int v = 0; v < view.height; ++v) {
    if (std::memcmp(&image.pixels[static_cast<std::size_t>(v) * view.width], view.row(v),
                    view.width) != 0) {
      return false;
    }
  }
  return true;
}

/// A pose's own noise, from what its residuals say: chi^2 per degree of freedom, not taken to be
/// smaller than the first number, times the second. Landmarks carry their errors from pose to pose,
/// which residuals do not show and a covariance of poses alone cannot hold; the numbers make up for
/// it and are measured (docs/results/perception.md).
constexpr double kLeastChi2 = 0.25;
constexpr double kRepeatedErrors = 2.5;

}  // namespace

struct StereoOdometry::Impl {
  StereoCamera camera;
  StereoOdometryOptions options;

  std::vector<Track> tracks;
  std::uint64_t next_id = 1, newest_anchor = 0, keyframe_anchor = 0;
  std::deque<Recall> recalls;
  PyramidLevel good_coarse;  // of the last trusted frame, as in Recall
  std::shared_ptr<const Image> last_left, last_right;
  std::optional<MappingTask> mapping;

  bool started = false;
  Isometry3d T_CW;           // last trusted pose
  Isometry3d keyframe_T_CW;  // of the last keyframe
  Matrix6d covariance;       // at T_CW, against the start
  PoseDrift drift;
  Vector6d velocity = Vector6d::Zero();  // xi per second, T_CW <- exp(velocity dt) T_CW
  bool have_velocity = false;
  double last_stamp = 0.0;
  bool have_stamp = false;
  double good_stamp = 0.0;  // of the last trusted pose
  double period = 0.0;      // usual time between frames, 0: not known yet
  int points_at_keyframe = 0;
  double row_error = 0.0;
  DisparityOffset offset;
  std::uint64_t frame = 0;
  TrackSurvival survival;
  std::vector<LandmarkSighting> sightings;  // of this frame, as in the header
  std::vector<std::uint64_t> given_up;

  /// Where the left image shows a landmark at this pose, and how its patch is warped: A of
  /// patch_alignment.h. False if it is out of view or seen at too different a scale.
  bool predict(const Track& t, const Isometry3d& T, Vector2f& pixel, Matrix2f& A) const {
    const Vector3d Y = T * t.position;
    if (!(Y.z() > 0.1)) return false;
    const Vector2d p = camera.left.project(Y);
    if (!(p.x() >= 0 && p.y() >= 0 && p.x() <= camera.left.width - 1 &&
          p.y() <= camera.left.height - 1)) {
      return false;
    }
    pixel = p.cast<float>();
    // The patch as a piece of a plane that faced the anchor's camera.
    const Matrix3d R = (T * t.anchor->T_CW.inverse()).linear();
    const Eigen::Matrix<double, 2, 3> P = camera.left.projection_jacobian(Y);
    const double z = t.in_anchor.z();
    Eigen::Matrix2d B;
    B.col(0) = P * R.col(0) * (z / camera.left.fx);
    B.col(1) = P * R.col(1) * (z / camera.left.fy);
    const double determinant = B.determinant();
    const double limit = options.max_scale * options.max_scale;
    if (!(determinant < limit && determinant > 1.0 / limit)) return false;
    A = B.inverse().cast<float>();
    return true;
  }

  /// Whether nothing but chance can keep the landmark from being tracked at T_CW: its patch is well
  /// within the image, at a scale well within the limits.
  bool in_full_view(const Track& t) const {
    constexpr double kBorder = 12.0;  // [px]: half a patch, its gradient, and what it may move
    const double limit = 0.875 * options.max_scale;
    Vector2f pixel;
    Matrix2f A;
    if (!predict(t, T_CW, pixel, A)) return false;
    const double scale = std::sqrt(1.0 / A.determinant());
    return scale < limit && scale > 1.0 / limit && pixel.x() >= kBorder && pixel.y() >= kBorder &&
           pixel.x() <= camera.left.width - 1 - kBorder &&
           pixel.y() <= camera.left.height - 1 - kBorder;
  }

  /// Position and covariance from what was measured in the anchor, eqs. (1) and (2).
  void place(Track& t) const {
    const double d = std::max(t.disparity + offset.value(), 0.1);
    const double u = t.pixel.x(), v = t.pixel.y();
    const Matrix3d R = t.anchor->T_CW.linear().transpose();
    t.in_anchor = camera.triangulate(u, v, d);
    t.position = t.anchor->T_CW.inverse() * t.in_anchor;
    t.covariance = R * camera.triangulation_covariance(u, v, d) * R.transpose();
  }

  /// Forgets what the last pass found; then as predict(), which decides whether the point is in
  /// view.
  bool begin_tracking(Track& t, const Isometry3d& T, Vector2f& start, Matrix2f& A) const {
    t.tracked = t.has_right = false;
    t.in_view = predict(t, T, start, A);
    return t.in_view;
  }

  /// First pass: left image only, down to level 1; RANSAC sorts out what is wrong.
  void track_coarse(std::vector<Track>& points, const Isometry3d& T, const ImagePyramid& left,
                    int top) const {
    for (Track& t : points) {
      Vector2f start;
      Matrix2f A;
      if (!begin_tracking(t, T, start, A)) continue;
      const TrackResult result =
          track_patch(t.anchor->left, t.pixel, A, left, start, top, 1, false, options.tracking);
      t.tracked = result.outcome == TrackOutcome::kTracked;
      if (t.tracked) t.left = result.position;
    }
  }

  /// Second pass: both images, from a pose that is good to about a pixel.
  void track_fine(std::vector<Track>& points, const Isometry3d& T, const ImagePyramid& left,
                  const ImagePyramid& right) const {
    for (Track& t : points) {
      Vector2f start;
      Matrix2f A;
      if (!begin_tracking(t, T, start, A)) continue;
      const double depth = (T * t.position).z();
      const float disparity =
          static_cast<float>(camera.left.fx * camera.baseline / depth - offset.value());
      const StereoTrackResult result =
          track_stereo_patch(t.anchor->left, t.pixel, A, left, start, right,
                             start - Vector2f(disparity, 0.0f), options.tracking);
      t.tracked = result.left.outcome == TrackOutcome::kTracked;
      if (!t.tracked) continue;
      t.left = result.left.position;
      t.right = result.right.x();
      t.has_right = result.in_right &&
                    std::abs(result.right.y() - t.left.y()) <= options.matching.max_row_error;
    }
  }

  std::vector<PointObservation> observations(const std::vector<Track>& points,
                                             std::vector<int>& index) const {
    std::vector<PointObservation> out;
    index.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Track& t = points[i];
      if (!t.tracked) continue;
      PointObservation o;
      o.T_WA = t.anchor->T_CW.inverse();
      o.measured << t.pixel.x(), t.pixel.y(), std::max(t.disparity + offset.value(), 0.1);
      o.sigma << options.sigma_corner, options.sigma_corner, options.sigma_disparity;
      o.left = t.left.cast<double>();
      if (t.has_right) o.right = t.right - offset.value();
      out.push_back(o);
      index.push_back(static_cast<int>(i));
    }
    return out;
  }

  struct Attempt {
    PoseEstimate pose;
    int expected = 0, tracked = 0, confirmed = 0;
  };

  /// A pose `from` which the image `before` was seen, turned so as to show the image `now`.
  Isometry3d turned(const Isometry3d& from, const PyramidLevel& before,
                    const PyramidLevel& now) const {
    const std::optional<Vector2d> shift = image_shift(before, now);
    if (!shift) return from;
    const double scale = camera.left.width / now.width;
    const double yaw = std::atan(scale * shift->x() / camera.left.fx);
    const double pitch = std::atan(scale * shift->y() / camera.left.fy);
    Isometry3d R = Isometry3d::Identity();
    R.linear() =
        (Eigen::AngleAxisd(yaw, Vector3d::UnitY()) * Eigen::AngleAxisd(-pitch, Vector3d::UnitX()))
            .toRotationMatrix();
    return R * from;
  }

  /// The pose of this frame from these points, near `prior`. Leaves tracked, inlier, has_right in
  /// the points.
  Attempt attempt(std::vector<Track>& points, const Isometry3d& prior, const ImagePyramid& left,
                  const ImagePyramid& right, bool trust_prior, OdometryTimes& times) {
    Stopwatch watch;
    Attempt result;
    for (Track& t : points) t.tracked = t.inlier = t.has_right = false;
    std::vector<int> index;
    PoseEstimate coarse;
    PoseEstimatorOptions level_1 = options.pose;
    level_1.sigma_left = 2.0 * options.pose.sigma_left + 0.3;  // pixels of that level, and its blur
    const int deep = options.pyramid_levels - 1;
    for (int top : {trust_prior ? std::min(2, deep) : deep, deep}) {
      track_coarse(points, prior, left, top);
      int in_view = 0, tracked = 0;
      for (const Track& t : points) {
        in_view += t.in_view;
        tracked += t.tracked;
      }
      times.tracking += watch.lap();
      const auto seen = observations(points, index);
      coarse = ransac_pose(camera, seen, prior, options.seed + frame, level_1);
      times.pose += watch.lap();
      if (top == deep || (coarse.solved && 2 * coarse.inliers >= in_view)) break;
    }
    if (!coarse.solved) return result;
    coarse = refine_pose(camera, observations(points, index), coarse.inlier, coarse.T_CW, level_1);
    times.pose += watch.lap();
    if (!coarse.solved) return result;
    // From here the predictions are good to about a pixel, and the warps are right.
    track_fine(points, coarse.T_CW, left, right);
    times.tracking += watch.lap();
    const auto seen = observations(points, index);
    result.pose = refine_pose(camera, seen, {}, coarse.T_CW, options.pose);
    for (std::size_t k = 0; k < index.size(); ++k) {
      points[index[k]].inlier = result.pose.solved && result.pose.inlier[k];
    }
    for (Track& t : points) {
      result.expected += t.in_view;
      result.tracked += t.inlier;
      result.confirmed += t.inlier && t.has_right;
    }
    times.pose += watch.lap();
    return result;
  }

  /// Covariance of a pose against the start: what it owes to each anchor, and its own noise.
  Matrix6d covariance_of(const PoseEstimate& pose) {
    std::vector<int> index;
    const auto seen = observations(tracks, index);
    std::vector<PoseDrift::Reference> references;
    Vector6d b = Vector6d::Zero();
    for (std::size_t k = 0; k < index.size(); ++k) {
      ObservationResidual residual;
      if (!pose.inlier[k] ||
          !observation_residual(camera, pose.T_CW, seen[k], pose.measured[k], residual)) {
        continue;
      }
      const Matrix3d W =
          observation_weight(seen[k], residual, options.pose.sigma_left, options.pose.sigma_right);
      const Anchor& anchor = *tracks[index[k]].anchor;
      auto reference =
          std::find_if(references.begin(), references.end(),
                       [&](const PoseDrift::Reference& r) { return r.anchor == anchor.id; });
      if (reference == references.end()) {
        references.push_back({anchor.id, pose.T_CW * anchor.T_CW.inverse(), Matrix6d::Zero()});
        reference = references.end() - 1;
      }
      const Eigen::Matrix<double, 6, 3> JW = residual.d_pose.transpose() * W;
      reference->information += JW * residual.d_pose;
      Vector3d by_offset = residual.d_measured.col(2);
      if (seen[k].sees_right()) by_offset[2] -= 1.0;
      b += JW * by_offset;
    }
    // pose.covariance is H^-1 times at least 1.
    const double noise = kRepeatedErrors * std::max(kLeastChi2, pose.chi2_per_dof) /
                         std::max(1.0, pose.chi2_per_dof);
    return drift.measure(references, b, noise * pose.covariance);
  }

  /// What the newest pose says about the disparity offset; then all landmarks move with it.
  void update_offset(const Attempt& a) {
    std::vector<int> index;
    const auto seen = observations(tracks, index);
    const Vector3d here = a.pose.T_CW.inverse().translation();
    std::vector<char> speaks(index.size(), 0);
    int speaking = 0;
    for (std::size_t k = 0; k < index.size(); ++k) {
      const Track& t = tracks[index[k]];
      const double moved = (here - t.anchor->T_CW.inverse().translation()).norm();
      speaks[k] = a.pose.inlier[k] && !t.has_spoken &&
                  moved >= options.disparity_offset.min_baseline * t.in_anchor.z();
      speaking += speaks[k];
    }
    if (speaking < options.disparity_offset.min_points) return;
    for (std::size_t k = 0; k < index.size(); ++k) tracks[index[k]].has_spoken |= speaks[k] != 0;
    const double walk = options.disparity_offset.walk_sigma;
    const double before = offset.sigma() * offset.sigma() + walk * walk;
    offset.update(disparity_offset_evidence(camera, seen, a.pose, speaks, options.pose));
    if (offset.estimated()) drift.update_offset(before, offset.sigma() * offset.sigma());
    for (Track& t : tracks) place(t);
    for (Recall& recall : recalls) {
      for (Track& t : recall.tracks) place(t);
    }
  }

  /// Judges an attempt: state and reasons.
  Localization judge(const Attempt& a, const std::vector<Track>& points, double since_good,
                     std::string& reason) const {
    if (!a.pose.solved || a.tracked < options.lost_points) {
      add_reason(reason, "too few points agree on a pose");
      return Localization::kLost;
    }
    if (a.tracked < options.lost_share * a.expected) {
      add_reason(reason, "most points are not found");
      return Localization::kLost;
    }
    if (a.confirmed < options.lost_right_share * a.tracked) {
      add_reason(reason, "the right image does not fit the left one");
      return Localization::kLost;
    }
    if (!(a.pose.sigma_position() <= options.max_sigma_position)) {
      add_reason(reason, "the pose is not fixed by the points");
      return Localization::kLost;
    }
    // Motion since the last good pose, against what can be.
    const Vector6d motion = log_se3(a.pose.T_CW * T_CW.inverse());
    const double dt = std::max(since_good, 1e-3);
    bool possible = motion.head<3>().norm() <= options.max_speed * dt &&
                    motion.tail<3>().norm() <= options.max_turn_rate * dt;
    if (have_velocity) {
      const Vector6d change = motion - velocity * dt;
      possible = possible && change.head<3>().norm() <= 0.05 + options.max_acceleration * dt * dt &&
                 change.tail<3>().norm() <= 0.05 + options.max_turn_acceleration * dt * dt;
    }
    if (!possible) {
      add_reason(reason, "the motion is impossible");
      return Localization::kLost;
    }
    Localization state = Localization::kOk;
    if (a.tracked < options.degraded_points) add_reason(reason, "few points");
    if (a.tracked < options.degraded_share * a.expected) add_reason(reason, "many points are lost");
    if (a.confirmed < options.degraded_right_share * a.tracked) {
      add_reason(reason, "the right image confirms few points");
    }
    // A half of the image on which nothing is found any more, in either image.
    int expected[4] = {0, 0, 0, 0}, found[4] = {0, 0, 0, 0}, confirmed[4] = {0, 0, 0, 0};
    for (const Track& t : points) {
      if (!t.in_view) continue;
      const Vector3d Y = a.pose.T_CW * t.position;
      if (!(Y.z() > 0.1)) continue;
      const Vector2d p = camera.left.project(Y);
      const int halves[2] = {p.x() < 0.5 * camera.left.width ? 0 : 1,
                             p.y() < 0.5 * camera.left.height ? 2 : 3};
      for (int h : halves) {
        ++expected[h];
        found[h] += t.inlier;
        confirmed[h] += t.inlier && t.has_right;
      }
    }
    static const char* const kHalf[4] = {"left", "right", "upper", "lower"};
    for (int h = 0; h < 4; ++h) {
      if (expected[h] >= 15 && found[h] < 0.15 * expected[h]) {
        add_reason(reason, std::string("nothing is found in the ") + kHalf[h] + " half");
      } else if (found[h] >= 15 && confirmed[h] < 0.15 * found[h]) {
        add_reason(reason,
                   std::string("the right image confirms nothing in the ") + kHalf[h] + " half");
      }
    }
    if (!reason.empty()) state = Localization::kDegraded;
    return state;
  }

  /// One landmark an image cell: the oldest, which ties this frame to the earliest keyframe.
  void thin_out() {
    const double cell = corner_cell(static_cast<int>(camera.left.width),
                                    static_cast<int>(camera.left.height), options.corners);
    const int columns = static_cast<int>(camera.left.width / cell) + 1;
    const int rows = static_cast<int>(camera.left.height / cell) + 1;
    std::vector<char> taken(static_cast<std::size_t>(columns) * rows, 0);
    std::erase_if(tracks, [&](const Track& t) {
      const int column = std::clamp(static_cast<int>(t.left.x() / cell), 0, columns - 1);
      const int row = std::clamp(static_cast<int>(t.left.y() / cell), 0, rows - 1);
      char& full = taken[static_cast<std::size_t>(row) * columns + column];
      if (full) {
        given_up.push_back(t.id);
        return true;
      }
      full = 1;
      return false;
    });
  }

  /// A keyframe begins at T_CW: it is what later frames are compared with.
  void begin_keyframe() {
    keyframe_T_CW = T_CW;
    points_at_keyframe = 0;
    for (Track& t : tracks) mark(t);
  }

  void mark(Track& t) {
    t.seen_at_keyframe = t.inlier;
    t.at_keyframe = t.left;
    points_at_keyframe += t.inlier;
  }

  /// New landmarks are to be found where the newest left image, at T_CW, has none.
  void begin_mapping(ImagePyramid left, std::shared_ptr<const ImagePyramid> right,
                     bool in_background) {
    std::vector<Vector2f> occupied;
    for (const Track& t : tracks) {
      if (t.inlier) occupied.push_back(t.left);
    }
    auto anchor = std::make_shared<Anchor>();
    anchor->id = ++newest_anchor;
    anchor->left = std::move(left);
    anchor->T_CW = T_CW;
    const auto find = [image = last_left, anchor, right = std::move(right),
                       occupied = std::move(occupied), corners = options.corners,
                       matching = options.matching] {
      Found found;
      found.corners = detect_corners(image->view(), occupied, corners);
      found.matches = match_stereo(anchor->left, *right, found.corners, matching);
      return found;
    };
    mapping.emplace(MappingTask{anchor, good_coarse, {}});
    if (in_background) {
      try {
        mapping->found = std::async(std::launch::async, find);
        return;
      } catch (const std::exception&) {
        // No thread is to be had: in this one, then.
      }
    }
    mapping->found = std::async(std::launch::deferred, find);
  }

  /// Enters the landmarks that were found; waits for them. The keyframe is that of the newest
  /// image, or an earlier one. Returns how many there are.
  int finish_mapping(bool of_newest_image) {
    MappingTask done = std::move(*mapping);
    mapping.reset();
    Found found;
    try {
      found = done.found.get();
    } catch (const std::exception&) {
      // No memory: none are found.
    }
    std::vector<double> rows;
    for (const StereoMatch& m : found.matches) {
      Track t;
      t.id = next_id++;
      t.anchor = done.anchor;
      t.pixel = found.corners[m.index];
      t.disparity = m.disparity;
      place(t);
      t.left = t.pixel;
      t.right = static_cast<float>(t.pixel.x() - m.disparity);
      t.in_view = t.tracked = t.inlier = t.has_right = true;
      mark(t);
      if (of_newest_image) sightings.push_back({t.id, t.pixel.cast<double>(), true, true});
      tracks.push_back(std::move(t));
      rows.push_back(m.row_error);
    }
    if (!rows.empty()) row_error = median(rows);
    recalls.push_back({done.anchor->T_CW, done.coarse, tracks});
    while (static_cast<int>(recalls.size()) > options.recovery_keyframes) recalls.pop_front();
    return static_cast<int>(found.matches.size());
  }

  /// No longer in the joint covariance: anchors that no landmark comes from.
  void forget_anchors() {
    std::set<std::uint64_t> used;
    for (const Track& t : tracks) used.insert(t.anchor->id);
    for (const Recall& recall : recalls) {
      for (const Track& t : recall.tracks) used.insert(t.anchor->id);
    }
    used.insert(keyframe_anchor);
    drift.keep(used);
  }

  std::string want_keyframe(const Attempt& a) const {
    KeyframeEvidence evidence;
    evidence.points = a.tracked;
    evidence.points_at_keyframe = points_at_keyframe;
    evidence.width = camera.left.width;
    const int cell =
        static_cast<int>(corner_cell(static_cast<int>(camera.left.width),
                                     static_cast<int>(camera.left.height), options.corners) *
                         2.0);
    const int columns = static_cast<int>(camera.left.width) / cell + 1;
    const int rows = static_cast<int>(camera.left.height) / cell + 1;
    std::vector<char> before(static_cast<std::size_t>(columns) * rows, 0), now = before;
    std::vector<double> shifts;
    for (const Track& t : tracks) {
      const auto mark = [&](const Vector2f& p, std::vector<char>& cells) {
        const int c = std::clamp(static_cast<int>(p.x()) / cell, 0, columns - 1);
        const int r = std::clamp(static_cast<int>(p.y()) / cell, 0, rows - 1);
        cells[static_cast<std::size_t>(r) * columns + c] = 1;
      };
      if (t.seen_at_keyframe) mark(t.at_keyframe, before);
      if (!t.inlier) continue;
      mark(t.left, now);
      if (t.seen_at_keyframe) shifts.push_back((t.left - t.at_keyframe).norm());
    }
    int held = 0, were = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      were += before[i];
      held += before[i] && now[i];
    }
    evidence.occupied_cells = were > 0 ? static_cast<double>(held) / were : 0.0;
    if (!shifts.empty()) evidence.shift = median(shifts);
    const Vector6d motion = log_se3(a.pose.T_CW * keyframe_T_CW.inverse());
    evidence.significance =
        std::max(motion.head<3>().norm() / std::max(a.pose.sigma_position(), 1e-9),
                 motion.tail<3>().norm() / std::max(a.pose.sigma_rotation(), 1e-9));
    return keyframe_reason(evidence, options.keyframes);
  }

  void finish(OdometryFrame& out) const {
    out.T_WC = T_CW.inverse();
    out.covariance = covariance;
    out.row_error = row_error;
    out.disparity_offset = offset.value();
    out.disparity_offset_sigma = offset.sigma();
  }

  /// Nothing was measured: hold the pose and let its covariance grow with what the robot may do.
  void hold(double dt) {
    const double t = std::max(0.0, dt) * (0.2 + velocity.head<3>().norm());
    const double w = std::max(0.0, dt) * (0.2 + velocity.tail<3>().norm());
    for (int i = 0; i < 3; ++i) {
      covariance(i, i) += t * t;
      covariance(i + 3, i + 3) += w * w;
    }
  }

  OdometryFrame process(double stamp, const ImageView& left, const ImageView& right,
                        const std::optional<Isometry3d>& motion);
};

OdometryFrame StereoOdometry::Impl::process(double stamp, const ImageView& left,
                                            const ImageView& right,
                                            const std::optional<Isometry3d>& motion) {
  OdometryFrame out;
  out.stamp = stamp;
  ++frame;
  sightings.clear();
  given_up.clear();
  const auto reject = [&](const std::string& reason) {
    add_reason(out.reason, reason);
    out.state = Localization::kLost;
    finish(out);
    return out;
  };
  if (!std::isfinite(stamp)) return reject("the time is not a number");
  if (have_stamp && !(stamp > last_stamp)) return reject("the time does not increase");
  const double dt = have_stamp ? stamp - last_stamp : 0.0;
  last_stamp = stamp;
  have_stamp = true;
  const auto wrong = [&](const ImageView& image) {
    return image.empty() || image.stride < image.width ||
           image.width != static_cast<int>(camera.left.width) ||
           image.height != static_cast<int>(camera.left.height);
  };
  if (wrong(left) || wrong(right)) {
    hold(dt);
    return reject(std::string("the ") + (wrong(left) ? "left" : "right") +
                  " image has the wrong size");
  }
  const bool gap = period > 0.0 && dt > options.max_gap * period;
  if (dt > 0.0) period = period > 0.0 ? std::min(1.1 * period, std::max(0.9 * period, dt)) : dt;

  Stopwatch watch;
  const bool frozen_left = last_left && same(*last_left, left);
  const bool frozen_right = last_right && same(*last_right, right);
  if (started && (frozen_left || frozen_right)) {
    // Real sensors never give the same noise twice: this is an old image, not a robot at rest.
    hold(dt);
    out.state = Localization::kDegraded;
    add_reason(out.reason, frozen_left && frozen_right ? "the images are frozen"
                           : frozen_left               ? "the left image is frozen"
                                                       : "the right image is frozen");
    if (stamp - good_stamp > 3.0 * std::max(period, 1e-3)) out.state = Localization::kLost;
    finish(out);
    out.times.pyramids = watch.lap();
    return out;
  }
  last_left = std::make_shared<const Image>(copy(left));
  last_right = std::make_shared<const Image>(copy(right));
  ImagePyramid left_pyramid(left, options.pyramid_levels);
  const auto right_levels = std::make_shared<const ImagePyramid>(right, 1);
  const ImagePyramid& right_pyramid = *right_levels;
  out.times.pyramids = watch.lap();

  const auto begin_map = [&] {
    tracks.clear();
    recalls.clear();
    velocity.setZero();
    have_velocity = false;
    good_coarse = left_pyramid.level(left_pyramid.levels() - 1);
    const Isometry3d kept_pose = keyframe_T_CW;
    const int kept_points = points_at_keyframe;
    begin_keyframe();
    begin_mapping(std::move(left_pyramid), right_levels, false);
    out.matched = finish_mapping(true);
    out.times.keyframe = watch.lap();
    if (out.matched < options.lost_points) {
      keyframe_T_CW = kept_pose;
      points_at_keyframe = kept_points;
      tracks.clear();
      recalls.clear();
      sightings.clear();
      started = false;
      return false;
    }
    started = true;
    keyframe_anchor = newest_anchor;
    drift.begin(newest_anchor, covariance);
    good_stamp = stamp;
    out.keyframe = true;
    out.expected = out.tracked = out.confirmed = out.matched;
    out.state = Localization::kOk;
    if (out.matched < options.degraded_points) {
      out.state = Localization::kDegraded;
      add_reason(out.reason, "few points");
    }
    return true;
  };

  if (mapping && mapping->found.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    out.matched = finish_mapping(false);
    forget_anchors();
    out.times.keyframe = watch.lap();
  }

  if (!started) {
    out.keyframe_reason = "first frame";
    if (!begin_map()) return reject("too few points to begin with");
    finish(out);
    return out;
  }

  const double since_good = stamp - good_stamp;
  // A motion goes on for a while, not for ever.
  const PyramidLevel coarse = left_pyramid.level(left_pyramid.levels() - 1);
  const auto as_before = [&]() -> Isometry3d {
    return have_velocity ? exp_se3(velocity * std::min(since_good, 0.5)) * T_CW
                         : turned(T_CW, good_coarse, coarse);
  };
  const bool measured = motion && motion->matrix().allFinite();
  Attempt a = attempt(tracks, measured ? motion->inverse() * T_CW : as_before(), left_pyramid,
                      right_pyramid, measured || (have_velocity && !gap), out.times);
  std::string reason;
  Localization state = judge(a, tracks, since_good, reason);
  if (state == Localization::kLost) {
    // Once more as if nothing had been measured, from where we were, from the newest keyframes.
    const auto retry = [&](std::vector<Track> points, const Isometry3d& from) {
      Attempt b = attempt(points, from, left_pyramid, right_pyramid, false, out.times);
      std::string why;
      const Localization judged = judge(b, points, since_good, why);
      if (judged == Localization::kLost) return false;
      a = b;
      state = judged;
      reason = why;
      tracks = std::move(points);
      return true;
    };
    bool found = measured && have_velocity && retry(tracks, as_before());
    found = found || retry(tracks, turned(T_CW, good_coarse, coarse));
    for (auto recall = recalls.rbegin(); !found && recall != recalls.rend(); ++recall) {
      found = retry(recall->tracks, turned(recall->T_CW, recall->coarse, coarse));
    }
  }
  out.reason = reason;
  out.expected = a.expected;
  out.tracked = a.tracked;
  out.confirmed = a.confirmed;
  out.chi2_per_dof = a.pose.chi2_per_dof;
  if (state == Localization::kLost) {
    for (Track& t : tracks) t.tracked = t.inlier = t.has_right = false;
    hold(dt);
    out.state = state;
    if (options.restart_after > 0.0 && since_good > options.restart_after) {
      watch.lap();
      const std::string before = out.reason;
      out.keyframe_reason = "restart";
      std::vector<Track> kept = tracks;
      std::deque<Recall> kept_recalls = recalls;
      if (begin_map()) {
        out.restarted = true;
        out.state = Localization::kDegraded;
        add_reason(out.reason, "a new map begins");
      } else {
        tracks = std::move(kept);
        recalls = std::move(kept_recalls);
        started = true;
        out.state = Localization::kLost;
      }
    }
    finish(out);
    return out;
  }

  // The pose is taken.
  watch.lap();
  good_coarse = coarse;
  const Isometry3d before = T_CW;
  T_CW = a.pose.T_CW;
  covariance = covariance_of(a.pose);
  out.covariance_since_keyframe = drift.since(keyframe_anchor, T_CW * keyframe_T_CW.inverse());
  if (since_good <= 1.0) {
    velocity = log_se3(T_CW * before.inverse()) / std::max(since_good, 1e-3);
    have_velocity = true;
  } else {
    velocity.setZero();
    have_velocity = false;
  }
  good_stamp = stamp;
  if (gap) {
    add_reason(out.reason, "frames are missing");
    state = Localization::kDegraded;
  }
  out.state = state;

  for (Track& t : tracks) {
    if (!t.in_view) {
      ++t.misses;  // out of view for long: gone, it would be found from a keyframe
      continue;
    }
    const Vector3d Y = T_CW * t.position;
    if (t.inlier) {
      sightings.push_back({t.id, t.left.cast<double>(), true, false});
    } else if (Y.z() > 0.0) {
      sightings.push_back({t.id, camera.left.project(Y), false, false});
    }
    if (in_full_view(t)) {
      if (t.misses == 0) {
        survival.add(t.found, t.inlier);
      } else {
        survival.add_missed(t.inlier);
      }
    }
    if (t.inlier) {
      ++t.found;
      t.misses = 0;
    } else {
      ++t.misses;
    }
  }
  survival.forget();
  if (!mapping) out.keyframe_reason = want_keyframe(a);
  if (!out.keyframe_reason.empty()) {
    out.keyframe = true;
    update_offset(a);
    std::erase_if(tracks, [&](const Track& t) { return t.misses >= 1; });
    thin_out();
    begin_keyframe();
    begin_mapping(std::move(left_pyramid), right_levels, options.background_mapping);
    keyframe_anchor = newest_anchor;
    drift.add(newest_anchor);
    if (!options.background_mapping) out.matched = finish_mapping(true);
    forget_anchors();
  } else {
    std::erase_if(tracks, [&](const Track& t) { return t.misses > options.max_misses; });
  }
  out.times.keyframe += watch.lap();
  finish(out);
  return out;
}

StereoOdometry::StereoOdometry(const StereoCamera& camera, const StereoOdometryOptions& options,
                               const Isometry3d& initial_T_WC)
    : impl_(std::make_unique<Impl>()) {
  validate(camera);
  if (options.pyramid_levels < 2 || options.pyramid_levels > 8) {
    throw std::invalid_argument("stereo odometry: pyramid_levels is " +
                                std::to_string(options.pyramid_levels) + "; expected 2 to 8");
  }
  impl_->camera = camera;
  impl_->camera.sigma_u = impl_->camera.sigma_v = options.sigma_corner;
  impl_->camera.sigma_d = options.sigma_disparity;
  impl_->options = options;
  impl_->offset = DisparityOffset(options.disparity_offset);
  impl_->drift = PoseDrift(impl_->offset.sigma() * impl_->offset.sigma());
  impl_->survival = TrackSurvival(options.survival);
  impl_->T_CW = initial_T_WC.inverse();
  impl_->keyframe_T_CW = impl_->T_CW;
  impl_->covariance.setZero();
}
StereoOdometry::~StereoOdometry() = default;
StereoOdometry::StereoOdometry(StereoOdometry&&) noexcept = default;
StereoOdometry& StereoOdometry::operator=(StereoOdometry&&) noexcept = default;

OdometryFrame StereoOdometry::process(double stamp, const ImageView& left, const ImageView& right,
                                      const std::optional<Isometry3d>& motion) {
  ProcessorStopwatch watch;
  OdometryFrame frame = impl_->process(stamp, left, right, motion);
  frame.times.processor = watch.lap();
  return frame;
}

std::shared_ptr<const LandmarkMap> StereoOdometry::landmarks(double horizon) const {
  auto map = std::make_shared<LandmarkMap>();
  const PinholeCamera& left = impl_->camera.left;
  map->image_cell = corner_cell(static_cast<int>(left.width), static_cast<int>(left.height),
                                impl_->options.corners) /
                    left.fx;
  const TrackSurvival::Fit fit = impl_->survival.fit();
  // Before the second frame the rate is not known: that of most recordings.
  const double period = impl_->period > 0.0 ? impl_->period : 0.1;
  const int views = static_cast<int>(std::clamp(std::round(horizon / period), 1.0, 1000.0));
  for (const Track& t : impl_->tracks) {
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

}  // namespace prospect
