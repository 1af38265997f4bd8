// SPDX-License-Identifier: Apache-2.0
// The term as a plug-in, and a problem to measure back ends on:
//   prospect list terms --plugin build/user_term/libkeep_distance.so
//   prospect explore office --plugin build/user_term/libkeep_distance.so
//     --set planner.terms.keep_distance='{weight: 2, x: 3, y: 2, radius: 0.8}'
//   prospect bench person --plugin build/user_term/libkeep_distance.so
#include "solvers/plugin.h"

#include <iterator>

#include "keep_distance_problem.h"

const prospect::Plugin* prospect_plugin() {
  static const prospect::PluginTerm terms[] = {
      {"keep_distance", "closeness to a point, such as a person", 1, kKeepDistanceOptions,
       std::size(kKeepDistanceOptions), &make_keep_distance}};
  static const prospect::PluginProblem problems[] = {
      {"person", "driving ahead past a person on the way", "straight ahead", &past_a_person,
       &straight_ahead}};  // the best cost is not known
  static const prospect::Plugin plugin = {.interface_version = prospect::kPluginInterface,
                                          .abi = prospect::kPluginAbi,
                                          .terms = terms,
                                          .num_terms = std::size(terms),
                                          .problems = problems,
                                          .num_problems = std::size(problems)};
  return &plugin;
}
