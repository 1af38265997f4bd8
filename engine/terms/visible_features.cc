// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/visible_features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr double kVarianceFloor = 0.01;  // keeps sqrt(Var) smooth where nothing is visible

// log(1 + exp(beta x)) / beta and its derivative, without overflow.
double softplus(double x, double beta, double& derivative) {
  const double y = beta * x;
  const double e = std::exp(-std::abs(y));
  derivative = y >= 0.0 ? 1.0 / (1.0 + e) : e / (1.0 + e);
  return (std::max(y, 0.0) + std::log1p(e)) / beta;
}

struct Scratch final : TermScratch {
  std::unique_ptr<TermScratch> prediction;
  std::unique_ptr<TermScratch> new_surface;
  std::vector<double> prior;
};

}  // namespace

double visible_features_cost(double N, double N_req, double beta, double* derivative) {
  double slope;
  const double missing = softplus(N_req - N, beta, slope) / N_req;
  if (derivative) *derivative = -2.0 * missing * slope / N_req;
  return missing * missing;
}

double visible_features_chance(double N, double variance, double N_min, double z, double beta,
                               double* d_N, double* d_variance) {
  const double deviation = std::sqrt(variance + kVarianceFloor);
  double slope;
  const double value = softplus(N_min + z * deviation - N, beta, slope) / N_min;
  if (d_N) *d_N = -slope / N_min;
  if (d_variance) *d_variance = slope / N_min * z * 0.5 / deviation;
  return value;
}

VisibleFeatures::VisibleFeatures(std::shared_ptr<const VisibilityPrediction> prediction,
                                 const VisibleFeaturesParameters& parameters,
                                 std::shared_ptr<const NewSurface> new_surface)
    : VisibleFeatures(std::move(prediction), parameters, std::move(new_surface), 1.0,
                      parameters.chance_weight) {}

VisibleFeatures::VisibleFeatures(std::shared_ptr<const VisibilityPrediction> prediction,
                                 const VisibleFeaturesParameters& p,
                                 std::shared_ptr<const NewSurface> new_surface,
                                 double criterion_weight, double chance_weight)
    : prediction_(std::move(prediction)),
      parameters_(p),
      new_surface_(std::move(new_surface)),
      criterion_weight_(criterion_weight),
      chance_weight_(chance_weight),
      l_required_(-std::log(p.required_translation) - std::log(p.required_rotation)),
      l_prior_(-std::log(p.prior_translation) - std::log(p.prior_rotation)) {
  constexpr const char* kOwner = "visible features";
  if (!prediction_) throw std::invalid_argument("visible features: no prediction given");
  check_knobs(kOwner, p);
  check_not_negative(kOwner, "chance_weight", p.chance_weight);
  check_not_negative(kOwner, "rho", p.rho);
  if (p.rho > 0.0 && !new_surface_) {
    throw std::invalid_argument(
        "visible features: rho is " + std::to_string(p.rho) +
        " points/m^2 without a source of newly seen surface; expected one, or rho 0");
  }
  if (p.rho == 0.0) new_surface_ = nullptr;
}

TermTraits VisibleFeatures::traits() const {
  return {TermKind::kCost, Smoothness::kC1, true, "-", "1 when nothing is seen at any stage", true};
}

std::unique_ptr<TermScratch> VisibleFeatures::make_scratch(const Horizon& horizon,
                                                           int max_batch) const {
  auto scratch = std::make_unique<Scratch>();
  scratch->prediction = prediction_->make_scratch(horizon);
  if (new_surface_) scratch->new_surface = new_surface_->make_scratch(horizon, max_batch);
  scratch->prior.assign(static_cast<std::size_t>(horizon.N + 1), 0.0);
  return scratch;
}

double VisibleFeatures::cost(int N, VisibilityPrediction::Stages& stages) const {
  const VisibleFeaturesParameters& p = parameters_;
  const bool information = p.criterion == VisibilityCriterion::kInformation;
  const double each = 1.0 / N;
  double total = 0.0;
  // x_0 is given: stage 0 has no cost of its own.
  stages.count_adjoint[0] = stages.variance_adjoint[0] = stages.log_det_adjoint[0] = 0.0;
  for (int k = 1; k <= N; ++k) {
    const std::size_t n = static_cast<std::size_t>(k);
    double d_count = 0.0, d_variance = 0.0, d_log_det = 0.0;
    if (criterion_weight_ > 0.0 && information) {
      const double scale = l_required_ - l_prior_;
      double slope;
      const double missing =
          softplus(l_required_ - stages.log_det[n] / 6.0, p.information_beta, slope) / scale;
      total += criterion_weight_ * missing * missing;
      d_log_det = -criterion_weight_ * 2.0 * missing * slope / (6.0 * scale);
    } else if (criterion_weight_ > 0.0) {
      double slope;
      total += criterion_weight_ * visible_features_cost(stages.count[n], p.N_req, p.beta, &slope);
      d_count += criterion_weight_ * slope;
    }
    if (chance_weight_ > 0.0) {
      double by_count, by_variance;
      total +=
          chance_weight_ * visible_features_chance(stages.count[n], stages.variance[n], p.N_min,
                                                   p.z, p.chance_beta, &by_count, &by_variance);
      d_count += chance_weight_ * by_count;
      d_variance += chance_weight_ * by_variance;
    }
    stages.count_adjoint[n] = each * d_count;
    stages.variance_adjoint[n] = each * d_variance;
    stages.log_det_adjoint[n] = each * d_log_det;
  }
  return each * total;
}

void VisibleFeatures::evaluate(const TrajectoryBatch& t, const TermRequest& request,
                               TermScratch* scratch, TermOutput& out) const {
  Scratch& own = static_cast<Scratch&>(*scratch);
  const int N = t.horizon.N;
  VisibilityPrediction::Request what;
  what.gradient = request.gradient;
  what.score = request.score;
  what.variance = chance_weight_ > 0.0;
  what.information =
      criterion_weight_ > 0.0 && parameters_.criterion == VisibilityCriterion::kInformation;
  what.prior_translation = 1.0 / (parameters_.prior_translation * parameters_.prior_translation);
  what.prior_rotation = 1.0 / (parameters_.prior_rotation * parameters_.prior_rotation);
  for (int b = 0; b < t.batch(); ++b) {
    if (new_surface_) {
      new_surface_->evaluate(t, b, own.new_surface.get(), own.prior.data());
      for (double& a : own.prior) a *= parameters_.rho;
    }
    if (!prediction_->propagate(t, b, what, new_surface_ ? own.prior.data() : nullptr,
                                *own.prediction)) {
      out.value(0, b) = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    VisibilityPrediction::Stages& stages = VisibilityPrediction::stages(*own.prediction);
    out.value(0, b) = cost(N, stages);
    if (!request.gradient) continue;
    prediction_->pull_back(t, b, *own.prediction, out);
    if (new_surface_) {
      for (double& a : stages.prior_adjoint) a *= parameters_.rho;
      new_surface_->add_gradient(t, b, own.new_surface.get(), stages.prior_adjoint.data(), out);
    }
  }
}

std::vector<double> VisibleFeatures::visible(const TrajectoryBatch& t, int b) const {
  std::vector<double> count = prediction_->visible(t, b);
  if (!new_surface_) return count;
  const std::unique_ptr<TermScratch> scratch = new_surface_->make_scratch(t.horizon, t.batch());
  std::vector<double> prior(count.size(), 0.0);
  new_surface_->evaluate(t, b, scratch.get(), prior.data());
  const auto own = prediction_->make_scratch(t.horizon);
  for (double& a : prior) a *= parameters_.rho;
  if (!prediction_->propagate(t, b, {}, prior.data(), *own)) return count;
  return VisibilityPrediction::stages(*own).count;
}

VisibleFeaturesChance::VisibleFeaturesChance(std::shared_ptr<const VisibilityPrediction> prediction,
                                             const VisibleFeaturesParameters& parameters,
                                             std::shared_ptr<const NewSurface> new_surface)
    : VisibleFeatures(std::move(prediction), parameters, std::move(new_surface), 0.0, 1.0) {}

void describe(Knobs& knobs, VisibleFeaturesParameters& p) {
  knobs.choice("criterion", p.criterion, {"count", "information"},
               "number of points, or what they tell about the pose");
  knobs.number("N_req", p.N_req, {1.0, 1e5}, "1", "features that suffice");
  knobs.number("beta", p.beta, {0.001, 1e3}, "1/point", "sharpness of the cost of too few");
  knobs.number("N_min", p.N_min, {1.0, 1e4}, "1",
               "features below which odometry is not to be trusted");
  knobs.number("z", p.z, {0.0, 10.0}, "1",
               "standard deviations by which the chance penalty wants more than N_min");
  knobs.number("chance_beta", p.chance_beta, {0.001, 1e3}, "1/point",
               "sharpness of the chance penalty");
  knobs.number("required_translation", p.required_translation, {1e-6, 1e3}, "m",
               "of criterion information: deviation of the position that suffices");
  knobs.number("required_rotation", p.required_rotation, {1e-6, 10.0}, "rad",
               "of criterion information: deviation of the rotation that suffices");
  knobs.number("prior_translation", p.prior_translation, {1e-6, 1e3}, "m",
               "of criterion information: deviation of the position without an image");
  knobs.number("prior_rotation", p.prior_rotation, {1e-6, 10.0}, "rad",
               "of criterion information: deviation of the rotation without an image");
  knobs.require(p.required_translation < p.prior_translation, "required_translation",
                "required_translation >= prior_translation; expected less");
  knobs.require(p.required_rotation < p.prior_rotation, "required_rotation",
                "required_rotation >= prior_rotation; expected less");
  knobs.number("information_beta", p.information_beta, {0.001, 1e3}, "1",
               "of criterion information: sharpness of its cost");
}

}  // namespace prospect
