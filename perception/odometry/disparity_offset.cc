#include "perception/odometry/disparity_offset.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "engine/support/cholesky.h"

namespace prospect {

DisparityOffsetEvidence disparity_offset_evidence(const StereoCamera& camera,
                                                  const std::vector<PointObservation>& observations,
                                                  const PoseEstimate& estimate,
                                                  const std::vector<char>& use,
                                                  const PoseEstimatorOptions& options) {
  Eigen::Matrix<double, 7, 7> H = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Matrix<double, 7, 1> g = Eigen::Matrix<double, 7, 1>::Zero();
  ObservationResidual residual;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!estimate.inlier[i] || !use[i]) continue;
    const PointObservation& o = observations[i];
    const Eigen::Vector3d& m = estimate.measured[i];
    if (!observation_residual(camera, estimate.T_CW, o, m, residual)) continue;
    Eigen::Matrix<double, 3, 7> J;
    J.leftCols<6>() = residual.d_pose;
    J.col(6) = residual.d_measured.col(2);
    if (o.sees_right()) J(2, 6) -= 1.0;
    const Eigen::Matrix3d W =
        observation_weight(o, residual, options.sigma_left, options.sigma_right);
    const Eigen::Matrix<double, 7, 3> JW = J.transpose() * W;
    H.noalias() += JW * J;
    g.noalias() += JW * (residual.r + residual.d_measured * (o.measured - m));
  }
  DisparityOffsetEvidence evidence;
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> pose(
      Eigen::Matrix<double, 6, 6>(H.topLeftCorner<6, 6>()));
  if (pose.info() != Eigen::Success || !pose.isPositive()) return evidence;
  const Eigen::Matrix<double, 6, 1> cross = H.topRightCorner<6, 1>();
  const double information = H(6, 6) - cross.dot(pose.solve(cross));
  const double gradient = g[6] - cross.dot(pose.solve(Eigen::Matrix<double, 6, 1>(g.head<6>())));
  if (!std::isfinite(information) || !std::isfinite(gradient) || information <= 0.0) {
    return evidence;
  }
  const double scale = std::max(1.0, estimate.chi2_per_dof);
  return {information / scale, gradient / scale};
}

double DisparityOffset::sigma() const { return std::sqrt(variance_); }

double DisparityOffset::update(const DisparityOffsetEvidence& evidence) {
  if (!estimated()) return 0.0;
  variance_ += options_.walk_sigma * options_.walk_sigma;
  variance_ = std::min(variance_, options_.prior_sigma * options_.prior_sigma);
  const double information = options_.trust * evidence.information;
  variance_ = 1.0 / (1.0 / variance_ + information);
  const double before = value_;
  value_ = std::clamp(value_ - variance_ * options_.trust * evidence.gradient, -options_.max_offset,
                      options_.max_offset);
  return value_ - before;
}

}  // namespace prospect
