// SPDX-License-Identifier: Apache-2.0
// Reads a problem that a mission has met (`prospect explore --save-problems 10`) and tries a solver
// of your own choice on it.
#include <cstdio>
#include <exception>

#include "adapters/formats/problem_file/problem_file.h"
#include "solvers/registry.h"

int main(int count, char** arguments) try {
  if (count != 2) {
    std::fprintf(stderr, "usage: solve_file PROBLEM.h5\n");
    return 2;
  }
  const prospect::ReadProblem read = prospect::read_problem(arguments[1]);
  const prospect::Problem& problem = *read.problem;
  std::printf("step %d in %s: %d variables, %d constraints\n", read.saved.origin.step,
              read.saved.origin.world.c_str(), problem.num_variables(), problem.num_constraints());

  // The planner's best guess is where the solver starts.
  prospect::WarmStart start;
  if (!read.saved.seeds.empty()) start.x = read.saved.seeds.front().z;
  const auto solver = prospect::make_solver("nlopt:LD_SLSQP");
  const prospect::Result result =
      solver->solve(problem, start, {{"max_evaluations", 200}}, prospect::StopCondition());
  std::printf("%s: cost %.6f, violation %.1e, %d evaluations, %s\n", solver->name().c_str(),
              result.cost, result.violation, result.counters.cost_evaluations,
              to_string(result.quality).data());
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
