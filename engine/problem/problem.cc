// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/problem.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "engine/problem/shared_results.h"

namespace prospect {
namespace {

int rougher(Smoothness a, Smoothness b) {
  return std::max(static_cast<int>(a), static_cast<int>(b));
}

[[noreturn]] void refuse(const std::string& what, const std::string& expected) {
  throw std::invalid_argument("problem: " + what + "; expected " + expected);
}

bool in_range(const std::vector<JacobianBlock>& pattern, int rows, int N) {
  return std::all_of(pattern.begin(), pattern.end(), [&](const JacobianBlock& block) {
    const int last = block.input ? N - 1 : N;
    return block.row >= 0 && block.row < rows && block.stage >= 0 && block.stage <= last;
  });
}

/// What is not finite is rejected: so are cost and constraints, and the derivatives are zero.
/// Whether nothing was.
bool reject_invalid(int B, Evaluate what, Evaluation& out) {
  const bool gradient = what >= Evaluate::kGradient;
  const bool stages = what == Evaluate::kStages;
  const bool residuals = what == Evaluate::kResiduals;
  bool all_valid = true;
  for (int b = 0; b < B; ++b) {
    bool ok = std::isfinite(out.cost[b]) && out.constraints.col(b).allFinite();
    if (gradient) ok = ok && out.gradient.allFinite() && out.jacobian.allFinite();
    if (stages) ok = ok && out.stages.state_gradient.allFinite();
    if (residuals) ok = ok && out.residuals.allFinite() && out.residual_jacobian.allFinite();
    if (ok) continue;
    all_valid = false;
    out.valid[b] = false;
    out.cost[b] = Problem::kRejectedCost;
    out.cost_error[b] = 0.0;
    for (Eigen::Index r = 0; r < out.constraints.rows(); ++r) {
      if (!std::isfinite(out.constraints(r, b))) out.constraints(r, b) = -Problem::kRejectedCost;
    }
    if (gradient) {
      out.gradient.setZero();
      out.jacobian.setZero();
    }
    if (stages) {
      out.stages.state_gradient.setZero();
      out.stages.constraint_drift.setZero();
      out.stages.input_hessian.setZero();
    }
    if (residuals) {
      out.residuals.setZero();
      out.residual_jacobian.setZero();
    }
  }
  return all_valid;
}

}  // namespace

double violation(const Eigen::Ref<const Eigen::VectorXd>& constraints) {
  return constraints.size() == 0 ? 0.0 : std::max(0.0, -constraints.minCoeff());
}

struct Workspace::Impl {
  // What has the size of the batch, kept for every size met.
  struct Batch {
    TrajectoryBatch trajectories;
    std::vector<TermOutput> outputs;  // by term
  };
  Batch& batch(Eigen::Index B) {
    for (const auto& batch : batches) {
      if (batch->trajectories.states.cols() == B) return *batch;
    }
    batches.push_back(std::make_unique<Batch>(prototype));
    batches.back()->trajectories.states.resize(prototype.trajectories.states.rows(), B);
    batches.back()->trajectories.inputs.resize(prototype.trajectories.inputs.rows(), B);
    return *batches.back();
  }

  Batch prototype;
  std::vector<std::unique_ptr<Batch>> batches;
  SharedResults shared;
  std::vector<std::unique_ptr<TermScratch>> scratch;  // by term
  int scratch_batch = 0;
  std::vector<Eigen::MatrixXd> A, B;         // by stage
  std::vector<Eigen::MatrixXd> sensitivity;  // S_k, by node
  // The residuals of one term; made at the first evaluation that asks for residuals.
  struct Residuals {
    int sign = 0;  // 0: none
    int first_row = 0, rows = 0;
    bool whole = false;  // one residual for the whole term
    double offset = 0.0, root_weight = 0.0;
    std::vector<JacobianBlock> pattern;
  };
  std::vector<Residuals> residuals;  // by term
  int num_residuals = 0;
  double residual_offset = 0.0;  // of all
  // A cost that is a sum of squares of what depends on inputs alone: the nonzero blocks of its
  // residuals, and which two of them are of one row. Empty for others; made at the first evaluation
  // that asks for stages.
  struct InputResiduals {
    std::vector<JacobianBlock> blocks;
    std::vector<std::pair<int, int>> pairs;
  };
  std::vector<InputResiduals> input_residuals;  // by term
  Eigen::VectorXd row;
  Eigen::VectorXd lambda, lambda_next;
  BatchArray state_gradient, input_gradient;  // weighted sums
};

Workspace::Workspace() : impl_(std::make_unique<Impl>()) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

Problem::Problem(ProblemDefinition definition) : definition_(std::move(definition)) {
  const ProblemDefinition& d = definition_;
  if (!d.model) refuse("no motion model", "a model");
  const int nx = d.model->nx();
  const int nu = d.model->nu();
  if (d.N < 1 || d.N > 10000) refuse("N = " + std::to_string(d.N), "1 to 10000 stages");
  if (d.M < 1 || d.M > d.N) {
    refuse("M = " + std::to_string(d.M), "1 to N = " + std::to_string(d.N) + " knots");
  }
  if (!(d.dt > 0.0) || !std::isfinite(d.dt)) {
    refuse("dt = " + std::to_string(d.dt), "a finite step > 0 s");
  }
  if (d.x0.size() != nx || !d.x0.allFinite()) refuse("x0", std::to_string(nx) + " finite entries");
  if (d.u_previous.size() != nu || !d.u_previous.allFinite()) {
    refuse("u_previous", std::to_string(nu) + " finite entries");
  }
  const InputLimits& limits = d.model->limits();
  if (limits.lower.size() != nu || limits.upper.size() != nu || limits.rate.size() != nu ||
      !limits.lower.allFinite() || !limits.upper.allFinite() ||
      (limits.lower.array() > limits.upper.array()).any()) {
    refuse("the model's input limits", "finite lower <= upper of nu entries each");
  }
  horizon_ = {d.model.get(), d.N, d.dt};
  lower_ = limits.lower.replicate(d.M, 1);
  upper_ = limits.upper.replicate(d.M, 1);

  for (const auto& [term, weight] : d.terms) {
    if (!term) refuse("a term is null", "a term");
    const TermTraits traits = term->traits();
    const std::string name(term->name());
    smoothness_ = static_cast<Smoothness>(rougher(smoothness_, traits.smoothness));
    has_gradient_ = has_gradient_ && traits.has_gradient;
    has_scores_ = has_scores_ || traits.scores;
    const bool is_constraint = traits.kind == TermKind::kConstraint;
    TermLayout layout{is_constraint, traits.scores && !is_constraint, 1, {}};
    if (layout.constraint) {
      layout.blocks = term->jacobian_pattern(horizon_);
      const int rows = layout.rows = term->rows(horizon_);
      if (!in_range(layout.blocks, rows, d.N)) {
        refuse("the Jacobian pattern of term '" + name + "'", "rows and stages in range");
      }
      num_constraints_ += rows;
    } else if (!std::isfinite(weight)) {
      refuse("the weight of term '" + name + "' is not finite", "a finite weight");
    }
    layouts_.push_back(std::move(layout));
  }

  pattern_.setConstant(num_constraints_, num_variables(), false);
  int first_row = 0;
  for (std::size_t t = 0; t < d.terms.size(); ++t) {
    for (const JacobianBlock& block : layouts_[t].blocks) {
      // x_k depends on the inputs of stages before k; u_k on its own knot.
      const int from = block.input ? knot(block.stage) * nu : 0;
      const int to =
          block.input ? from + nu : (block.stage == 0 ? 0 : (knot(block.stage - 1) + 1) * nu);
      pattern_.row(first_row + block.row).segment(from, to - from).setConstant(true);
    }
    if (layouts_[t].constraint) first_row += layouts_[t].rows;
  }
}

Workspace Problem::make_workspace() const {
  Workspace workspace;
  Workspace::Impl& w = *workspace.impl_;
  const int nx = horizon_.nx();
  const int nu = horizon_.nu();
  TrajectoryBatch& trajectories = w.prototype.trajectories;
  trajectories.horizon = horizon_;
  trajectories.layout = definition_.model->pose_layout();
  trajectories.u_previous = definition_.u_previous;
  trajectories.states.resize((definition_.N + 1) * nx, 0);
  trajectories.inputs.resize(definition_.N * nu, 0);
  w.scratch.resize(definition_.terms.size());
  w.prototype.outputs.resize(definition_.terms.size());
  for (std::size_t t = 0; t < definition_.terms.size(); ++t) {
    TermOutput& out = w.prototype.outputs[t];
    if (!layouts_[t].constraint) {
      out.state_gradient.resize((definition_.N + 1) * nx, 1);
      out.input_gradient.resize(definition_.N * nu, 1);
    } else {
      out.jacobian.resize(std::max(nx, nu), static_cast<Eigen::Index>(layouts_[t].blocks.size()));
    }
  }
  w.A.assign(static_cast<std::size_t>(definition_.N), Eigen::MatrixXd(nx, nx));
  w.B.assign(static_cast<std::size_t>(definition_.N), Eigen::MatrixXd(nx, nu));
  w.lambda.resize(nx);
  w.lambda_next.resize(nx);
  w.state_gradient.resize((definition_.N + 1) * nx, 1);
  w.input_gradient.resize(definition_.N * nu, 1);
  return workspace;
}

void Problem::set_inputs(const Eigen::Ref<const Eigen::MatrixXd>& X, TrajectoryBatch& t) const {
  const int nu = horizon_.nu();
  t.inputs.resize(definition_.N * nu, X.cols());
  for (int k = 0; k < definition_.N; ++k) {
    t.inputs.middleRows(k * nu, nu) = X.middleRows(knot(k) * nu, nu).array();
  }
}

void Problem::roll(const Eigen::Ref<const Eigen::MatrixXd>& X, TrajectoryBatch& t) const {
  const int nx = horizon_.nx();
  const int nu = horizon_.nu();
  const Eigen::Index B = X.cols();
  t.states.resize((definition_.N + 1) * nx, B);
  set_inputs(X, t);
  for (int i = 0; i < nx; ++i) t.states.row(i).setConstant(definition_.x0[i]);
  for (int k = 0; k < definition_.N; ++k) {
    definition_.model->step_batch(t.states.middleRows(k * nx, nx), t.inputs.middleRows(k * nu, nu),
                                  definition_.dt, t.states.middleRows((k + 1) * nx, nx));
  }
}

void Problem::linearise(const TrajectoryBatch& t, bool sensitivities, Workspace& workspace) const {
  Workspace::Impl& w = *workspace.impl_;
  const int nx = horizon_.nx();
  const int nu = horizon_.nu();
  for (int k = 0; k < definition_.N; ++k) {
    const Eigen::Map<const Eigen::VectorXd> x(t.states.data() + k * nx, nx);
    const Eigen::Map<const Eigen::VectorXd> u(t.inputs.data() + k * nu, nu);
    definition_.model->jacobians(x, u, definition_.dt, w.A[static_cast<std::size_t>(k)],
                                 w.B[static_cast<std::size_t>(k)]);
  }
  if (!sensitivities) return;
  if (w.sensitivity.empty()) {
    w.sensitivity.assign(static_cast<std::size_t>(definition_.N) + 1,
                         Eigen::MatrixXd::Zero(nx, num_variables()));
  }
  w.sensitivity[0].setZero();
  for (int k = 0; k < definition_.N; ++k) {
    const auto s = static_cast<std::size_t>(k);
    // Inputs of later knots do not move x_k: only the leading columns are worked on.
    const int columns = (knot(k) + 1) * nu;
    w.sensitivity[s + 1].setZero();
    w.sensitivity[s + 1].leftCols(columns).noalias() = w.A[s] * w.sensitivity[s].leftCols(columns);
    w.sensitivity[s + 1].middleCols(knot(k) * nu, nu) += w.B[s];
  }
}

void Problem::begin_stages(const TrajectoryBatch& t, Workspace& workspace,
                           StageDerivatives& stages) const {
  const Workspace::Impl& w = *workspace.impl_;
  const int nx = horizon_.nx();
  const int nu = horizon_.nu();
  const int N = definition_.N;
  stages.states = Eigen::MatrixXd::Map(t.states.data(), nx, N + 1);
  stages.state_gradient.setZero(nx, N + 1);
  stages.sensitivity = w.sensitivity;
  stages.drift.setZero(nx, N + 1);
  stages.gap = 0.0;
  for (int k = 0; k < N; ++k) {
    // A gap is kept in the next column until the drift takes its place.
    auto next = stages.drift.col(k + 1);
    definition_.model->step(stages.states.col(k),
                            Eigen::VectorXd::Map(t.inputs.data() + k * nu, nu), definition_.dt,
                            next);
    next -= stages.states.col(k + 1);
    stages.gap = std::max(stages.gap, next.lpNorm<Eigen::Infinity>());
    next.noalias() += w.A[static_cast<std::size_t>(k)] * stages.drift.col(k);
  }
  stages.constraint_drift.setZero(num_constraints_);
  stages.input_hessian.setZero(num_variables(), num_variables());
}

void Problem::prepare_stages(Workspace& workspace) const {
  Workspace::Impl& w = *workspace.impl_;
  std::vector<Workspace::Impl::InputResiduals> all(definition_.terms.size());
  TermOutput* const outputs = w.batch(1).outputs.data();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& [term, weight] = definition_.terms[i];
    if (layouts_[i].constraint || weight == 0.0) continue;
    const auto form = term->residual_form(horizon_, weight > 0.0 ? 1 : -1);
    if (!form || form->rows == 0) continue;
    const auto of_input = [](const JacobianBlock& block) { return block.input; };
    if (!in_range(form->pattern, form->rows, definition_.N) ||
        !std::all_of(form->pattern.begin(), form->pattern.end(), of_input)) {
      continue;
    }
    std::vector<std::vector<int>> by_row(static_cast<std::size_t>(form->rows));
    for (std::size_t b = 0; b < form->pattern.size(); ++b) {
      by_row[static_cast<std::size_t>(form->pattern[b].row)].push_back(static_cast<int>(b));
    }
    for (const std::vector<int>& row : by_row) {
      for (const int a : row) {
        for (const int b : row) all[i].pairs.emplace_back(a, b);
      }
    }
    all[i].blocks = form->pattern;
    outputs[i].residuals.resize(form->rows);
    outputs[i].jacobian.resize(std::max(horizon_.nx(), horizon_.nu()),
                               static_cast<Eigen::Index>(form->pattern.size()));
  }
  w.input_residuals = std::move(all);
}

void Problem::evaluate_input_term(std::size_t term_index, const TrajectoryBatch& t, TermOutput& o,
                                  Workspace& workspace, Eigen::MatrixXd& hessian) const {
  Workspace::Impl& w = *workspace.impl_;
  const int nu = horizon_.nu();
  const auto& [blocks, pairs] = w.input_residuals[term_index];
  const auto& [term, weight] = definition_.terms[term_index];
  term->evaluate(t, {.residuals = weight > 0.0 ? 1 : -1}, w.scratch[term_index].get(), o);
  const double scale = std::abs(weight);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const JacobianBlock& block = blocks[b];
    w.input_gradient.col(0).matrix().segment(block.stage * nu, nu) +=
        (scale * o.residuals[block.row]) * o.jacobian.col(static_cast<Eigen::Index>(b)).head(nu);
  }
  for (const auto& [a, b] : pairs) {
    const int row = knot(blocks[static_cast<std::size_t>(a)].stage) * nu;
    const int column = knot(blocks[static_cast<std::size_t>(b)].stage) * nu;
    hessian.block(row, column, nu, nu).noalias() +=
        (scale * o.jacobian.col(a).head(nu)) * o.jacobian.col(b).head(nu).transpose();
  }
}

void Problem::chain(const JacobianBlock& block, const Eigen::Ref<const Eigen::VectorXd>& derivative,
                    const Workspace& workspace, RowRef row) const {
  const int nu = horizon_.nu();
  if (block.input) {
    row.segment(knot(block.stage) * nu, nu) += derivative.head(nu).transpose();
  } else {
    // x_k depends on the knots of the stages before k alone.
    const int columns = block.stage == 0 ? 0 : (knot(block.stage - 1) + 1) * nu;
    row.head(columns).noalias() +=
        derivative.head(horizon_.nx()).transpose() *
        workspace.impl_->sensitivity[static_cast<std::size_t>(block.stage)].leftCols(columns);
  }
}

void Problem::pull_back(const GradientRef& state_gradient, const GradientRef& input_gradient,
                        Workspace& workspace, Eigen::Ref<Eigen::VectorXd> gradient) const {
  Workspace::Impl& w = *workspace.impl_;
  const int nx = horizon_.nx();
  const int nu = horizon_.nu();
  w.lambda = state_gradient.tail(nx);
  for (int k = definition_.N - 1; k >= 0; --k) {
    const auto s = static_cast<std::size_t>(k);
    auto g = gradient.segment(knot(k) * nu, nu);
    g += input_gradient.segment(k * nu, nu);
    g.noalias() += w.B[s].transpose() * w.lambda;
    w.lambda_next = state_gradient.segment(k * nx, nx);
    w.lambda_next.noalias() += w.A[s].transpose() * w.lambda;
    w.lambda.swap(w.lambda_next);
  }
}

std::string Problem::terms_without_residuals() const {
  std::string names;
  for (std::size_t i = 0; i < definition_.terms.size(); ++i) {
    const auto& [term, weight] = definition_.terms[i];
    if (layouts_[i].constraint || weight == 0.0) continue;
    if (term->residual_form(horizon_, weight > 0.0 ? 1 : -1)) continue;
    names += (names.empty() ? "'" : ", '") + std::string(term->name()) + "'";
  }
  return names;
}

void Problem::prepare_residuals(Workspace& workspace) const {
  const std::string without = terms_without_residuals();
  if (!without.empty()) {
    refuse("residuals are asked for, which " + without + " do not have",
           "costs that are sums of squares");
  }
  Workspace::Impl& w = *workspace.impl_;
  std::vector<Workspace::Impl::Residuals> all(definition_.terms.size());
  TermOutput* const outputs = w.batch(1).outputs.data();
  w.num_residuals = 0;
  w.residual_offset = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& [term, weight] = definition_.terms[i];
    if (layouts_[i].constraint || weight == 0.0) continue;
    Workspace::Impl::Residuals& r = all[i];
    r.sign = weight > 0.0 ? 1 : -1;
    ResidualForm form = *term->residual_form(horizon_, r.sign);
    if (!in_range(form.pattern, form.rows, definition_.N)) {
      refuse("the residual pattern of term '" + std::string(term->name()) + "'",
             "rows and stages in range");
    }
    r.whole = form.rows == 0;
    r.first_row = w.num_residuals;
    r.rows = r.whole ? 1 : form.rows;
    r.offset = form.offset;
    r.root_weight = std::sqrt(std::abs(weight));
    r.pattern = std::move(form.pattern);
    outputs[i].residuals.resize(r.rows);
    if (!r.whole) {
      outputs[i].jacobian.resize(std::max(horizon_.nx(), horizon_.nu()),
                                 static_cast<Eigen::Index>(r.pattern.size()));
    }
    w.num_residuals += r.rows;
    w.residual_offset += std::abs(weight) * r.offset;
  }
  w.row.resize(num_variables());
  w.residuals = std::move(all);
}

void Problem::evaluate_residuals(std::size_t term_index, const TrajectoryBatch& t, TermOutput& o,
                                 Workspace& workspace, Evaluation& out) const {
  Workspace::Impl& w = *workspace.impl_;
  const Term& term = *definition_.terms[term_index].term;
  TermScratch* const scratch = w.scratch[term_index].get();
  const Workspace::Impl::Residuals& r = w.residuals[term_index];
  if (r.sign == 0) return term.evaluate(t, {}, scratch, o);
  if (r.whole) {
    o.state_gradient.setZero(t.states.rows(), 1);
    o.input_gradient.setZero(t.inputs.rows(), 1);
    term.evaluate(t, {.gradient = true}, scratch, o);
    const double above = r.sign * o.value(0, 0) - r.offset;
    if (above < -1e-9 * std::max(1.0, std::abs(r.offset))) {
      throw std::domain_error("term '" + std::string(term.name()) + "' is " +
                              std::to_string(-above) + " below the bound of its residual form, " +
                              std::to_string(r.offset));
    }
    const RootResidual root(above < 0.0 ? 0.0 : above);
    out.residuals[r.first_row] = r.root_weight * root.value;
    w.row.setZero();
    pull_back(o.state_gradient.col(0).matrix(), o.input_gradient.col(0).matrix(), workspace, w.row);
    out.residual_jacobian.row(r.first_row) =
        (r.root_weight * r.sign * root.slope) * w.row.transpose();
    return;
  }
  term.evaluate(t, {.residuals = r.sign}, scratch, o);
  out.residuals.segment(r.first_row, r.rows) = r.root_weight * o.residuals;
  for (std::size_t b = 0; b < r.pattern.size(); ++b) {
    const JacobianBlock& block = r.pattern[b];
    const auto derivative = o.jacobian.col(static_cast<Eigen::Index>(b));
    // A pattern covers what may depend on what: much of it is zero at any one trajectory.
    if (derivative.isZero(0.0)) continue;
    chain(block, derivative, workspace, out.residual_jacobian.row(r.first_row + block.row));
  }
  out.residual_jacobian.middleRows(r.first_row, r.rows) *= r.root_weight;
}

bool Problem::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& X, Evaluate what,
                       Workspace& workspace, Evaluation& out) const {
  Workspace::Impl& w = *workspace.impl_;
  const int n = num_variables();
  const int B = static_cast<int>(X.cols());
  const bool gradient = what >= Evaluate::kGradient;
  if (X.rows() != n || B < 1 || (gradient && B != 1)) {
    refuse("a batch of " + std::to_string(X.rows()) + " x " + std::to_string(B),
           std::to_string(n) + " rows and at least one column, exactly one with the gradient");
  }
  if (gradient && !has_gradient_)
    refuse("a gradient is asked for", "terms that all have gradients");

  roll(X, w.batch(B).trajectories);
  return evaluate_trajectories(B, what, workspace, out);
}

bool Problem::evaluate_states(const Eigen::Ref<const Eigen::VectorXd>& z,
                              const Eigen::Ref<const Eigen::MatrixXd>& states, Workspace& workspace,
                              Evaluation& out) const {
  if (z.size() != num_variables() || states.rows() != horizon_.nx() ||
      states.cols() != horizon_.N + 1) {
    refuse(std::to_string(z.size()) + " variables and " + std::to_string(states.rows()) + " x " +
               std::to_string(states.cols()) + " states",
           std::to_string(num_variables()) + " and " + std::to_string(horizon_.nx()) + " x " +
               std::to_string(horizon_.N + 1));
  }
  if (!has_gradient_) refuse("a gradient is asked for", "terms that all have gradients");
  TrajectoryBatch& t = workspace.impl_->batch(1).trajectories;
  set_inputs(z, t);
  t.states.resize(states.size(), 1);
  t.states.col(0).matrix() = states.reshaped();
  return evaluate_trajectories(1, Evaluate::kStages, workspace, out);
}

bool Problem::evaluate_trajectories(int B, Evaluate what, Workspace& workspace,
                                    Evaluation& out) const {
  Workspace::Impl& w = *workspace.impl_;
  const int n = num_variables();
  const int nx = horizon_.nx();
  const int nu = horizon_.nu();
  const bool residuals = what == Evaluate::kResiduals;
  const bool stages = what == Evaluate::kStages;
  const bool gradient = what >= Evaluate::kGradient;
  const bool score = what == Evaluate::kScore;
  if (residuals && w.residuals.empty()) prepare_residuals(workspace);
  if (stages && w.input_residuals.empty()) prepare_stages(workspace);

  Workspace::Impl::Batch& batch = w.batch(B);
  TrajectoryBatch& t = batch.trajectories;
  w.shared.begin(t, {.gradient = gradient, .score = score});
  if (B > w.scratch_batch) {
    for (std::size_t i = 0; i < definition_.terms.size(); ++i) {
      w.scratch[i] = definition_.terms[i].term->make_scratch(horizon_, B);
    }
    w.scratch_batch = B;
  }

  out.cost.setZero(B);
  out.cost_error.setZero(B);
  out.terms.setZero(static_cast<Eigen::Index>(definition_.terms.size()), B);
  out.constraints.resize(num_constraints_, B);
  out.valid.setConstant(B, true);
  if (gradient) {
    out.gradient.setZero(n);
    out.jacobian.setZero(num_constraints_, n);
    w.state_gradient.setZero();
    w.input_gradient.setZero();
    linearise(t, residuals || stages || num_constraints_ > 0, workspace);
  }
  if (stages) begin_stages(t, workspace, out.stages);
  if (residuals) {
    out.residual_offset = w.residual_offset;
    out.residuals.setZero(w.num_residuals);
    out.residual_jacobian.setZero(w.num_residuals, n);
  }

  int first_row = 0;
  for (std::size_t i = 0; i < definition_.terms.size(); ++i) {
    const auto& [term, weight] = definition_.terms[i];
    const auto& [constraint, scores, rows, blocks] = layouts_[i];
    TermOutput& o = batch.outputs[i];
    o.value.resize(rows, B);
    if (residuals && !constraint) {
      evaluate_residuals(i, t, o, workspace, out);
      out.terms.row(static_cast<Eigen::Index>(i)) = o.value.row(0);
      out.cost += weight * o.value.row(0).transpose();
      continue;
    }
    if (stages && !w.input_residuals[i].blocks.empty()) {
      evaluate_input_term(i, t, o, workspace, out.stages.input_hessian);
      out.terms.row(static_cast<Eigen::Index>(i)) = o.value.row(0);
      out.cost += weight * o.value.row(0).transpose();
      continue;
    }
    if (gradient && !constraint) {
      o.state_gradient.setZero((definition_.N + 1) * nx, 1);
      o.input_gradient.setZero(definition_.N * nu, 1);
    }
    term->evaluate(t, {.gradient = gradient, .score = score && scores}, w.scratch[i].get(), o);
    if (constraint) {
      out.constraints.middleRows(first_row, rows) = o.value.matrix();
      if (gradient) {
        for (std::size_t b = 0; b < blocks.size(); ++b) {
          chain(blocks[b], o.jacobian.col(static_cast<Eigen::Index>(b)), workspace,
                out.jacobian.row(first_row + blocks[b].row));
          if (stages && !blocks[b].input) {
            out.stages.constraint_drift[first_row + blocks[b].row] +=
                o.jacobian.col(static_cast<Eigen::Index>(b))
                    .head(nx)
                    .dot(out.stages.drift.col(blocks[b].stage));
          }
        }
      }
      first_row += rows;
    } else {
      out.terms.row(static_cast<Eigen::Index>(i)) = o.value.row(0);
      out.cost += weight * o.value.row(0).transpose();
      if (score && scores) {
        out.cost_error +=
            kScoreError * std::abs(weight) * o.value.row(0).abs().max(1.0).transpose();
      }
      if (gradient) {
        w.state_gradient += weight * o.state_gradient;
        w.input_gradient += weight * o.input_gradient;
      }
      if (stages) out.stages.state_gradient.reshaped() += weight * o.state_gradient.col(0).matrix();
    }
  }

  if (residuals) {
    out.gradient.noalias() = out.residual_jacobian.transpose() * out.residuals;
  } else if (gradient) {
    pull_back(w.state_gradient.col(0).matrix(), w.input_gradient.col(0).matrix(), workspace,
              out.gradient);
  }

  return reject_invalid(B, what, out);
}

Explanation Problem::explain(const Eigen::Ref<const Eigen::VectorXd>& z) const {
  Workspace workspace = make_workspace();
  Evaluation evaluation;
  evaluate(z, Evaluate::kValue, workspace, evaluation);
  Explanation e;
  e.cost = evaluation.cost[0];
  e.violation = prospect::violation(evaluation.constraints.col(0));
  for (std::size_t i = 0; i < definition_.terms.size(); ++i) {
    const auto& [term, weight] = definition_.terms[i];
    const TermTraits traits = term->traits();
    TermValue v{std::string(term->name()),
                traits.unit,
                0.0,
                0.0,
                traits.kind == TermKind::kConstraint,
                traits.quantity};
    const BatchArray& value = workspace.impl_->batch(1).outputs[i].value;
    v.raw = value.size() > 0 ? value.minCoeff() : 0.0;
    v.weighted = v.constraint ? 0.0 : weight * v.raw;
    e.terms.push_back(std::move(v));
  }
  return e;
}

TrajectoryBatch Problem::rollout(const Eigen::Ref<const Eigen::VectorXd>& z) const {
  TrajectoryBatch t;
  t.horizon = horizon_;
  t.layout = definition_.model->pose_layout();
  t.u_previous = definition_.u_previous;
  roll(z, t);
  return t;
}

Eigen::VectorXd Problem::knots_from_inputs(const Eigen::Ref<const Eigen::MatrixXd>& inputs) const {
  const int nu = horizon_.nu();
  Eigen::VectorXd z = Eigen::VectorXd::Zero(num_variables());
  Eigen::VectorXi stages = Eigen::VectorXi::Zero(definition_.M);
  for (int k = 0; k < definition_.N; ++k) {
    z.segment(knot(k) * nu, nu) += inputs.row(k).transpose();
    ++stages[knot(k)];
  }
  for (int m = 0; m < definition_.M; ++m) z.segment(m * nu, nu) /= stages[m];
  return z.cwiseMax(lower_).cwiseMin(upper_);
}

}  // namespace prospect
