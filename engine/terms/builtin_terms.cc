// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/builtin_terms.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "engine/terms/braking_constraint.h"
#include "engine/terms/clearance_constraint.h"
#include "engine/terms/control_effort.h"
#include "engine/terms/cost_to_go_term.h"
#include "engine/terms/heading_alignment.h"
#include "engine/terms/input_rate.h"
#include "engine/terms/obstacle_cost.h"
#include "engine/terms/problem_specification.h"
#include "engine/terms/rate_limit.h"
#include "engine/terms/speed_limit.h"

namespace prospect {
namespace {

using Specification = ProblemSpecification;
using Weights = Specification::Weights;
using Evaluators = CachedEvaluators;
using Made = std::shared_ptr<const Term>;

/// An entry, and where its weight is in a specification.
struct BuiltinTerm {
  TermEntry entry;
  double Weights::*weight = nullptr;  ///< of a cost
  double sign = 1.0;                  ///< -1: a reward

  /// In an objective.
  double factor(const Weights& weights) const { return weight ? sign * (weights.*weight) : 1.0; }
};

using Make = Made (*)(const Specification&, const Evaluators&);

BuiltinTerm constraint(std::string name, std::string description, Make make) {
  BuiltinTerm term{{std::move(name), std::move(description)}};
  term.entry.make = [make](const TermOptions&, const TermContext& c) {
    return make(c.specification, c.evaluators);
  };
  term.entry.built_in = true;
  term.entry.constraint = true;
  return term;
}

BuiltinTerm cost(std::string name, const char* key, double Weights::*weight,
                 std::string description, Make make) {
  BuiltinTerm term = constraint(std::move(name), std::move(description), make);
  term.entry.constraint = false;
  term.entry.weight_key = std::string("planner.weights.") + key;
  term.weight = weight;
  return term;
}

BuiltinTerm reward(BuiltinTerm cost) {
  cost.sign = -1.0;
  return cost;
}

// Once: a planner asks at every step.
const std::vector<BuiltinTerm>& table() {
  static const std::vector<BuiltinTerm> all = {
      cost("control_effort", "w_u", &Weights::control_effort,
           "deviation of the input from the desired one",
           [](const Specification& s, const Evaluators&) -> Made {
             return std::make_shared<ControlEffort>(s.desired_input, s.robot.model->limits());
           }),
      cost("input_rate", "w_du", &Weights::input_rate, "change of the input from stage to stage",
           [](const Specification& s, const Evaluators&) -> Made {
             return std::make_shared<InputRate>(s.robot.model->limits());
           }),
      cost("obstacles", "w_o", &Weights::obstacles, "closeness to obstacles, from FCL distances",
           [](const Specification& s, const Evaluators& e) -> Made {
             return std::make_shared<ObstacleCost>(e.body, s.d_safe, s.d_des, s.movers,
                                                   circumscribed_radius(s.robot.shape));
           }),
      cost("visible_features", "w_l", &Weights::visible_features,
           "too few features predicted in view (count or information); with w_c also "
           "the chance of fewer than N_min",
           [](const Specification&, const Evaluators& e) -> Made { return e.visible_features; }),
      reward(cost("exploration_gain", "w_e", &Weights::exploration_gain,
                  "expected newly explored area (a reward)",
                  [](const Specification&, const Evaluators& e) -> Made { return e.gain; })),
      cost("cost_to_go", "w_T", &Weights::cost_to_go,
           "time to the viewpoints of the active frontiers",
           [](const Specification& s, const Evaluators&) -> Made {
             return std::make_shared<CostToGoTerm>(s.cost_to_go);
           }),
      cost("heading_alignment", "w_h", &Weights::heading_alignment,
           "heading away from where the cost-to-go falls",
           [](const Specification& s, const Evaluators&) -> Made {
             if (!(s.weights.heading_alignment > 0.0)) return nullptr;
             return std::make_shared<HeadingAlignment>(s.cost_to_go);
           }),
      constraint("clearance", "constraint: clearance of at least d_safe at nodes and mid-points",
                 [](const Specification& s, const Evaluators& e) -> Made {
                   return std::make_shared<ClearanceConstraint>(e.body, s.clearance);
                 }),
      constraint("braking", "constraint: able to stop inside known free space",
                 [](const Specification& s, const Evaluators& e) -> Made {
                   if (s.unknown == UnknownPolicy::kFree) return nullptr;
                   return unknown_space_constraint(s.unknown, e.known_body, s.unknown_d_safe);
                 }),
      constraint("rate_limit", "constraint: the model's limits on the change of inputs",
                 [](const Specification& s, const Evaluators&) -> Made {
                   const InputLimits& limits = s.robot.model->limits();
                   if (!limits.rate.array().isFinite().any()) return nullptr;
                   return std::make_shared<RateLimit>(limits, s.M);
                 }),
      constraint("speed_limit", "constraint: speed limits of models with velocity in the state",
                 [](const Specification& s, const Evaluators&) -> Made {
                   const MotionModel& model = *s.robot.model;
                   if (model.num_state_constraints() == 0) return nullptr;
                   return std::make_shared<SpeedLimit>(model);
                 }),
  };
  return all;
}

/// Null: no built-in cost has that name.
const BuiltinTerm* builtin_cost(std::string_view name) {
  for (const BuiltinTerm& term : table()) {
    if (term.weight && term.entry.name == name) return &term;
  }
  return nullptr;
}

}  // namespace

TermRegistry builtin_terms() {
  TermRegistry registry;
  for (const BuiltinTerm& term : table()) registry.add(term.entry);
  return registry;
}

std::vector<ProblemDefinition::WeightedTerm> make_builtin_terms(const TermContext& context) {
  const std::vector<std::string>& left_out = context.specification.terms_left_out;
  std::vector<ProblemDefinition::WeightedTerm> terms;
  for (const BuiltinTerm& t : table()) {
    if (std::find(left_out.begin(), left_out.end(), t.entry.name) != left_out.end()) continue;
    if (std::shared_ptr<const Term> term = t.entry.make({}, context)) {
      terms.push_back({std::move(term), t.factor(context.specification.weights)});
    }
  }
  return terms;
}

double* weight_of(std::string_view name, ProblemSpecification::Weights& weights) {
  const BuiltinTerm* term = builtin_cost(name);
  return term ? &(weights.*term->weight) : nullptr;
}

std::optional<double> builtin_weight(std::string_view name,
                                     const ProblemSpecification::Weights& weights) {
  const BuiltinTerm* term = builtin_cost(name);
  return term ? std::optional(term->factor(weights)) : std::nullopt;
}

}  // namespace prospect
