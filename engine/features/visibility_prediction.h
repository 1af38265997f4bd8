// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "engine/features/visibility_kernel.h"
#include "engine/maps/landmark_map.h"
#include "engine/maps/odometry_noise.h"
#include "engine/problem/term.h"
#include "engine/problem/trajectory.h"
#include "models/camera.h"

namespace prospect {

class Knobs;

class OcclusionTable;

/// What decides whether a point is seen. Widths are those of logistic functions: 0.5 at the limit,
/// 0.73 one width inside, 0.95 three widths inside.
struct VisibilityParameters {
  double sigma_px = 0.5;         ///< noise of an image point [px], > 0: the sigma_px of S_ik
  double border_px = 8.0;        ///< strip along the image border where nothing can be tracked [px]
  double border_sigma_px = 8.0;  ///< softness of that border [px]: added to S_ik in P_fov only
  double r_min = 0.4;            ///< smallest depth at which points are matched [m]
  double r_max = 6.0;            ///< largest useful depth [m]
  double r_min_width = 0.05;     ///< [m]
  double r_max_width = 0.3;      ///< [m]
  double scale_min = 0.6;        ///< range over creation range at which tracking is lost [-]
  double scale_max = 1.7;
  double scale_width = 0.05;
  double view_angle = 0.66;        ///< largest angle to the creation view [rad] (38 degrees)
  double view_angle_width = 0.05;  ///< at that limit [rad]
  OdometryNoise odometry;
};

/// The knobs (models/knobs.h) but those of the odometry, which are described for themselves.
void describe(Knobs& knobs, VisibilityParameters& parameters);

/// The same for counting the points that are tracked, whether as themselves or detected anew: a
/// tracker that loses a landmark because it looks from elsewhere finds the same texture there
/// again, and makes a landmark of it. No limit of scale; of view, 1.4 rad, beyond which a point on
/// a surface that could be looked at in the first place is likely to be behind it.
VisibilityParameters with_redetected_landmarks(VisibilityParameters parameters = {});

/// Expected number of visible landmarks along a trajectory.
///
///   Sigma_rel,0 = 0,   Sigma_rel,k+1 = F_k Sigma_rel,k F_k^T + W_k(N_k)     over (x, y, z, yaw) in
///   W F_k = I + (-(y_{k+1} - y_k)) e_x e_yaw^T + (x_{k+1} - x_k) e_y e_yaw^T W_k = c(N_k)
///   diag(w_p, w_p, w_z, w_yaw),  w from OdometryNoise with
///         s = sqrt(|p_{k+1} - p_k|^2 + e^2) - e,  a = sqrt(dyaw^2 + e^2) - e,  e = 1 mm, 1 mrad
///         w_z = w_p for bases that move in 3-D, 0 for a base on the plane (its height is known)
///   Sigma_k = Sigma_rel,k + scale^2 d_k d_k^T,  d_k = p_k - p_0: an error of the scale is the same
///         at all stages, so it does not add up like noise
///   S_ik = H_x Sigma_k H_x^T + H_l Sigma_i H_l^T + sigma_px^2 I                      [px^2]
///   pi_ik = tau_i P_fov P_range P_view P_unoccluded P_cell
///   N_k = sum_i mu_i pi_ik (+ prior),   Var N_k = sum_i mu_i pi_ik (1 - pi_ik) (+ prior),
///   mu_i the landmarks that i stands for (Landmark::multiplicity)
///
/// Sigma_k is the uncertainty of the pose at stage k relative to the pose now: the map drifts
/// with the odometry's frame, so the present pose is exact with respect to it. F_k is the Jacobian
/// of compounding a displacement measured in the body frame; for every motion model of this project
/// it is A_k restricted to the pose.
///
/// P_fov = [Phi((u_1 - u)/s_u) - Phi((u_0 + d - u)/s_u)] [Phi((v_1 - v)/s_v) - Phi((v_0 - v)/s_v)]
///   with s_u^2 = S_uu + border_sigma_px^2 and the marginals of S_ik, d = fx b / Z: a point is in
///   the right image exactly if u_left - d is.
/// P_range: logistic in depth at r_min and r_max, and in range/creation range at scale_min and
///   scale_max. P_view: logistic in the cosine of the angle to the creation view (smooth at angle
///   0).
/// P_unoccluded: an OcclusionTable at the sensor's position; without one, 1.
/// P_cell = (6 + m) / (6 + 4 m + m^2), m = c_i Z^2 (Landmark::per_cell): that i is the one that a
///   tracker with one landmark an image cell keeps, m others being expected in its cell. It is
///   E[1 / (1 + K)] = (1 - e^-m) / m of a Poisson number K with mean m, within 0.02, without an
///   exponential.
///
/// Near the camera plane all of this is multiplied by a quintic gate in depth that is exactly 0 up
/// to near_depth() and 1 from twice that: twice continuously differentiable, and no division by
/// small depths. near_depth() is at least the depth at which the two images stop overlapping.
///
/// Smoothness: C1 in all poses (twice continuously differentiable but for P_unoccluded).
/// Thread-safety: immutable after construction; concurrent calls need separate scratch.
/// Source: formulation, section 3; exploration notes 5.5 for the relative covariance.
class VisibilityPrediction {
 public:
  /// `landmarks`: in the order of the points of `occlusion` (null: nothing is occluded).
  /// Throws std::invalid_argument naming the entry, its value and what was expected: non-finite or
  /// non-PSD landmarks, survival outside [0, 1], non-positive widths or noise, an occlusion table
  /// of other points. `kernel`: any of available_visibility_kernels(), the result does not depend
  /// on it.
  VisibilityPrediction(const std::vector<Landmark>& landmarks, const StereoCamera& camera,
                       const CameraMount& mount, std::shared_ptr<const OcclusionTable> occlusion,
                       const VisibilityParameters& parameters,
                       const VisibilityKernel& kernel = best_visibility_kernel());

  int num_landmarks() const { return num_landmarks_; }
  double near_depth() const { return constants_.near_depth; }
  const VisibilityParameters& parameters() const { return parameters_; }
  const StereoCamera& camera() const { return camera_; }
  const CameraMount& mount() const { return mount_; }

  /// Sensor position in W for a pose of the base [m].
  Eigen::Vector3d sensor_position(const Pose& pose) const;

  /// pi_i of every landmark at a pose whose uncertainty relative to now is `sigma_rel` (over x, y,
  /// z, yaw; zero by default). Allocates; for reports and for predicting what will be tracked.
  Eigen::VectorXd probabilities(const Pose& pose,
                                const Eigen::Matrix4d& sigma_rel = Eigen::Matrix4d::Zero()) const;

  /// N_k without prior, k = 0..N, of candidate b. Allocates; for reports.
  std::vector<double> visible(const TrajectoryBatch& trajectories, int b) const;

  /// Sigma_k, k = 0..N, of candidate b; prior_count as of propagate(). Allocates; for reports.
  std::vector<Eigen::Matrix4d> relative_covariances(const TrajectoryBatch& trajectories, int b,
                                                    const double* prior_count = nullptr) const;

  /// What a pass along one trajectory leaves behind. All arrays have N + 1 entries.
  struct Stages {
    // Written by propagate().
    std::vector<double> count;     ///< N_k, prior included
    std::vector<double> variance;  ///< Var N_k, prior included
    std::vector<double> log_det;   ///< log det(Lambda_0 + sum_i pi H^T S^-1 H), if asked for
    // To be filled in by the caller before pull_back(): derivatives of the cost.
    std::vector<double> count_adjoint;
    std::vector<double> variance_adjoint;
    std::vector<double> log_det_adjoint;
    // Written by pull_back(): derivative of the cost with respect to prior_count[k].
    std::vector<double> prior_adjoint;
  };

  /// What is to be computed besides the count.
  struct Request {
    bool gradient = false;
    bool variance = false;
    bool information = false;
    /// In single precision (VisibilityKernel::score), for comparing candidates. Of no effect with
    /// `gradient`.
    bool score = false;
    /// Prior information Lambda_0 of the camera's pose, diagonal: on translation [1/m^2] and
    /// rotation [1/rad^2]; > 0, so that log det is finite without a landmark.
    double prior_translation = 1.0;
    double prior_rotation = 1.0;
  };

  /// Scratch for propagate() and pull_back() over this horizon.
  std::unique_ptr<TermScratch> make_scratch(const Horizon& horizon) const;

  /// Runs the recursion along candidate b and fills `count`, `variance`, `log_det` of
  /// stages(scratch). `prior_count`: N + 1 expected points not mapped yet (rho A_k), or null. They
  /// add to N_k, and, being a Poisson number, as much to Var N_k (our choice). Returns false, and
  /// leaves the stages unspecified, if a pose is not finite or beyond 1e8.
  bool propagate(const TrajectoryBatch& trajectories, int b, const Request& request,
                 const double* prior_count, TermScratch& scratch) const;

  /// The reverse sweep: adds the exact derivative of a cost with the adjoints in stages(scratch)
  /// into the gradient of candidate b: through projection, all covariances, the recursion of
  /// Sigma_rel and its dependence on the counts. After propagate() with gradient = true on the same
  /// trajectory.
  void pull_back(const TrajectoryBatch& trajectories, int b, TermScratch& scratch,
                 TermOutput& out) const;

  static Stages& stages(TermScratch& scratch);

 private:
  class Scratch;
  /// Sigma_k of Sigma_rel,k and d_k.
  Eigen::Matrix4d with_scale(const Eigen::Matrix4d& sigma, const Eigen::Vector3d& d) const;
  VisibilityKernelStage stage_inputs(const Pose& pose, const Eigen::Matrix4d& sigma) const;
  void unoccluded(const Eigen::Vector3d& sensor, bool gradient, Scratch& scratch) const;
  /// information: null, or 6 x 6, without the prior.
  void score(const VisibilityKernelStage& stage, Scratch& scratch, VisibilitySums& sums,
             double* information) const;

  int num_landmarks_ = 0;
  StereoCamera camera_;
  CameraMount mount_;
  std::shared_ptr<const OcclusionTable> occlusion_;
  VisibilityParameters parameters_;
  VisibilityKernelConstants constants_;
  std::vector<VisibilityBlock> blocks_;
  Eigen::Vector3d score_origin_ = Eigen::Vector3d::Zero();  ///< of positions in score_blocks_
  std::vector<VisibilityScoreBlock> score_blocks_;
  VisibilityKernel kernel_;
};

}  // namespace prospect
