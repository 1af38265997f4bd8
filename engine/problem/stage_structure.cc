// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/stage_structure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/problem/shared_results.h"

namespace prospect {
namespace {

/// Nodes and inputs that a row depends on.
struct Span {
  int first_state = std::numeric_limits<int>::max(), last_state = -1;
  int first_input = std::numeric_limits<int>::max(), last_input = -1;

  void add(const JacobianBlock& block) {
    int& first = block.input ? first_input : first_state;
    int& last = block.input ? last_input : last_state;
    first = std::min(first, block.stage);
    last = std::max(last, block.stage);
  }
  /// The stage that has all of it; -1: none.
  int stage() const {
    const bool states = last_state >= 0, inputs = last_input >= 0;
    if (!states && !inputs) return 0;
    // x_k and x_{k+1} are of stage k, u_k and u_{k-1} likewise.
    const int low = std::max(states ? last_state - 1 : 0, inputs ? last_input : 0);
    const int high = std::min(states ? first_state : std::numeric_limits<int>::max(),
                              inputs ? first_input + 1 : std::numeric_limits<int>::max());
    if (low > high) return -1;
    return states ? high : low;
  }
};

/// The stage of each row; empty if some row has none.
std::vector<int> stages_of(const std::vector<JacobianBlock>& pattern, int rows) {
  std::vector<Span> spans(static_cast<std::size_t>(rows));
  for (const JacobianBlock& block : pattern) spans[static_cast<std::size_t>(block.row)].add(block);
  std::vector<int> stages;
  for (const Span& span : spans) {
    if (span.stage() < 0) return {};
    stages.push_back(span.stage());
  }
  return stages;
}

/// Rows of residuals or constraints as they are gathered, by stage.
struct Rows {
  std::vector<double> values;
  std::vector<Eigen::RowVectorXd> by_s, by_v;
};

class Builder {
 public:
  Builder(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& z,
          const Eigen::Ref<const Eigen::MatrixXd>& states)
      : problem_(problem),
        d_(problem.definition()),
        nx_(problem.horizon().nx()),
        nu_(problem.horizon().nu()),
        t_(problem.rollout(z)) {
    for (int k = 0; k <= d_.N; ++k) t_.states.col(0).segment(k * nx_, nx_) = states.col(k).array();
    out_.stages.resize(static_cast<std::size_t>(d_.N) + 1);
    residuals_.resize(out_.stages.size());
    constraints_.resize(out_.stages.size());
    dynamics();
    shared_.begin(t_, {.gradient = true});
  }

  StageStructure build() {
    for (const auto& [term, weight] : d_.terms) {
      if (term->traits().kind == TermKind::kConstraint) {
        add_constraint(*term);
      } else {
        add_cost(*term, weight);
      }
    }
    for (std::size_t k = 0; k < out_.stages.size(); ++k) {
      Stage& stage = out_.stages[k];
      stack(residuals_[k], stage.residuals, stage.residuals_s, stage.residuals_v);
      stack(constraints_[k], stage.constraints, stage.constraints_s, stage.constraints_v);
    }
    return std::move(out_);
  }

 private:
  int ns() const { return nx_ + nu_; }
  Stage& stage(int k) { return out_.stages[static_cast<std::size_t>(k)]; }

  void dynamics() {
    for (int k = 0; k <= d_.N; ++k) {
      Stage& s = stage(k);
      s.gradient_s.setZero(ns());
      s.gradient_v.setZero(nu_);
      s.decides = k < d_.N && (k == 0 || problem_.knot(k) != problem_.knot(k - 1));
      if (k == d_.N) continue;
      const Eigen::VectorXd x = t_.states.col(0).segment(k * nx_, nx_).matrix();
      const Eigen::VectorXd u = t_.inputs.col(0).segment(k * nu_, nu_).matrix();
      Eigen::MatrixXd by_x(nx_, nx_), by_u(nx_, nu_);
      Eigen::VectorXd next(nx_);
      d_.model->step(x, u, d_.dt, next);
      d_.model->jacobians(x, u, d_.dt, by_x, by_u);
      s.A.setZero(ns(), ns());
      s.B.setZero(ns(), nu_);
      s.A.topLeftCorner(nx_, nx_) = by_x;
      if (s.decides) {
        s.B << by_u, Eigen::MatrixXd::Identity(nu_, nu_);
      } else {
        s.A.rightCols(nu_) << by_u, Eigen::MatrixXd::Identity(nu_, nu_);
      }
      s.gap.setZero(ns());
      s.gap.head(nx_) = next - t_.states.col(0).segment((k + 1) * nx_, nx_).matrix();
    }
  }

  /// Evaluates with outputs of the right sizes. Throws std::domain_error if that gives no numbers.
  void evaluate(const Term& term, const TermRequest& request, int rows, Eigen::Index blocks) {
    o_.value.setZero(rows, 1);
    o_.state_gradient.setZero(t_.states.rows(), 1);
    o_.input_gradient.setZero(t_.inputs.rows(), 1);
    o_.residuals.setZero(request.residuals != 0 ? rows_of_residuals_ : 0);
    o_.jacobian.setZero(std::max(nx_, nu_), blocks);
    const std::unique_ptr<TermScratch> scratch = term.make_scratch(problem_.horizon(), 1);
    term.evaluate(t_, request, scratch.get(), o_);
    const bool finite = o_.value.allFinite() && o_.state_gradient.allFinite() &&
                        o_.input_gradient.allFinite() && o_.residuals.allFinite() &&
                        o_.jacobian.allFinite();
    if (!finite) {
      throw std::domain_error("stage structure: term '" + std::string(term.name()) +
                              "' is not evaluable at this trajectory");
    }
  }

  void add_cost(const Term& term, double weight) {
    const int sign = weight > 0.0 ? 1 : -1;
    const auto form = weight == 0.0 ? std::nullopt : term.residual_form(problem_.horizon(), sign);
    const std::vector<int> stages =
        form && form->rows > 0 ? stages_of(form->pattern, form->rows) : std::vector<int>();
    if (!stages.empty()) {
      rows_of_residuals_ = form->rows;
      evaluate(term, {.residuals = sign}, 1, static_cast<Eigen::Index>(form->pattern.size()));
      const double root = std::sqrt(std::abs(weight));
      add_rows(residuals_, stages, root * o_.residuals, form->pattern, root);
      out_.offset += std::abs(weight) * form->offset;
    } else {
      evaluate(term, {.gradient = true}, 1, 0);
      if (weight != 0.0) out_.by_gradient.emplace_back(term.name());
      for (int k = 0; k <= d_.N; ++k) {
        stage(k).gradient_s.head(nx_) +=
            weight * o_.state_gradient.col(0).segment(k * nx_, nx_).matrix();
        if (k == d_.N) continue;
        const Eigen::VectorXd by_u =
            weight * o_.input_gradient.col(0).segment(k * nu_, nu_).matrix();
        if (stage(k).decides) {
          stage(k).gradient_v += by_u;
        } else {
          stage(k).gradient_s.tail(nu_) += by_u;
        }
      }
    }
    out_.cost += weight * o_.value(0, 0);
  }

  void add_constraint(const Term& term) {
    const int rows = term.rows(problem_.horizon());
    const std::vector<JacobianBlock> pattern = term.jacobian_pattern(problem_.horizon());
    const std::vector<int> stages = stages_of(pattern, rows);
    if (stages.empty() && rows > 0) {
      throw std::invalid_argument("stage structure: constraint '" + std::string(term.name()) +
                                  "' couples more than a stage; expected rows of a stage each");
    }
    evaluate(term, {.gradient = true}, rows, static_cast<Eigen::Index>(pattern.size()));
    add_rows(constraints_, stages, o_.value.col(0).matrix(), pattern, 1.0);
  }

  void add_rows(std::vector<Rows>& to, const std::vector<int>& stages,
                const Eigen::VectorXd& values, const std::vector<JacobianBlock>& pattern,
                double scale) {
    std::vector<std::size_t> places;
    for (std::size_t r = 0; r < stages.size(); ++r) {
      Rows& rows = to[static_cast<std::size_t>(stages[r])];
      places.push_back(rows.values.size());
      rows.values.push_back(values[static_cast<Eigen::Index>(r)]);
      rows.by_s.emplace_back(Eigen::RowVectorXd::Zero(ns()));
      rows.by_v.emplace_back(Eigen::RowVectorXd::Zero(nu_));
    }
    for (std::size_t b = 0; b < pattern.size(); ++b) {
      const JacobianBlock& block = pattern[b];
      const auto r = static_cast<std::size_t>(block.row);
      const int k = stages[r];
      const Stage& s = stage(k);
      Rows& rows = to[static_cast<std::size_t>(k)];
      Eigen::RowVectorXd& by_s = rows.by_s[places[r]];
      Eigen::RowVectorXd& by_v = rows.by_v[places[r]];
      const Eigen::RowVectorXd derivative =
          scale *
          o_.jacobian.col(static_cast<Eigen::Index>(b)).head(block.input ? nu_ : nx_).transpose();
      if (block.input) {
        if (block.stage == k && s.decides) {
          by_v += derivative;
        } else {
          by_s.tail(nu_) += derivative;
        }
      } else if (block.stage == k) {
        by_s.head(nx_) += derivative;
      } else {
        by_s += derivative * s.A.topRows(nx_);
        by_v += derivative * s.B.topRows(nx_);
        rows.values[places[r]] += derivative.dot(s.gap.head(nx_));
      }
    }
  }

  void stack(const Rows& rows, Eigen::VectorXd& values, Eigen::MatrixXd& by_s,
             Eigen::MatrixXd& by_v) const {
    const auto count = static_cast<Eigen::Index>(rows.values.size());
    values = Eigen::VectorXd::Map(rows.values.data(), count);
    by_s.resize(count, ns());
    by_v.resize(count, nu_);
    for (Eigen::Index r = 0; r < count; ++r) {
      by_s.row(r) = rows.by_s[static_cast<std::size_t>(r)];
      by_v.row(r) = rows.by_v[static_cast<std::size_t>(r)];
    }
  }

  const Problem& problem_;
  const ProblemDefinition& d_;
  int nx_, nu_;
  TrajectoryBatch t_;
  SharedResults shared_;
  TermOutput o_;
  int rows_of_residuals_ = 0;
  StageStructure out_;
  std::vector<Rows> residuals_, constraints_;  // by stage
};

}  // namespace

StageStructure stage_structure(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& z,
                               const Eigen::Ref<const Eigen::MatrixXd>& states) {
  const Horizon& horizon = problem.horizon();
  if (z.size() != problem.num_variables() || states.rows() != horizon.nx() ||
      states.cols() != horizon.N + 1) {
    throw std::invalid_argument(
        "stage structure: " + std::to_string(z.size()) + " inputs, " +
        std::to_string(states.rows()) + " x " + std::to_string(states.cols()) +
        " states; expected " + std::to_string(problem.num_variables()) + ", " +
        std::to_string(horizon.nx()) + " x " + std::to_string(horizon.N + 1));
  }
  if (!problem.has_gradient()) {
    throw std::invalid_argument(
        "stage structure: a term has no gradient; expected gradients of all");
  }
  return Builder(problem, z, states).build();
}

StageStructure stage_structure(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& z) {
  if (z.size() != problem.num_variables()) return stage_structure(problem, z, Eigen::MatrixXd());
  const TrajectoryBatch t = problem.rollout(z);
  const int nx = problem.horizon().nx();
  return stage_structure(problem, z,
                         Eigen::MatrixXd::Map(t.states.col(0).data(), nx, problem.horizon().N + 1));
}

}  // namespace prospect
