// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/features/visibility_prediction.h"
#include "engine/problem/term.h"
#include "engine/terms/new_surface.h"

namespace prospect {

class Knobs;

/// What is asked of the predicted features.
enum class VisibilityCriterion {
  kCount,       ///< psi(N_k): enough points in view
  kInformation  ///< log det of what they tell about the pose: enough, and well placed
};

struct VisibleFeaturesParameters {
  VisibilityCriterion criterion = VisibilityCriterion::kCount;

  double N_req = 30.0;  ///< points at which the cost vanishes
  double beta = 0.2;    ///< sharpness of the softplus [1/point]

  double N_min = 20.0;         ///< points below which the odometry is not to be trusted
  double z = 1.645;            ///< quantile of the normal distribution (5 %)
  double chance_beta = 1.0;    ///< sharpness of the softplus in the penalty [1/point]
  double chance_weight = 0.0;  ///< weight of the chance penalty inside VisibleFeatures; 0: off

  /// Information: the required standard deviation of the camera's pose from one image, and the
  /// standard deviation known without an image (the regularisation Lambda_0).
  double required_translation = 0.003;  ///< [m]
  double required_rotation = 0.001;     ///< [rad]
  double prior_translation = 0.3;       ///< [m]
  double prior_rotation = 0.1;          ///< [rad]
  double information_beta = 4.0;        ///< sharpness of the softplus [1/e-fold]

  /// rho [points/m^2] of the prior for points not seen yet; 0: off. LandmarkMap::feature_density.
  double rho = 0.0;
};

/// The knobs (models/knobs.h); rho and chance_weight are the planner's.
void describe(Knobs& knobs, VisibleFeaturesParameters& parameters);

/// psi(N) = (softplus_beta(N_req - N) / N_req)^2, softplus_beta(x) = log(1 + exp(beta x)) / beta,
/// and d psi/dN unless null. Tends to 0 with its derivative, exponentially, above N_req.
double visible_features_cost(double N, double N_req, double beta, double* derivative = nullptr);

/// chi(N, Var) = softplus_beta(N_min + z sqrt(Var + 0.01) - N) / N_min: smooth form of the exact
/// penalty max(0, .) that the slack of N - z sqrt(Var) >= N_min - s, s >= 0 leaves behind.
double visible_features_chance(double N, double variance, double N_min, double z, double beta,
                               double* d_N = nullptr, double* d_variance = nullptr);

/// Cost of losing the features that the odometry lives on.
///
///   count:        T = 1/N sum_{k=1..N} psi(N_k)           [+ chance_weight * chi, see below]
///   information:  T = 1/N sum_{k=1..N} (softplus_b(l_req - l_k) / (l_req - l_0))^2,
///                 l_k = 1/6 log det(Lambda_0 + sum_i pi_ik H_i^T S_ik^-1 H_i)
///
/// H_i (2 x 6) is the Jacobian of the projection with respect to a displacement and rotation of the
/// camera in its own frame. All six degrees of freedom, also for a base on the plane: the odometry
/// estimates all of them. log det does not depend on the frame they are written in. l_req and l_0
/// are the values of l at the required and at the prior standard deviations, hence T = 1 without
/// points for either criterion, and 0 where enough is seen. The form is our choice; the formulation
/// asks for log det sum_i pi H^T S^-1 H.
///
/// With rho > 0 and a NewSurface, N_k includes the expected number of points not mapped yet, rho
/// A_k. The sum starts at k = 1: x_0 is given.
///
/// Unit: -. Normalised: 1 when nothing is seen all along. Smoothness C1, exact gradient.
/// Source: formulation, section 3.
class VisibleFeatures : public Term {
 public:
  /// Throws std::invalid_argument (null prediction, rho > 0 without a NewSurface, a non-positive or
  /// non-finite parameter).
  VisibleFeatures(std::shared_ptr<const VisibilityPrediction> prediction,
                  const VisibleFeaturesParameters& parameters,
                  std::shared_ptr<const NewSurface> new_surface = nullptr);

  std::string_view name() const override { return "visible_features"; }
  TermTraits traits() const override;
  /// No structure but the bound 0: N_k depends on all stages before k.
  std::optional<ResidualForm> residual_form(const Horizon&, int sign) const override {
    if (sign < 0) return std::nullopt;
    return ResidualForm{};
  }
  std::unique_ptr<TermScratch> make_scratch(const Horizon& horizon, int max_batch) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

  /// N_k, k = 0..N, of candidate b, prior included. Allocates; for reports.
  std::vector<double> visible(const TrajectoryBatch& trajectories, int b) const;

  const VisibilityPrediction& prediction() const { return *prediction_; }
  const VisibleFeaturesParameters& parameters() const { return parameters_; }

 protected:
  /// The weights of psi (or the information cost) and of chi in the value.
  VisibleFeatures(std::shared_ptr<const VisibilityPrediction> prediction,
                  const VisibleFeaturesParameters& parameters,
                  std::shared_ptr<const NewSurface> new_surface, double criterion_weight,
                  double chance_weight);

 private:
  /// The value from what the stages hold; fills in their adjoints.
  double cost(int N, VisibilityPrediction::Stages& stages) const;

  std::shared_ptr<const VisibilityPrediction> prediction_;
  VisibleFeaturesParameters parameters_;
  std::shared_ptr<const NewSurface> new_surface_;
  double criterion_weight_;
  double chance_weight_;
  double l_required_;
  double l_prior_;
};

/// The chance constraint N_k - z sqrt(Var N_k) >= N_min - s_k, s_k >= 0, with the slack eliminated:
///
///   T = 1/N sum_{k=1..N} chi(N_k, Var N_k)
///
/// as a term of its own, so that it has its own weight and its own line in a report. Beside
/// VisibleFeatures it repeats the prediction; chance_weight there shares it.
///
/// Unit: -. Normalised: 1 when nothing is seen all along. Smoothness C1, exact gradient.
/// Source: formulation, section 3.
class VisibleFeaturesChance final : public VisibleFeatures {
 public:
  VisibleFeaturesChance(std::shared_ptr<const VisibilityPrediction> prediction,
                        const VisibleFeaturesParameters& parameters,
                        std::shared_ptr<const NewSurface> new_surface = nullptr);
  std::string_view name() const override { return "visible_features_chance"; }
};

}  // namespace prospect
