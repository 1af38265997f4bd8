// SPDX-License-Identifier: Apache-2.0
// perception_libraries: two parts of the visual odometry against what libraries have for them, on
// the same input, processor time of one thread:
//   refine_pose() against the same cost solved by Ceres;
//   track_patch() against OpenCV's calcOpticalFlowPyrLK, forward and back.
// Exact truth: simulated observations, rendered images.

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>
#include <random>
#include <vector>

#include "engine/support/stopwatch.h"
#include "perception/odometry/corner_detector.h"
#include "perception/odometry/patch_tracker.h"
#include "perception/odometry/pose_estimation.h"
#include "perception/odometry/se3.h"
#include "tests/perception/rendered_room.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2f;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

// ---- Refinement ---------------------------------------------------------------------------------

/// The cost of refine_pose(), one observation: its residual and that of what was measured,
/// whitened.
class ObservationCost final : public ceres::SizedCostFunction<6, 6, 3> {
 public:
  ObservationCost(const StereoCamera& camera, const PointObservation& o, const Isometry3d& start,
                  const PoseEstimatorOptions& options)
      : camera_(camera), o_(o), start_(start) {
    sigma_ << options.sigma_left, options.sigma_left, options.sigma_right, o.sigma;
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Vector6d> xi(parameters[0]);
    const Eigen::Map<const Vector3d> m(parameters[1]);
    ObservationResidual residual;
    if (!observation_residual(camera_, exp_se3(xi) * start_, o_, m, residual)) return false;
    Eigen::Map<Vector6d> r(residuals);
    r << residual.r, m - o_.measured;
    r.array() /= sigma_.array();
    if (jacobians && jacobians[0]) {
      Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> J(jacobians[0]);
      J.setZero();
      J.topRows<3>() = sigma_.head<3>().cwiseInverse().asDiagonal() * residual.d_pose;
    }
    if (jacobians && jacobians[1]) {
      Eigen::Map<Eigen::Matrix<double, 6, 3, Eigen::RowMajor>> J(jacobians[1]);
      J.topRows<3>() = sigma_.head<3>().cwiseInverse().asDiagonal() * residual.d_measured;
      J.bottomRows<3>() = Eigen::Matrix3d(sigma_.tail<3>().cwiseInverse().asDiagonal());
    }
    return true;
  }

 private:
  const StereoCamera& camera_;
  const PointObservation& o_;
  const Isometry3d& start_;
  Vector6d sigma_;
};

/// xi <- log(exp(delta) exp(xi)). The cost's derivatives are by delta already.
class LeftPerturbation final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 6; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* out) const override {
    Eigen::Map<Vector6d>{out} = log_se3(exp_se3(Eigen::Map<const Vector6d>(delta)) *
                                        exp_se3(Eigen::Map<const Vector6d>(x)));
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* out) const override {
    Eigen::Map<Vector6d>{out} = log_se3(exp_se3(Eigen::Map<const Vector6d>(y)) *
                                        exp_se3(Eigen::Map<const Vector6d>(x)).inverse());
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    return PlusJacobian(nullptr, jacobian);
  }
};

/// refine_pose() with Ceres in place of its own Gauss-Newton: solved with Huber's loss, gated, and
/// solved again without, until the set settles.
Isometry3d refine_by_ceres(const StereoCamera& camera,
                           const std::vector<PointObservation>& observations,
                           const Isometry3d& start, const PoseEstimatorOptions& options) {
  const int n = static_cast<int>(observations.size());
  std::vector<char> inlier(n, 1);
  std::vector<Vector3d> m;
  for (const PointObservation& o : observations) m.push_back(o.measured);
  Vector6d xi = Vector6d::Zero();
  ceres::HuberLoss huber(options.huber);
  LeftPerturbation manifold;
  for (int round = 0; round < 4; ++round) {
    ceres::Problem::Options ownership;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    problem.AddParameterBlock(xi.data(), 6, &manifold);
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_SCHUR;
    solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    solver.linear_solver_ordering->AddElementToGroup(xi.data(), 1);
    for (int i = 0; i < n; ++i) {
      if (!inlier[i]) continue;
      problem.AddResidualBlock(new ObservationCost(camera, observations[i], start, options),
                               round == 0 ? &huber : nullptr, xi.data(), m[i].data());
      solver.linear_solver_ordering->AddElementToGroup(m[i].data(), 0);
    }
    solver.num_threads = 1;
    solver.function_tolerance = 1e-12;
    solver.parameter_tolerance = 1e-9;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    const Isometry3d T = exp_se3(xi) * start;
    bool changed = false;
    for (int i = 0; i < n; ++i) {
      char in = 0;
      ObservationResidual residual;
      if (observation_residual(camera, T, observations[i], m[i], residual)) {
        residual.r += residual.d_measured * (observations[i].measured - m[i]);
        const Eigen::Matrix3d W =
            observation_weight(observations[i], residual, options.sigma_left, options.sigma_right);
        in = residual.r.dot(W * residual.r) <= options.final_gate;
      }
      changed |= in != inlier[i];
      inlier[i] = in;
    }
    if (round > 0 && !changed) break;
  }
  return exp_se3(xi) * start;
}

/// Stereo landmarks 1 to 8 m away, seen again after a motion of up to 0.15 m and 0.1 rad a
/// coordinate; one in twenty is off by up to 20 px, as what RANSAC lets through at worst.
std::vector<PointObservation> observations_of(const StereoCamera& camera, int n,
                                              const Isometry3d& T, std::mt19937_64& rng,
                                              const PoseEstimatorOptions& options) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  std::vector<PointObservation> out;
  while (static_cast<int>(out.size()) < n) {
    const double u = 20 + 600 * uniform(rng), v = 20 + 440 * uniform(rng), z = 1 + 7 * uniform(rng);
    const double d = camera.left.fx * camera.baseline / z;
    const Vector3d Y = T * camera.triangulate(u, v, d);
    if (!(Y.z() > 0.3) || !camera.left.in_image(camera.left.project(Y))) continue;
    PointObservation o;
    o.sigma << 0.05, 0.05, 0.25;
    o.measured << u + 0.05 * normal(rng), v + 0.05 * normal(rng), d + 0.25 * normal(rng);
    o.left =
        camera.left.project(Y) + options.sigma_left * Eigen::Vector2d(normal(rng), normal(rng));
    o.right = camera.left.project(Y - Vector3d(camera.baseline, 0, 0)).x() +
              options.sigma_right * normal(rng);
    if (out.size() % 20 == 0) o.left += Eigen::Vector2d(40 * uniform(rng) - 20, 8.0);
    out.push_back(o);
  }
  return out;
}

void compare_refinement() {
  StereoCamera camera;
  const PoseEstimatorOptions options;
  std::printf("Refinement, 200 scenes each: difference of the poses, mean error, time\n");
  for (const int n : {60, 150, 300}) {
    std::mt19937_64 rng(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<double> metres;
    double ours_error = 0.0, ceres_error = 0.0;
    double ours_ms = 0.0, ceres_ms = 0.0;
    constexpr int kScenes = 200;
    for (int scene = 0; scene < kScenes; ++scene) {
      Vector6d motion, off;
      for (int i = 0; i < 6; ++i) {
        motion[i] = uniform(rng) * (i < 3 ? 0.15 : 0.1);
        off[i] = uniform(rng) * (i < 3 ? 0.02 : 0.01);
      }
      const Isometry3d truth = exp_se3(motion), start = exp_se3(off) * truth;
      const auto observations = observations_of(camera, n, truth, rng, options);
      ProcessorStopwatch watch;
      const PoseEstimate ours = refine_pose(camera, observations, {}, start, options);
      ours_ms += watch.lap();
      const Isometry3d theirs = refine_by_ceres(camera, observations, start, options);
      ceres_ms += watch.lap();
      metres.push_back(log_se3(ours.T_CW * theirs.inverse()).head<3>().norm());
      ours_error += log_se3(ours.T_CW * truth.inverse()).head<3>().norm() / kScenes;
      ceres_error += log_se3(theirs * truth.inverse()).head<3>().norm() / kScenes;
    }
    std::printf(
        "  %3d points: %.0e m median, %.0e m in 95 %%, %.0e m at most; ours %.3f mm, %.3f ms; "
        "Ceres "
        "%.3f mm, %.3f ms; ratio %.1f\n",
        n, quantile(metres, 0.5), quantile(metres, 0.95), quantile(metres, 1.0), 1e3 * ours_error,
        ours_ms / kScenes, 1e3 * ceres_error, ceres_ms / kScenes, ceres_ms / ours_ms);
  }
}

// ---- Tracking -----------------------------------------------------------------------------------

struct Errors {
  std::vector<double> pixels;
  int asked = 0;
};

/// Levels of the pyramid above the image, window and iterations: the same for both.
constexpr int kTop = 3, kWindow = 15;

struct OpenCvImage {
  std::vector<cv::Mat> pyramid;
  explicit OpenCvImage(const Image& image) {
    const cv::Mat grey(image.height, image.width, CV_8U,
                       const_cast<std::uint8_t*>(image.pixels.data()));
    cv::buildOpticalFlowPyramid(grey, pyramid, {kWindow, kWindow}, kTop);
  }
};

/// `points` of `from` in `to`, from `starts`, and back: those that return to within half a pixel.
void track_by_opencv(const OpenCvImage& from, const OpenCvImage& to,
                     const std::vector<cv::Point2f>& points, std::vector<cv::Point2f>& starts,
                     std::vector<uchar>& good) {
  if (points.empty()) return;
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.01);
  std::vector<float> error;
  std::vector<uchar> back_good;
  std::vector<cv::Point2f> back = points;
  cv::calcOpticalFlowPyrLK(from.pyramid, to.pyramid, points, starts, good, error,
                           {kWindow, kWindow}, kTop, criteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  cv::calcOpticalFlowPyrLK(to.pyramid, from.pyramid, starts, back, back_good, error,
                           {kWindow, kWindow}, kTop, criteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  for (std::size_t i = 0; i < points.size(); ++i) {
    good[i] = good[i] && back_good[i] && cv::norm(back[i] - points[i]) <= 0.5;
  }
}

/// What a method has lost and missed, by the frames that are shown.
void tell_errors(const std::vector<int>& shown, const std::vector<Errors>& errors) {
  for (std::size_t s = 0; s < shown.size(); ++s) {
    const Errors& e = errors[s];
    const auto off =
        std::count_if(e.pixels.begin(), e.pixels.end(), [](double p) { return p > 1; });
    std::printf(
        "    frame %2d: %5.1f %% tracked, error %.3f px median, %.3f px in 95 %%; off by > 1 px "
        "%.1f %%\n",
        shown[s], 100.0 * static_cast<double>(e.pixels.size()) / std::max(1, e.asked),
        quantile(e.pixels, 0.5), quantile(e.pixels, 0.95),
        100.0 * static_cast<double>(off) /
            std::max<double>(1.0, static_cast<double>(e.pixels.size())));
  }
}

/// Whether what is `depth` [m] before the camera and projects to `pixel` is in view and not hidden.
bool is_shown(const test::RenderedRoom& room, const StereoCamera& camera, const Isometry3d& T_WC,
              double depth, const Eigen::Vector2d& pixel) {
  return depth > 0.2 && pixel.x() >= 12 && pixel.x() < 628 && pixel.y() >= 12 && pixel.y() < 468 &&
         std::abs(room.depth(camera.left, T_WC, pixel.x(), pixel.y()) - depth) < 0.01 * depth;
}

void compare_tracking() {
  StereoCamera camera;
  camera.left = {440.0, 440.0, 320.0, 240.0, 640.0, 480.0};
  const test::RenderedRoom room;
  constexpr int kFrames = 16;
  // Three ways through the room: ahead, past the pillar with a turn, and turning.
  const auto pose = [](int way, int k) {
    const double t = k;
    return way == 0 ? test::RenderedRoom::looking(-1.5 + 0.05 * t, -0.4, 1.05, 0.1)
           : way == 1
               ? test::RenderedRoom::looking(-1.5 + 0.04 * t, -1.2 + 0.03 * t, 1.05, 0.1 + 0.01 * t)
               : test::RenderedRoom::looking(-0.5, 0.2 + 0.01 * t, 1.05, 0.5 - 0.03 * t);
  };
  const std::vector<int> shown = {1, 4, 8, 15};
  const char* const names[] = {"ours: keyframe's patch, warped", "OpenCV, frame to frame",
                               "OpenCV, from the keyframe"};
  std::vector<std::vector<Errors>> errors(3, std::vector<Errors>(shown.size()));
  double ms[3] = {0, 0, 0};
  int frames = 0, corners_found = 0, tracks[3] = {0, 0, 0};
  for (int way = 0; way < 3; ++way) {
    const Isometry3d T_WA = pose(way, 0);
    const Image first = room.render(camera.left, T_WA, 2.0, 1000 * way);
    const std::vector<Vector2f> corners = detect_corners(first.view());
    corners_found += static_cast<int>(corners.size());
    std::vector<Vector3d> points;  // in the keyframe's camera
    std::vector<cv::Point2f> keyframe_points;
    for (const Vector2f& c : corners) {
      const double z = room.depth(camera.left, T_WA, c.x(), c.y());
      points.push_back(z * Vector3d((c.x() - camera.left.cx) / camera.left.fx,
                                    (c.y() - camera.left.cy) / camera.left.fy, 1.0));
      keyframe_points.emplace_back(c.x(), c.y());
    }
    const ImagePyramid anchor(first.view(), kTop + 1);
    const OpenCvImage keyframe(first);
    OpenCvImage last = keyframe;
    std::vector<cv::Point2f> chained = keyframe_points, direct = keyframe_points;
    std::vector<char> alive(points.size(), 1), direct_alive(points.size(), 1);
    for (int k = 1; k < kFrames; ++k) {
      const Isometry3d T_WC = pose(way, k), before = pose(way, k - 1);
      const Image image = room.render(camera.left, T_WC, 2.0, 1000 * way + k);
      // Truth; a point that is hidden or out of view is asked of nobody.
      std::vector<Eigen::Vector2d> truth(points.size());
      std::vector<char> visible(points.size(), 0);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector3d Y = T_WC.inverse() * (T_WA * points[i]);
        truth[i] = camera.left.project(Y);
        visible[i] = is_shown(room, camera, T_WC, Y.z(), truth[i]);
      }
      const auto note = [&](int method, std::size_t i, double x, double y, bool tracked) {
        tracks[method] += tracked;
        for (std::size_t s = 0; s < shown.size(); ++s) {
          if (shown[s] != k || !visible[i]) continue;
          ++errors[method][s].asked;
          if (tracked)
            errors[method][s].pixels.push_back(std::hypot(x - truth[i].x(), y - truth[i].y()));
        }
      };
      ++frames;
      ProcessorStopwatch watch;
      // Ours, as the odometry does: predicted with the pose of the frame before, which is as much
      // as OpenCV has in the point's last place.
      const ImagePyramid pyramid(image.view(), kTop + 1);
      const Isometry3d T = before.inverse() * T_WA;
      std::vector<TrackResult> found(points.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector3d Y = T * points[i];
        if (!(Y.z() > 0.1)) continue;
        const Eigen::Matrix<double, 2, 3> P = camera.left.projection_jacobian(Y);
        Eigen::Matrix2d B;
        B.col(0) = P * T.linear().col(0) * (points[i].z() / camera.left.fx);
        B.col(1) = P * T.linear().col(1) * (points[i].z() / camera.left.fy);
        const Vector2f start = camera.left.project(Y).cast<float>();
        found[i] = track_patch(anchor, corners[i], pyramid, {start, B.inverse().cast<float>()},
                               {kTop, 0}, true);
      }
      ms[0] += watch.lap();
      const OpenCvImage now(image);
      const double pyramid_ms = watch.lap();
      std::vector<cv::Point2f> from, to;
      std::vector<std::size_t> index;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (!alive[i]) continue;
        from.push_back(chained[i]);
        index.push_back(i);
      }
      to = from;
      std::vector<uchar> good(from.size(), 0);
      track_by_opencv(last, now, from, to, good);
      for (std::size_t j = 0; j < index.size(); ++j) {
        alive[index[j]] = static_cast<char>(good[j]);
        chained[index[j]] = to[j];
      }
      ms[1] += pyramid_ms + watch.lap();
      std::vector<cv::Point2f> starts = direct;
      std::vector<uchar> direct_good(starts.size(), 0);
      track_by_opencv(keyframe, now, keyframe_points, starts, direct_good);
      for (std::size_t i = 0; i < points.size(); ++i) {
        direct_alive[i] = static_cast<char>(direct_good[i]);
        if (direct_good[i]) direct[i] = starts[i];
      }
      ms[2] += pyramid_ms + watch.lap();
      for (std::size_t i = 0; i < points.size(); ++i) {
        note(0, i, found[i].position.x(), found[i].position.y(),
             found[i].outcome == TrackOutcome::kTracked);
        note(1, i, chained[i].x, chained[i].y, alive[i] != 0);
        note(2, i, starts[i].x, starts[i].y, direct_alive[i] != 0);
      }
      last = now;
    }
  }
  std::printf(
      "Tracking, three ways through the rendered room, %d frames of 640 x 480, %d corners\n",
      frames, corners_found / 3);
  for (int method = 0; method < 3; ++method) {
    std::printf("  %-31s %5.2f ms a frame, %.1f us a track\n", names[method], ms[method] / frames,
                1e3 * ms[method] / std::max(1, tracks[method]));
    tell_errors(shown, errors[static_cast<std::size_t>(method)]);
  }
}

}  // namespace
}  // namespace prospect

int main() {
  cv::setNumThreads(1);
  prospect::compare_refinement();
  prospect::compare_tracking();
  return 0;
}
