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
using Evaluators = CachedEvaluators;
using Made = std::shared_ptr<const Term>;

/// An entry, and its weight in the objective of a specification.
struct BuiltinTerm {
  TermEntry entry;
  double (*weight)(const Specification::Weights&);
};

TermEntry cost(std::string name, std::string key, std::string description,
               Made (*make)(const Specification&, const Evaluators&)) {
  TermEntry entry{std::move(name), std::move(description)};
  entry.make = [make](const TermOptions&, const TermContext& c) {
    return make(c.specification, c.evaluators);
  };
  entry.weight_key = "planner.weights." + key;
  entry.built_in = true;
  return entry;
}

TermEntry constraint(std::string name, std::string description,
                     Made (*make)(const Specification&, const Evaluators&)) {
  TermEntry entry = cost(std::move(name), "", std::move(description), make);
  entry.weight_key.clear();
  entry.constraint = true;
  return entry;
}

double one(const Specification::Weights&) { return 1.0; }

std::vector<BuiltinTerm> make_table() {
  std::vector<BuiltinTerm> all;
  all.push_back({cost("control_effort", "w_u", "deviation of the input from the desired one",
                      [](const Specification& s, const Evaluators&) -> Made {
                        return std::make_shared<ControlEffort>(s.desired_input,
                                                               s.robot.model->limits());
                      }),
                 [](const Specification::Weights& w) { return w.control_effort; }});
  all.push_back({cost("input_rate", "w_du", "change of the input from stage to stage",
                      [](const Specification& s, const Evaluators&) -> Made {
                        return std::make_shared<InputRate>(s.robot.model->limits());
                      }),
                 [](const Specification::Weights& w) { return w.input_rate; }});
  all.push_back({cost("obstacles", "w_o", "closeness to obstacles, from FCL distances",
                      [](const Specification& s, const Evaluators& e) -> Made {
                        return std::make_shared<ObstacleCost>(e.body, s.d_safe, s.d_des);
                      }),
                 [](const Specification::Weights& w) { return w.obstacles; }});
  all.push_back(
      {cost("visible_features", "w_l",
            "too few features predicted in view (count or information); with w_c also "
            "the chance of fewer than N_min",
            [](const Specification&, const Evaluators& e) -> Made { return e.visible_features; }),
       [](const Specification::Weights& w) { return w.visible_features; }});
  all.push_back({cost("exploration_gain", "w_e", "expected newly explored area (a reward)",
                      [](const Specification&, const Evaluators& e) -> Made { return e.gain; }),
                 [](const Specification::Weights& w) { return -w.exploration_gain; }});
  all.push_back({cost("cost_to_go", "w_T", "time to the viewpoints of the active frontiers",
                      [](const Specification& s, const Evaluators&) -> Made {
                        return std::make_shared<CostToGoTerm>(s.cost_to_go);
                      }),
                 [](const Specification::Weights& w) { return w.cost_to_go; }});
  all.push_back({cost("heading_alignment", "w_h", "heading away from where the cost-to-go falls",
                      [](const Specification& s, const Evaluators&) -> Made {
                        if (!(s.weights.heading_alignment > 0.0)) return nullptr;
                        return std::make_shared<HeadingAlignment>(s.cost_to_go);
                      }),
                 [](const Specification::Weights& w) { return w.heading_alignment; }});
  all.push_back(
      {constraint("clearance", "constraint: clearance of at least d_safe at nodes and mid-points",
                  [](const Specification& s, const Evaluators& e) -> Made {
                    return std::make_shared<ClearanceConstraint>(e.body, s.clearance);
                  }),
       one});
  all.push_back({constraint("braking", "constraint: able to stop inside known free space",
                            [](const Specification& s, const Evaluators& e) -> Made {
                              if (s.unknown == UnknownPolicy::kFree) return nullptr;
                              return unknown_space_constraint(s.unknown, e.known_body,
                                                              s.unknown_d_safe);
                            }),
                 one});
  all.push_back({constraint("rate_limit", "constraint: the model's limits on the change of inputs",
                            [](const Specification& s, const Evaluators&) -> Made {
                              const InputLimits& limits = s.robot.model->limits();
                              if (!limits.rate.array().isFinite().any()) return nullptr;
                              return std::make_shared<RateLimit>(limits, s.M);
                            }),
                 one});
  all.push_back(
      {constraint("speed_limit", "constraint: speed limits of models with velocity in the state",
                  [](const Specification& s, const Evaluators&) -> Made {
                    const MotionModel& model = *s.robot.model;
                    if (model.num_state_constraints() == 0) return nullptr;
                    return std::make_shared<SpeedLimit>(model);
                  }),
       one});
  return all;
}

// Once: a planner asks at every step.
const std::vector<BuiltinTerm>& table() {
  static const std::vector<BuiltinTerm> all = make_table();
  return all;
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
      terms.push_back({std::move(term), t.weight(context.specification.weights)});
    }
  }
  return terms;
}

std::optional<double> builtin_weight(std::string_view name,
                                     const ProblemSpecification::Weights& weights) {
  for (const BuiltinTerm& term : table()) {
    if (term.entry.name == name && !term.entry.constraint) return term.weight(weights);
  }
  return std::nullopt;
}

}  // namespace prospect
