// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/problem/problem_registry.h"
#include "engine/problem/term_registry.h"
#include "engine/terms/builtin_terms.h"
#include "runtime/user_robot.h"
#include "solvers/registry.h"

namespace prospect {

/// A robot that a plug-in, or the program itself, brings.
struct OfferedRobot {
  std::string file;  ///< of the plug-in; "": the program
  std::string description;
  UserRobot robot;
};

/// What a configuration, a problem file and the command line can name: the built-in back ends and
/// terms, and what plug-ins add. The keys of `base` are the options of the robots.
struct Registries {
  SolverRegistry solvers;
  TermRegistry terms = builtin_terms();
  ProblemRegistry problems;  ///< of plug-ins alone
  std::vector<OfferedRobot> robots;

  Registries() = default;
  Registries(SolverRegistry registry) : solvers(std::move(registry)) {}
};

}  // namespace prospect
