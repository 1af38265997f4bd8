// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/drift_measurement.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <utility>

#include "engine/support/cholesky.h"
#include "perception/odometry/se3.h"

namespace prospect {
namespace {

using Matrix6d = PoseDrift::Matrix6d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// What is added up by number, in the order of its first time.
template <typename Value>
class Sums {
 public:
  Value& operator[](std::uint64_t number) {
    const auto [at, is_new] = places_.try_emplace(number, all.size());
    if (is_new) all.emplace_back(number, Value::Zero());
    return all[at->second].second;
  }
  std::vector<std::pair<std::uint64_t, Value>> all;

 private:
  std::unordered_map<std::uint64_t, std::size_t> places_;
};

/// What the observations of a part of the image say of a pose.
struct Part {
  Matrix6d information;  // sum of J^T W J
  Vector6d gradient;     // sum of J^T W r
};

/// Ratio of variances from which on the parts of an image disagree about the pose.
constexpr double kDisagree = 9.0;

/// By what the noise of a pose is larger for parts of the image that disagree; see of_pose().
Matrix6d disagreement(const std::vector<Part>& parts, const Matrix6d& H, const Matrix6d& C) {
  Matrix6d D = Matrix6d::Zero(), more = D;
  for (const Part& part : parts) {
    const Eigen::LDLT<Matrix6d> rest(H - part.information);
    // Nothing is known of what only this part fixes.
    if (rest.info() != Eigen::Success || !rest.isPositive()) continue;
    const Vector6d change = rest.solve(part.gradient);
    if (change.allFinite()) D += change * change.transpose();
  }
  const auto K = static_cast<double>(parts.size());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> spectrum((K - 1.0) / K * D, C);
  if (spectrum.info() != Eigen::Success) return more;
  for (int i = 0; i < 6; ++i) {
    const double lambda = spectrum.eigenvalues()[i];
    if (!(lambda > kDisagree)) continue;
    const Vector6d along = C * spectrum.eigenvectors().col(i);
    more += (lambda - 1.0) * along * along.transpose();
  }
  return more;
}

}  // namespace

bool DriftMeasurement::linearise(std::size_t k, Linearised& at) const {
  const PointObservation& seen = observations_.seen[k];
  const Eigen::Vector3d& m = pose_.measured[k];
  if (!pose_.inlier[k] || !observation_residual(camera_, pose_.T_CW, seen, m, at.residual)) {
    return false;
  }
  at.track = &tracks_[static_cast<std::size_t>(observations_.index[k])];
  at.numbers = error_numbers(*at.track, camera_.left.width, camera_.left.height);
  at.W = observation_weight(seen, at.residual, options_.sigma_left, options_.sigma_right);
  at.by_calibration = by_calibration(camera_, seen, at.residual, m);
  at.errors =
      observation_errors(seen, at.residual, options_.sigma_left, options_.sigma_right, shared_);
  at.residual.r += at.residual.d_measured * (seen.measured - m);
  return true;
}

PoseDrift::Measurement DriftMeasurement::of_pose() const {
  PoseDrift::Measurement m;
  Matrix6d H = Matrix6d::Zero(), noise = H;
  Sums<Eigen::Matrix<double, 6, 3>> gains;
  Sums<Matrix6d> informations;
  Sums<Vector6d> gradients;
  const double scale = std::sqrt(noise_variance_);
  for (std::size_t k = 0; k < observations_.index.size(); ++k) {
    Linearised at;
    if (!linearise(k, at)) continue;
    const Anchor& anchor = *at.track->anchor;
    auto reference =
        std::find_if(m.references.begin(), m.references.end(),
                     [&](const PoseDrift::Reference& r) { return r.anchor == anchor.id; });
    if (reference == m.references.end()) {
      m.references.push_back({anchor.id, pose_.T_CW * anchor.T_CW.inverse(), Matrix6d::Zero()});
      reference = m.references.end() - 1;
    }
    const Eigen::Matrix<double, 6, 3> JW = at.residual.d_pose.transpose() * at.W;
    const Matrix6d information = JW * at.residual.d_pose;
    reference->information += information;
    H += information;
    m.by_calibration += JW * at.by_calibration;
    noise += JW * at.errors.fresh * JW.transpose();
    const Eigen::Matrix<double, 6, 3> scaled = scale * JW;
    gains[at.numbers.landmark] += scaled * at.errors.landmark;
    gains[at.numbers.area] += scaled * at.errors.area;
    gains[at.numbers.image] += scaled * at.errors.image;
    informations[at.numbers.area] += information;
    gradients[at.numbers.area] += JW * at.residual.r;
  }
  for (auto& [number, gain] : gains.all) m.shares.push_back({number, gain});
  const Eigen::LDLT<Matrix6d> solver(H);
  const Matrix6d of_noise = solver.solve(solver.solve(noise).transpose());
  m.noise = 0.5 * noise_variance_ * (of_noise + of_noise.transpose());
  Matrix6d C = m.noise;
  for (const PoseDrift::Share& share : m.shares) {
    const Eigen::Matrix<double, 6, 3> owed = solver.solve(share.gain);
    C += owed * owed.transpose();
  }
  std::vector<Part> parts;
  for (std::size_t k = 0; k < informations.all.size(); ++k) {
    parts.push_back({informations.all[k].second, gradients.all[k].second});
  }
  m.noise += disagreement(parts, H, C);
  return m;
}

std::optional<PoseDrift::Evidence> DriftMeasurement::of_disparity_zero(
    const std::vector<char>& use) const {
  std::vector<Linearised> all;
  Matrix6d H = Matrix6d::Zero();
  Vector6d h = Vector6d::Zero();
  for (std::size_t k = 0; k < observations_.index.size(); ++k) {
    Linearised at;
    if (!use[k] || !linearise(k, at)) continue;
    const Eigen::Matrix<double, 6, 3> JW = at.residual.d_pose.transpose() * at.W;
    H += JW * at.residual.d_pose;
    h += JW * at.by_calibration.col(kDisparityError);
    all.push_back(at);
  }
  if (all.size() < 6) return std::nullopt;
  const Eigen::LDLT<Matrix6d> solver(H);
  if (solver.info() != Eigen::Success || !solver.isPositive()) return std::nullopt;
  const Vector6d along = solver.solve(h);
  const auto weight = [&](const Linearised& at) -> Eigen::RowVector3d {
    return (at.by_calibration.col(kDisparityError) - at.residual.d_pose * along).transpose() * at.W;
  };
  double information = 0.0;
  for (const Linearised& at : all) {
    information += weight(at).dot(at.by_calibration.col(kDisparityError));
  }
  if (!std::isfinite(information) || !(information > 0.0)) return std::nullopt;

  PoseDrift::Evidence evidence;
  Sums<Eigen::Matrix<double, 1, 6>> anchors;
  Sums<Eigen::RowVector3d> errors;
  const double scale = std::sqrt(noise_variance_);
  for (const Linearised& at : all) {
    const Eigen::RowVector3d q = weight(at) / information;
    evidence.value -= q.dot(at.residual.r);
    // Each residual is what is seen less what the pose, the point and the calibration say.
    evidence.by_calibration += q * at.by_calibration;
    const Anchor& anchor = *at.track->anchor;
    anchors[anchor.id] -= q * at.residual.d_pose * adjoint(pose_.T_CW * anchor.T_CW.inverse());
    const Eigen::RowVector3d scaled = -scale * q;
    errors[at.numbers.landmark] += scaled * at.errors.landmark;
    errors[at.numbers.area] += scaled * at.errors.area;
    errors[at.numbers.image] += scaled * at.errors.image;
    evidence.noise += noise_variance_ * q.dot(at.errors.fresh * q.transpose());
  }
  evidence.anchors = std::move(anchors.all);
  evidence.errors = std::move(errors.all);
  return evidence;
}

}  // namespace prospect
