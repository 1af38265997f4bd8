// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/lifted_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "engine/problem/shared_results.h"

namespace prospect {
namespace {

/// The pattern of entries (column, row), in any order and as often as wanted.
ColumnPattern pattern_of(std::vector<std::pair<int, int>> entries, int height, int width) {
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  ColumnPattern pattern;
  pattern.height = height;
  pattern.starts.assign(static_cast<std::size_t>(width) + 1, 0);
  for (const auto& [column, row] : entries) {
    pattern.rows.push_back(row);
    ++pattern.starts[static_cast<std::size_t>(column) + 1];
  }
  for (std::size_t j = 1; j < pattern.starts.size(); ++j) {
    pattern.starts[j] += pattern.starts[j - 1];
  }
  return pattern;
}

}  // namespace

int ColumnPattern::place(int row, int column) const {
  const auto begin = rows.begin() + starts[static_cast<std::size_t>(column)];
  const auto end = rows.begin() + starts[static_cast<std::size_t>(column) + 1];
  const auto found = std::lower_bound(begin, end, row);
  return found != end && *found == row ? static_cast<int>(found - rows.begin()) : -1;
}

ColumnPattern column_pattern(const Problem& problem) {
  const auto& dense = problem.jacobian_pattern();
  std::vector<std::pair<int, int>> entries;
  for (Eigen::Index j = 0; j < dense.cols(); ++j) {
    for (Eigen::Index i = 0; i < dense.rows(); ++i) {
      if (dense(i, j)) entries.emplace_back(static_cast<int>(j), static_cast<int>(i));
    }
  }
  return pattern_of(std::move(entries), problem.num_constraints(), problem.num_variables());
}

LiftedProblem::LiftedProblem(std::shared_ptr<const Problem> problem)
    : problem_(std::move(problem)) {
  const Problem& p = *problem_;
  if (!p.has_gradient()) {
    throw std::invalid_argument("a term has no gradient; expected gradients of all");
  }
  const Horizon& h = p.horizon();
  const int n = p.num_variables(), nx = h.nx(), nu = h.nu(), states = h.N * nx;
  lower_.setConstant(n + states, -std::numeric_limits<double>::infinity());
  upper_ = -lower_;
  lower_.head(n) = p.lower();
  upper_.head(n) = p.upper();
  std::vector<std::pair<int, int>> entries;
  const auto add = [&](int row, int column, int count) {
    for (int j = 0; j < count; ++j) entries.emplace_back(column + j, row);
  };
  for (int k = 0; k < h.N; ++k) {
    for (int i = 0; i < nx; ++i) {
      const int row = k * nx + i;
      add(row, p.knot(k) * nu, nu);
      if (k > 0) add(row, state_column(k), nx);
      add(row, state_column(k + 1) + i, 1);
    }
  }
  int first = states;
  for (const auto& [term, weight] : p.definition().terms) {
    if (term->traits().kind != TermKind::kConstraint) continue;
    for (const JacobianBlock& block : term->jacobian_pattern(h)) {
      if (block.input) {
        add(first + block.row, p.knot(block.stage) * nu, nu);
      } else if (block.stage > 0) {
        add(first + block.row, state_column(block.stage), nx);
      }
    }
    first += term->rows(h);
  }
  pattern_ = pattern_of(std::move(entries), first, n + states);
}

Eigen::VectorXd LiftedProblem::lifted(const Eigen::Ref<const Eigen::VectorXd>& z) const {
  const TrajectoryBatch t = problem_->rollout(z);
  Eigen::VectorXd w(num_variables());
  const Eigen::Index states = w.size() - z.size();
  w << z, t.states.col(0).tail(states).matrix();
  return w;
}

void LiftedProblem::evaluate_dynamics(const TrajectoryBatch& t, Value& out) const {
  const Horizon& h = problem_->horizon();
  const int nx = h.nx(), nu = h.nu();
  Eigen::MatrixXd A(nx, nx), B(nx, nu);
  Eigen::VectorXd next(nx);
  for (int k = 0; k < h.N; ++k) {
    const Eigen::VectorXd x = t.states.col(0).segment(k * nx, nx).matrix();
    const Eigen::VectorXd u = t.inputs.col(0).segment(k * nu, nu).matrix();
    h.model->step(x, u, h.dt, next);
    h.model->jacobians(x, u, h.dt, A, B);
    out.constraints.segment(k * nx, nx) = next - t.states.col(0).segment((k + 1) * nx, nx).matrix();
    for (int i = 0; i < nx; ++i) {
      const int row = k * nx + i;
      for (int j = 0; j < nu; ++j) add(row, problem_->knot(k) * nu + j, B(i, j), out);
      for (int j = 0; j < nx && k > 0; ++j) add(row, state_column(k) + j, A(i, j), out);
      add(row, state_column(k + 1) + i, -1.0, out);
    }
  }
}

void LiftedProblem::add_cost(const TermOutput& o, double weight, Value& out) const {
  const Horizon& h = problem_->horizon();
  const int nx = h.nx(), nu = h.nu();
  out.cost += weight * o.value(0, 0);
  out.gradient.tail(h.N * nx) += weight * o.state_gradient.col(0).tail(h.N * nx).matrix();
  for (int k = 0; k < h.N; ++k) {
    out.gradient.segment(problem_->knot(k) * nu, nu) +=
        weight * o.input_gradient.col(0).segment(k * nu, nu).matrix();
  }
}

void LiftedProblem::add_constraint(const TermOutput& o, const std::vector<JacobianBlock>& blocks,
                                   int first, Value& out) const {
  const Horizon& h = problem_->horizon();
  out.constraints.segment(first, o.value.rows()) = o.value.col(0).matrix();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const JacobianBlock& block = blocks[b];
    if (!block.input && block.stage == 0) continue;  // x_0 is given
    const int count = block.input ? h.nu() : h.nx();
    const int column =
        block.input ? problem_->knot(block.stage) * count : state_column(block.stage);
    for (int j = 0; j < count; ++j) {
      add(first + block.row, column + j, o.jacobian(j, static_cast<Eigen::Index>(b)), out);
    }
  }
}

bool LiftedProblem::evaluate(const Eigen::Ref<const Eigen::VectorXd>& w, Value& out) const {
  const Problem& p = *problem_;
  const Horizon& h = p.horizon();
  const int states = h.N * h.nx();
  TrajectoryBatch t = p.rollout(w.head(p.num_variables()));
  t.states.col(0).tail(states) = w.tail(states).array();
  SharedResults shared;
  const TermRequest request{.gradient = true};
  shared.begin(t, request);
  out.cost = 0.0;
  out.gradient.setZero(num_variables());
  out.constraints.setZero(num_constraints());
  out.jacobian.setZero(pattern_.nonzeros());
  evaluate_dynamics(t, out);
  TermOutput o;
  int first = states;
  for (const auto& [term, weight] : p.definition().terms) {
    const bool constraint = term->traits().kind == TermKind::kConstraint;
    const std::vector<JacobianBlock> blocks =
        constraint ? term->jacobian_pattern(h) : std::vector<JacobianBlock>();
    o.value.setZero(constraint ? term->rows(h) : 1, 1);
    o.state_gradient.setZero(t.states.rows(), 1);
    o.input_gradient.setZero(t.inputs.rows(), 1);
    o.jacobian.setZero(std::max(h.nx(), h.nu()), static_cast<Eigen::Index>(blocks.size()));
    const std::unique_ptr<TermScratch> scratch = term->make_scratch(h, 1);
    term->evaluate(t, request, scratch.get(), o);
    if (constraint) {
      add_constraint(o, blocks, first, out);
      first += static_cast<int>(o.value.rows());
    } else {
      add_cost(o, weight, out);
    }
  }
  return std::isfinite(out.cost) && out.gradient.allFinite() && out.constraints.allFinite() &&
         out.jacobian.allFinite();
}

}  // namespace prospect
