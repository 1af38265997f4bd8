#include "perception/odometry/drift_measurement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstddef>

#include "engine/support/cholesky.h"

namespace prospect {

PoseDrift::Measurement drift_measurement(const StereoCamera& camera,
                                         const std::vector<Track>& tracks,
                                         const TrackObservations& observations,
                                         const PoseEstimate& pose,
                                         const PoseEstimatorOptions& options,
                                         double noise_variance) {
  PoseDrift::Measurement m;
  PoseDrift::Matrix6d H = PoseDrift::Matrix6d::Zero(), by_anchors = H;
  for (std::size_t k = 0; k < observations.index.size(); ++k) {
    const PointObservation& seen = observations.seen[k];
    ObservationResidual residual;
    if (!pose.inlier[k] ||
        !observation_residual(camera, pose.T_CW, seen, pose.measured[k], residual)) {
      continue;
    }
    const Eigen::Matrix<double, 6, 3> JW =
        residual.d_pose.transpose() *
        observation_weight(seen, residual, options.sigma_left, options.sigma_right);
    const Track& track = tracks[observations.index[k]];
    auto reference =
        std::find_if(m.references.begin(), m.references.end(),
                     [&](const PoseDrift::Reference& r) { return r.anchor == track.anchor->id; });
    if (reference == m.references.end()) {
      m.references.push_back({track.anchor->id, pose.T_CW * track.anchor->T_CW.inverse(),
                              PoseDrift::Matrix6d::Zero()});
      reference = m.references.end() - 1;
    }
    const PoseDrift::Matrix6d information = JW * residual.d_pose;
    reference->information += information;
    H += information;
    m.by_calibration += JW * by_calibration(camera, seen, residual, pose.measured[k]);
    const Eigen::Matrix<double, 6, 3> gain = JW * residual.d_measured;
    const Eigen::Vector3d variance = seen.sigma.cwiseAbs2();
    by_anchors += gain * variance.asDiagonal() * gain.transpose();
    m.sights.push_back({track.id, gain, noise_variance * variance});
  }
  const Eigen::LDLT<PoseDrift::Matrix6d> solver(H);
  const PoseDrift::Matrix6d noise = solver.solve(solver.solve(H - by_anchors).transpose());
  m.noise = 0.5 * noise_variance * (noise + noise.transpose());
  return m;
}

}  // namespace prospect
