#include "engine/planner/set_term.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace prospect {
namespace {

constexpr std::array<std::pair<std::string_view, double PlannerParameters::*>, 7> kWeights = {{
    {"control_effort", &PlannerParameters::w_u},
    {"input_rate", &PlannerParameters::w_du},
    {"obstacles", &PlannerParameters::w_o},
    {"visible_features", &PlannerParameters::w_l},
    {"exploration_gain", &PlannerParameters::w_e},
    {"cost_to_go", &PlannerParameters::w_T},
    {"heading_alignment", &PlannerParameters::w_h},
}};

}  // namespace

void set_term(PlannerParameters& parameters, const TermUse& use) {
  if (!use.entry) throw std::invalid_argument("planner: a term without an entry; expected one");
  const std::string& name = use.entry->name;
  if (!use.entry->built_in) {
    for (const TermUse& other : parameters.terms) {
      if (other.entry->name == name) {
        throw std::invalid_argument("planner: term '" + name + "' twice; expected it once");
      }
    }
    if (use.weight != 0.0) parameters.terms.push_back(use);
    return;
  }
  for (const auto& [term, weight] : kWeights) {
    if (term == name) parameters.*weight = use.weight;
  }
  std::erase(parameters.terms_left_out, name);
  if (use.weight == 0.0) parameters.terms_left_out.push_back(name);
}

}  // namespace prospect
