// SPDX-License-Identifier: Apache-2.0
// Reads a configuration and prints what is in effect, linked against prospect::config alone: who
// reads YAML needs no renderer, no reader of meshes and no odometry.
#include <exception>
#include <iostream>

#include "adapters/missions/config/configuration.h"

int main(int argc, char** argv) {
  try {
    const prospect::Configuration c =
        prospect::read_configuration(argc > 1 ? argv[1] : "", prospect::SolverRegistry());
    std::cout << prospect::effective_yaml(c.entries);
    return c.planner.N == 20 ? 0 : 1;
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 2;
  }
}
