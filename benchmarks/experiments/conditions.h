#pragma once

#include <string>
#include <vector>

namespace prospect {

/// One way to run a mission: an overlay on the default configuration, and a planner.
struct Condition {
  std::string name;
  std::string overlay;          ///< YAML, as a configuration file: what differs from the defaults
  std::string reference;        ///< the condition it is compared with; "" for a reference itself
  std::string planner = "mpc";  ///< one of replanner_names()
};

/// All conditions of the experiments: another is another line of the table in the source.
const std::vector<Condition>& conditions();

/// Throws InputError for an unknown name, with those known.
const Condition& condition(const std::string& name);

}  // namespace prospect
