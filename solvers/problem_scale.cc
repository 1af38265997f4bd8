// SPDX-License-Identifier: Apache-2.0
#include "solvers/problem_scale.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/typical_change.h"

namespace prospect {
namespace {

using Eigen::Index;
using Vector = Eigen::VectorXd;

// The unit of a cost that is given another one: in the middle of the plain ones.
constexpr double kScaledUnit = 8.0;

/// A cost that is the same everywhere.
class Constant final : public Term {
 public:
  explicit Constant(double value) : value_(value) {}
  std::string_view name() const override { return "offset"; }
  TermTraits traits() const override {
    return {TermKind::kCost, Smoothness::kSmooth, true, "-", "none"};
  }
  std::optional<ResidualForm> residual_form(const Horizon&, int sign) const override {
    return ResidualForm{sign * value_, 0, {}};
  }
  void evaluate(const TrajectoryBatch&, const TermRequest&, TermScratch*,
                TermOutput& out) const override {
    out.value.row(0).setConstant(value_);
  }

 private:
  double value_;
};

/// A constraint whose rows are divided by units.
class Rescaled final : public Term {
 public:
  Rescaled(std::shared_ptr<const Term> term, const Horizon& horizon, Vector unit)
      : term_(std::move(term)), unit_(std::move(unit)), blocks_(term_->jacobian_pattern(horizon)) {}
  std::string_view name() const override { return term_->name(); }
  TermTraits traits() const override { return term_->traits(); }
  int rows(const Horizon& horizon) const override { return term_->rows(horizon); }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon&) const override { return blocks_; }
  std::unique_ptr<TermScratch> make_scratch(const Horizon& horizon, int batch) const override {
    return term_->make_scratch(horizon, batch);
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch* scratch,
                TermOutput& out) const override {
    term_->evaluate(t, request, scratch, out);
    out.value.colwise() /= unit_.array();
    if (!request.gradient) return;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      out.jacobian.col(static_cast<Index>(b)) /= unit_[blocks_[b].row];
    }
  }

 private:
  std::shared_ptr<const Term> term_;
  Vector unit_;
  std::vector<JacobianBlock> blocks_;
};

/// What is known of the units near a point.
struct Units {
  double value = 0.0;  ///< of the cost, there
  double cost = 0.0;
  Vector constraints;

  bool plain_cost() const { return is_plain_cost(value, cost); }
  bool plain_constraints() const {
    return std::all_of(constraints.begin(), constraints.end(), is_plain_unit);
  }
};

Vector change_at(const Problem& problem, const Vector& z) {
  return typical_change(z, problem.lower(), problem.upper());
}

Units units_at(const Evaluation& e, const Vector& s) {
  Units units;
  units.value = e.cost[0];
  units.constraints = e.constraints.col(0).cwiseAbs();
  if (e.gradient.size() != s.size()) return units;
  units.cost = e.gradient.cwiseProduct(s).lpNorm<Eigen::Infinity>();
  for (Index r = 0; r < units.constraints.size(); ++r) {
    const double change = e.jacobian.row(r).transpose().cwiseProduct(s).lpNorm<Eigen::Infinity>();
    units.constraints[r] = std::max(units.constraints[r], change);
  }
  return units;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Units units_near(const Problem& problem, const Vector& z, const EvaluatePoint& evaluate) {
  const Vector s = change_at(problem, z);
  Evaluation e;
  const Evaluate what = problem.has_gradient() ? Evaluate::kGradient : Evaluate::kValue;
  if (evaluate(z, what, e) != EvaluationOutcome::kEvaluated) return {};
  Units units = units_at(e, s);
  const Vector constraints = e.constraints.col(0);

  // Around z; and where else a constraint may be small: what is large at a start far from all that
  // matters is of no large unit.
  const auto within = [&](const Vector& x) {
    return Vector(x.cwiseMax(problem.lower()).cwiseMin(problem.upper()));
  };
  std::vector<Vector> points;
  std::mt19937_64 generator(1);
  constexpr int kPoints = 8;
  for (int k = 0; k < kPoints; ++k) {
    Vector x = z;
    for (Index i = 0; i < x.size(); ++i) {
      const double uniform = static_cast<double>(generator() >> 11) * 0x1p-53;
      x[i] += (k % 2 == 0 ? 1.0 : 0.1) * s[i] * (2.0 * uniform - 1.0);
    }
    points.push_back(within(x));
  }
  points.push_back(within(Vector::Zero(z.size())));
  points.push_back(0.5 * (problem.lower() + problem.upper()));

  std::vector<double> changes;
  Vector largest = units.constraints, least = units.constraints;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const EvaluationOutcome outcome = evaluate(points[k], Evaluate::kValue, e);
    if (outcome == EvaluationOutcome::kStopped) return {};
    if (outcome != EvaluationOutcome::kEvaluated) continue;
    const Vector change =
        e.constraints.col(0).cwiseAbs().cwiseMax((e.constraints.col(0) - constraints).cwiseAbs());
    least = least.cwiseMin(change);
    if (k >= kPoints) continue;
    largest = largest.cwiseMax(change);
    changes.push_back(std::abs(e.cost[0] - units.value));
  }
  units.cost = std::max(units.cost, median(changes));
  for (Index r = 0; r < constraints.size(); ++r) {
    const bool small = largest[r]<kSmallestUnit, large = least[r]> kLargestUnit;
    units.constraints[r] = small ? largest[r] : large ? least[r] : 1.0;
  }
  return units;
}

/// The power of two next to it.
double power_of_two(double unit) { return std::exp2(std::round(std::log2(unit))); }

}  // namespace

bool looks_plain(const Problem& problem, const Vector& z, const Evaluation& e) {
  const Units units = units_at(e, change_at(problem, z));
  if (units.cost > 0.0) {
    return units.plain_cost() && units.plain_constraints() &&
           (units.constraints.array() > 0.0).all();
  }
  // Values alone: a constraint may be small there. What is far too small for its unit is not, nor
  // is an offset that drowns anything or a cost that is lost in a tolerance.
  const auto is_lost = [](double value) { return value > 0.0 && value < 1e-4; };
  const double value = std::abs(units.value);
  return !is_lost(value) && value <= kLargestUnit &&
         std::none_of(units.constraints.begin(), units.constraints.end(), is_lost) &&
         (units.constraints.array() <= kLargestUnit).all();
}

double cost_change_near(const Problem& problem, const Vector& z, const EvaluatePoint& evaluate) {
  return units_near(problem, z, evaluate).cost;
}

ProblemScale scale_near(const Problem& problem, const Vector& z, const EvaluatePoint& evaluate) {
  const Units units = units_near(problem, z, evaluate);
  ProblemScale scale;
  if (units.cost > 0.0 && !units.plain_cost()) {
    scale.cost = power_of_two(units.cost / kScaledUnit);
    scale.offset = units.value;
  }
  if (!units.plain_constraints()) {
    scale.constraints = units.constraints.unaryExpr(
        [](double unit) { return is_plain_unit(unit) ? 1.0 : power_of_two(unit); });
  }
  return scale;
}

bool ProblemScale::like(const ProblemScale& other) const {
  // By as much as makes a unit plain or not.
  const auto near = [](double a, double b) { return a < 128.0 * b && b < 128.0 * a; };
  if (!near(cost, other.cost) || (offset == 0.0) != (other.offset == 0.0)) return false;
  const Index m = std::max(constraints.size(), other.constraints.size());
  const auto of = [](const Vector& units, Index r) { return units.size() > 0 ? units[r] : 1.0; };
  for (Index r = 0; r < m; ++r) {
    if (!near(of(constraints, r), of(other.constraints, r))) return false;
  }
  return true;
}

Problem ProblemScale::apply(const Problem& problem) const {
  ProblemDefinition d = problem.definition();
  Index row = 0;
  for (auto& [term, weight] : d.terms) {
    if (term->traits().kind == TermKind::kCost) {
      weight /= cost;
      continue;
    }
    const int rows = term->rows(problem.horizon());
    if (constraints.size() > 0) {
      term = std::make_shared<Rescaled>(term, problem.horizon(), constraints.segment(row, rows));
    }
    row += rows;
  }
  if (offset != 0.0) d.terms.push_back({std::make_shared<Constant>(-offset), 1.0 / cost});
  return Problem(std::move(d));
}

WarmStart ProblemScale::apply(WarmStart start) const {
  if (start.lambda.size() == constraints.size()) start.lambda.array() *= constraints.array();
  for (Vector* multipliers : {&start.lambda, &start.z_lower, &start.z_upper}) *multipliers /= cost;
  start.mu /= cost;
  start.stage_hessians /= cost;
  return start;
}

void ProblemScale::undo(const Problem& problem, Result& result) const {
  if (plain()) return;
  for (Improvement& i : result.trace) i.cost = offset + cost * i.cost;
  WarmStart& next = result.next;
  if (next.lambda.size() == constraints.size()) next.lambda.array() /= constraints.array();
  for (Vector* multipliers : {&next.lambda, &next.z_lower, &next.z_upper}) *multipliers *= cost;
  next.mu *= cost;
  next.stage_hessians *= cost;
  if (result.quality == Quality::kNone) return;
  // Their sum to rounding, but the cost of the problem at x has all its bits.
  result.explanation = problem.explain(result.x);
  result.cost = result.explanation.cost;
  if (!result.trace.empty()) result.trace.back().cost = result.cost;
}

}  // namespace prospect
