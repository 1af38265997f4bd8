// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/set_term.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "engine/terms/builtin_terms.h"

namespace prospect {

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
  if (double* weight = weight_of(name, parameters.weights)) *weight = use.weight;
  std::erase(parameters.terms_left_out, name);
  if (use.weight == 0.0) parameters.terms_left_out.push_back(name);
}

}  // namespace prospect
