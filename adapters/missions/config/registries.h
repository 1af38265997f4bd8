#pragma once

#include <string>
#include <utility>

#include "engine/problem/problem_registry.h"
#include "engine/problem/term_registry.h"
#include "engine/terms/builtin_terms.h"
#include "solvers/registry.h"

namespace prospect {

/// What a configuration, a problem file and the command line can name: the built-in back ends and
/// terms, and what plug-ins add.
struct Registries {
  SolverRegistry solvers;
  TermRegistry terms = builtin_terms();
  ProblemRegistry problems;  ///< of plug-ins alone

  Registries() = default;
  Registries(SolverRegistry registry) : solvers(std::move(registry)) {}
};

}  // namespace prospect
