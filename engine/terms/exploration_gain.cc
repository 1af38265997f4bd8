#include "engine/terms/exploration_gain.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/occlusion_table.h"

namespace prospect {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

std::shared_ptr<const OcclusionTable> checked(const ExplorationTargets& targets,
                                              std::shared_ptr<const OcclusionTable> table) {
  if (!table || table->points() != targets.positions()) {
    throw std::invalid_argument(
        "exploration gain: the occlusion table does not hold the targets' positions; expected a "
        "table made from them, in their order");
  }
  return table;
}

}  // namespace

struct ExplorationGain::Scratch : TermScratch {
  Scratch(int targets, int stages)
      : view(targets),
        p(targets, stages + 1),
        before(targets, stages + 2),
        later(targets),
        weight(targets),
        ones(stages + 1) {
    ones.setOnes();
  }
  FootprintVisibility::Scratch view;
  Eigen::ArrayXXd p;       // p_ck, a column per stage
  Eigen::ArrayXXd before;  // prod_{j<k} (1 - p_cj), a column per stage
  Eigen::ArrayXd later;
  Eigen::ArrayXd weight;
  Eigen::ArrayXd ones;
};

ExplorationGain::ExplorationGain(const ExplorationTargets& targets, const RgbdFootprint& footprint,
                                 const CameraMount& mount,
                                 std::shared_ptr<const OcclusionTable> table,
                                 const Options& options)
    : visibility_(footprint, mount, checked(targets, std::move(table)), options.visibility),
      mass_(static_cast<Eigen::Index>(targets.targets.size())),
      reference_area_(targets.reference_area),
      options_(options) {
  const auto fail = [](const char* what, double value, const char* expected) {
    throw std::invalid_argument("exploration gain: " + std::string(what) + " is " +
                                std::to_string(value) + "; expected " + expected);
  };
  if (!(options.eta > 0.0 && options.eta < 1.0)) fail("eta", options.eta, "a number in (0, 1)");
  if (!(options.tau > 0.0)) fail("tau", options.tau, "> 0 s");
  if (!(options.surface_per_area >= 0.0) || !std::isfinite(options.surface_per_area)) {
    fail("surface_per_area", options.surface_per_area, "a finite number >= 0");
  }
  if (!(reference_area_ > 0.0) || !std::isfinite(reference_area_)) {
    fail("reference_area", reference_area_, "> 0 m^2");
  }
  for (Eigen::Index c = 0; c < mass_.size(); ++c) {
    mass_[c] = targets.targets[static_cast<std::size_t>(c)].mass;
    if (!(mass_[c] >= 0.0) || !std::isfinite(mass_[c]))
      fail("a target's mass", mass_[c], ">= 0 m^2");
  }
}

TermTraits ExplorationGain::traits() const {
  return {TermKind::kCost, Smoothness::kC1, true, "-", "expected newly explored area over A_ref"};
}

std::unique_ptr<TermScratch> ExplorationGain::make_scratch(const Horizon& horizon, int) const {
  return std::make_unique<Scratch>(num_targets(), horizon.N);
}

void ExplorationGain::look(const TrajectoryBatch& t, int b, double tau, Scratch& s) const {
  s.before.col(0).setOnes();
  s.before.col(1).setOnes();
  s.p.col(0).setZero();
  for (int k = 1; k <= t.horizon.N; ++k) {
    visibility_.evaluate(t.pose(k, b), s.view, s.p.col(k).data());
    s.p.col(k) *= options_.eta * std::exp(-k * t.horizon.dt / tau);
    s.before.col(k + 1) = s.before.col(k) * (1.0 - s.p.col(k));
  }
}

void ExplorationGain::add_adjoint(const TrajectoryBatch& t, int b, double tau,
                                  const double* adjoint, double scale, Scratch& s,
                                  TermOutput& out) const {
  // With T_k = sum_{i>k} adjoint_i p_i prod_{k<j<i} (1 - p_j):
  //   d/dp_k = m before_k (adjoint_k - T_k),   T_{k-1} = adjoint_k p_k + (1 - p_k) T_k.
  s.later.setZero();
  for (int k = t.horizon.N; k >= 1; --k) {
    const double discount = options_.eta * std::exp(-k * t.horizon.dt / tau);
    s.weight = (scale * discount) * mass_ * s.before.col(k) * (adjoint[k] - s.later);
    s.later = adjoint[k] * s.p.col(k) + (1.0 - s.p.col(k)) * s.later;
    const Eigen::Vector4d g = visibility_.gradient(t.pose(k, b), s.weight.data(), s.view);
    out.add_pose_gradient(t, k, b, g[0], g[1], g[2], g[3]);
  }
}

void ExplorationGain::evaluate(const TrajectoryBatch& t, const TermRequest& request,
                               TermScratch* scratch, TermOutput& out) const {
  auto& s = static_cast<Scratch&>(*scratch);
  const int last = t.horizon.N + 1;
  for (int b = 0; b < t.batch(); ++b) {
    look(t, b, options_.tau, s);
    out.value(0, b) = (mass_ * (1.0 - s.before.col(last))).sum() / reference_area_;
    if (request.gradient) {
      add_adjoint(t, b, options_.tau, s.ones.data(), 1.0 / reference_area_, s, out);
    }
  }
}

void ExplorationGain::evaluate(const TrajectoryBatch& t, int b, TermScratch* scratch,
                               double* area) const {
  auto& s = static_cast<Scratch&>(*scratch);
  look(t, b, kForever, s);
  area[0] = 0.0;
  for (int k = 1; k <= t.horizon.N; ++k) {
    area[k] = options_.surface_per_area * (mass_ * s.p.col(k) * s.before.col(k)).sum();
  }
}

void ExplorationGain::add_gradient(const TrajectoryBatch& t, int b, TermScratch* scratch,
                                   const double* adjoint, TermOutput& out) const {
  add_adjoint(t, b, kForever, adjoint, options_.surface_per_area, static_cast<Scratch&>(*scratch),
              out);
}

}  // namespace prospect
