// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/exploration_gain.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/features/occlusion_table.h"
#include "engine/problem/shared_results.h"

namespace prospect {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

std::vector<FootprintVisibility> visibilities(const ExplorationTargets& targets,
                                              std::vector<ExplorationGain::Sight> sights,
                                              const FootprintVisibility::Options& options) {
  if (sights.empty()) {
    throw std::invalid_argument("exploration gain: no depth sensor; expected at least one");
  }
  std::vector<FootprintVisibility> all;
  const double height = sights.front().sensor.mount.T_BC.translation().z();
  for (ExplorationGain::Sight& sight : sights) {
    const double raised = sight.sensor.mount.T_BC.translation().z() - height;
    if (!sight.table || sight.table->points() != targets.positions(raised)) {
      throw std::invalid_argument(
          "exploration gain: the occlusion table does not hold the targets' positions; expected a "
          "table made from them, in their order");
    }
    all.emplace_back(sight.sensor.footprint, sight.sensor.mount, std::move(sight.table), options);
  }
  return all;
}

}  // namespace

// The views of all candidates and stages that can have q > 0, one stage after the other.
struct ExplorationGain::Views : TermScratch {
  Views(int capacity, int stages, int max_batch) {
    count.setZero(stages + 1, max_batch);
    start.setZero(stages + 1, max_batch);
    stamp.setZero(max_batch);
    // Room for the worst case; memory that is never written costs nothing.
    const Eigen::Index all = Eigen::Index{capacity} * stages * max_batch;
    point.resize(all);
    q.resize(all);
  }

  // Drops all views.
  void begin(std::uint64_t new_stamp, bool with_gradient) {
    newest = new_stamp;
    gradient = with_gradient;
    used = 0;
    stamp.setZero();
    if (!gradient || d_x.size() == q.size()) return;
    for (Eigen::ArrayXd* d : {&d_x, &d_y, &d_z, &d_yaw}) d->resize(q.size());
  }

  std::uint64_t newest = 0;  // the evaluation that the views belong to
  bool gradient = false;     // whether they have derivatives
  Eigen::Index used = 0;
  Eigen::Array<std::uint64_t, Eigen::Dynamic, 1> stamp;              // by candidate; `newest`: done
  Eigen::ArrayXXi count;                                             // by stage and candidate
  Eigen::Array<Eigen::Index, Eigen::Dynamic, Eigen::Dynamic> start;  // in the arrays below
  Eigen::ArrayXi point;
  Eigen::ArrayXd q, d_x, d_y, d_z, d_yaw;
};

struct ExplorationGain::Scratch : TermScratch {
  Scratch(int targets, int capacity, int stages, int batch, bool several)
      : max_batch(batch),
        view(targets),
        united(several ? targets : 0, 5),
        unseen(targets),
        later(targets),
        before(Eigen::Index{capacity} * stages),
        factor(stages + 1),
        area(stages + 1),
        ones(stages + 1) {
    ones.setOnes();
  }
  int max_batch;
  FootprintVisibility::Scratch view;
  Eigen::ArrayXXd united;      // of several sensors: v and its derivatives by x, y, z, yaw, of all
  std::unique_ptr<Views> own;  // outside of a Problem; one candidate
  Eigen::ArrayXd unseen;       // prod_{j<k} (1 - p_cj) of the stage in work
  Eigen::ArrayXd later;
  Eigen::ArrayXd before;  // the same of every view
  Eigen::ArrayXd factor;  // p_ck / q_ck, by stage
  Eigen::ArrayXd area, ones;
};

ExplorationGain::ExplorationGain(const ExplorationTargets& targets, const RgbdFootprint& footprint,
                                 const CameraMount& mount,
                                 std::shared_ptr<const OcclusionTable> table,
                                 const Options& options, const std::optional<Pose>& present)
    : ExplorationGain(targets, {Sight{{footprint, mount}, std::move(table)}}, options, present) {}

ExplorationGain::ExplorationGain(const ExplorationTargets& targets, std::vector<Sight> sights,
                                 const Options& options, const std::optional<Pose>& present)
    : visibility_(visibilities(targets, std::move(sights), options.visibility)),
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
  seen_.setZero(mass_.size());
  if (present) {
    FootprintVisibility::Scratch scratch(num_targets());
    Eigen::ArrayXd one(seen_.size());
    for (const FootprintVisibility& sensor : visibility_) {
      sensor.evaluate(*present, scratch, one.data());
      seen_ += one * (1.0 - seen_);
    }
    if (!seen_.allFinite()) {
      throw std::invalid_argument("exploration gain: the present pose is not finite");
    }
  }
}

TermTraits ExplorationGain::traits() const {
  return {
      TermKind::kCost, Smoothness::kC1, true, "-", "expected newly explored area over A_ref", true};
}

std::optional<ResidualForm> ExplorationGain::residual_form(const Horizon& horizon, int sign) const {
  if (sign > 0) return std::nullopt;
  ResidualForm form;
  form.offset = -mass_.sum() / reference_area_;
  form.rows = num_targets();
  for (int k = 1; k <= horizon.N; ++k) {
    for (int c = 0; c < form.rows; ++c) form.pattern.push_back({c, k, false});
  }
  return form;
}

std::unique_ptr<TermScratch> ExplorationGain::make_scratch(const Horizon& horizon,
                                                           int max_batch) const {
  return std::make_unique<Scratch>(num_targets(), visibility_.front().capacity(), horizon.N,
                                   max_batch, visibility_.size() > 1);
}

ExplorationGain::Candidate ExplorationGain::view(const TrajectoryBatch& t, int b, bool gradient,
                                                 Scratch& s) const {
  const int N = t.horizon.N;
  const int capacity = visibility_.front().capacity();
  SharedResults* const shared = t.shared.get();
  Views* views = nullptr;
  int place = 0;
  bool score = false;
  if (shared) {
    views = &shared->get<Views>(this,
                                [&] { return std::make_unique<Views>(capacity, N, s.max_batch); });
    if (views->stamp.size() < t.batch()) *views = Views(capacity, N, t.batch());
    place = b;
    // Whoever comes first computes what others will ask for.
    gradient = gradient || shared->request().gradient;
    score = shared->request().score;
    if (views->newest != shared->stamp() || views->gradient != gradient) {
      views->begin(shared->stamp(), gradient);
    }
    if (views->stamp[place] == views->newest) return {*views, place};
  } else {
    if (!s.own) s.own = std::make_unique<Views>(capacity, N, 1);
    views = s.own.get();
    views->begin(1, gradient);
  }
  Views& l = *views;
  for (int k = 1; k <= N; ++k) {
    FootprintVisibility::Views at;
    at.point = l.point.data() + l.used;
    at.q = l.q.data() + l.used;
    at.score = score;
    if (gradient) {
      at.d_x = l.d_x.data() + l.used;
      at.d_y = l.d_y.data() + l.used;
      at.d_z = l.d_z.data() + l.used;
      at.d_yaw = l.d_yaw.data() + l.used;
    }
    l.count(k, place) = look(t.pose(k, b), s, at);
    discount(at, l.count(k, place));
    l.start(k, place) = l.used;
    l.used += FootprintKernel::padded(std::max(l.count(k, place), 0));
  }
  l.stamp[place] = l.newest;
  return {l, place};
}

int ExplorationGain::look(const Pose& pose, Scratch& s,
                          const FootprintVisibility::Views& views) const {
  if (visibility_.size() == 1) return visibility_.front().view(pose, s.view, views);
  const bool gradient = views.d_x != nullptr;
  FootprintVisibility::Views one{.point = s.view.point.data(), .q = s.view.q.data()};
  one.score = views.score;
  if (gradient) {
    one.d_x = s.view.q_x.data();
    one.d_y = s.view.q_y.data();
    one.d_z = s.view.q_z.data();
    one.d_yaw = s.view.q_yaw.data();
  }
  s.united.setZero();
  for (const FootprintVisibility& sensor : visibility_) {
    const int n = sensor.view(pose, s.view, one);
    if (n < 0) return n;
    for (int j = 0; j < n; ++j) {
      auto v = s.united.row(one.point[j]);
      const double q = one.q[j], before = v[0];
      v[0] = before + q * (1.0 - before);
      if (!gradient) continue;
      const double slopes[] = {one.d_x[j], one.d_y[j], one.d_z[j], one.d_yaw[j]};
      for (int a = 0; a < 4; ++a) v[a + 1] = v[a + 1] * (1.0 - q) + slopes[a] * (1.0 - before);
    }
  }
  int n = 0;
  for (int c = 0; c < num_targets(); ++c) {
    if (s.united(c, 0) == 0.0) continue;
    views.point[n] = c;
    views.q[n] = s.united(c, 0);
    if (gradient) {
      views.d_x[n] = s.united(c, 1);
      views.d_y[n] = s.united(c, 2);
      views.d_z[n] = s.united(c, 3);
      views.d_yaw[n] = s.united(c, 4);
    }
    ++n;
  }
  return n;
}

void ExplorationGain::discount(const FootprintVisibility::Views& at, int n) const {
  for (int j = 0; j < n; ++j) {
    const double seen = seen_[at.point[j]];
    if (seen == 0.0) continue;
    const double v = at.q[j];
    double q = 0.0, slope = 0.0;
    if (v > seen) {
      const double ratio = seen / v;
      q = (v - seen) * (1.0 - ratio) / (1.0 - seen);
      slope = (1.0 - ratio * ratio) / (1.0 - seen);
    }
    at.q[j] = q;
    if (!at.d_x) continue;
    at.d_x[j] *= slope;
    at.d_y[j] *= slope;
    at.d_z[j] *= slope;
    at.d_yaw[j] *= slope;
  }
}

bool ExplorationGain::accumulate(const TrajectoryBatch& t, Candidate candidate, double tau,
                                 Scratch& s) const {
  const auto& [l, place] = candidate;
  s.unseen.setOnes();
  s.area[0] = 0.0;
  const Eigen::Index first = l.start(1, place);
  for (int k = 1; k <= t.horizon.N; ++k) {
    const int n = l.count(k, place);
    if (n < 0) return false;
    const Eigen::Index start = l.start(k, place);
    const int* const point = l.point.data() + start;
    const double* const q = l.q.data() + start;
    double* const before = s.before.data() + (start - first);
    const double factor = s.factor[k] = options_.eta * std::exp(-k * t.horizon.dt / tau);
    double area = 0.0;
    for (int j = 0; j < n; ++j) {
      double& unseen = s.unseen[point[j]];
      const double now = factor * q[j] * unseen;
      before[j] = unseen;
      area += mass_[point[j]] * now;
      unseen -= now;
    }
    s.area[k] = area;
  }
  return true;
}

void ExplorationGain::add_adjoint(const TrajectoryBatch& t, int b, Candidate candidate,
                                  const double* adjoint, double scale, Scratch& s,
                                  TermOutput& out) const {
  // With T_k = sum_{i>k} adjoint_i p_i prod_{k<j<i} (1 - p_j):
  //   d/dp_k = m before_k (adjoint_k - T_k),   T_{k-1} = adjoint_k p_k + (1 - p_k) T_k.
  // Where p_k = 0, T does not change.
  const auto& [l, place] = candidate;
  s.later.setZero();
  const Eigen::Index first = l.start(1, place);
  for (int k = t.horizon.N; k >= 1; --k) {
    const Eigen::Index start = l.start(k, place);
    double gx = 0.0, gy = 0.0, gz = 0.0, gyaw = 0.0;
    for (Eigen::Index i = start; i < start + l.count(k, place); ++i) {
      const int c = l.point[i];
      const double excess = adjoint[k] - s.later[c];
      const double weight = mass_[c] * s.before[i - first] * excess;
      gx += weight * l.d_x[i];
      gy += weight * l.d_y[i];
      gz += weight * l.d_z[i];
      gyaw += weight * l.d_yaw[i];
      s.later[c] += s.factor[k] * l.q[i] * excess;
    }
    const double each = scale * s.factor[k];
    out.add_pose_gradient(t, k, b, each * gx, each * gy, each * gz, each * gyaw);
  }
}

void ExplorationGain::write_residuals(const TrajectoryBatch& t, Candidate candidate,
                                      const Scratch& s, TermOutput& out) const {
  const auto& [l, place] = candidate;
  out.residuals = (2.0 / reference_area_ * mass_ * s.unseen).sqrt();
  out.jacobian.setZero();
  for (int k = 1; k <= t.horizon.N; ++k) {
    const Eigen::Index start = l.start(k, place);
    for (Eigen::Index i = start; i < start + l.count(k, place); ++i) {
      const int c = l.point[i];
      const double slope = -0.5 * out.residuals[c] * s.factor[k] / (1.0 - s.factor[k] * l.q[i]);
      out.set_pose_block(t, (k - 1) * num_targets() + c, slope * l.d_x[i], slope * l.d_y[i],
                         slope * l.d_z[i], slope * l.d_yaw[i]);
    }
  }
}

void ExplorationGain::evaluate(const TrajectoryBatch& t, const TermRequest& request,
                               TermScratch* scratch, TermOutput& out) const {
  auto& s = static_cast<Scratch&>(*scratch);
  for (int b = 0; b < t.batch(); ++b) {
    const Candidate candidate = view(t, b, request.gradient || request.residuals != 0, s);
    if (!accumulate(t, candidate, options_.tau, s)) {
      out.value(0, b) = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    // sum_k p_k prod_{j<k} (1 - p_j) = 1 - prod_k (1 - p_k).
    out.value(0, b) = s.area.sum() / reference_area_;
    if (request.gradient) {
      add_adjoint(t, b, candidate, s.ones.data(), 1.0 / reference_area_, s, out);
    }
    if (request.residuals != 0) write_residuals(t, candidate, s, out);
  }
}

void ExplorationGain::evaluate(const TrajectoryBatch& t, int b, TermScratch* scratch,
                               double* area) const {
  auto& s = static_cast<Scratch&>(*scratch);
  const bool finite = accumulate(t, view(t, b, false, s), kForever, s);
  for (int k = 0; k <= t.horizon.N; ++k) {
    area[k] =
        finite ? options_.surface_per_area * s.area[k] : std::numeric_limits<double>::quiet_NaN();
  }
}

void ExplorationGain::add_gradient(const TrajectoryBatch& t, int b, TermScratch* scratch,
                                   const double* adjoint, TermOutput& out) const {
  auto& s = static_cast<Scratch&>(*scratch);
  add_adjoint(t, b, view(t, b, true, s), adjoint, options_.surface_per_area, s, out);
}

}  // namespace prospect
