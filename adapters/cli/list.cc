#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "adapters/bench/problem_set.h"
#include "adapters/cli/commands.h"
#include "adapters/config/configuration.h"
#include "adapters/config/configuration_reference.h"
#include "adapters/config/input_error.h"
#include "adapters/worlds/builtin_worlds.h"
#include "engine/behaviour/behaviour.h"
#include "models/nearest_name.h"
#include "solvers/options.h"

namespace prospect {
namespace {

/// The terms of the planner's problem, as formulation.md defines them.
struct TermInfo {
  const char* name;
  const char* weight;
  const char* description;
};
constexpr TermInfo kTerms[] = {
    {"control_effort", "w_u", "deviation of the input from the desired one"},
    {"input_rate", "w_du", "change of the input from stage to stage"},
    {"obstacles", "w_o", "closeness to obstacles, from FCL distances"},
    {"visible_features", "w_l",
     "too few features predicted in view (count or information); with w_c also the chance of fewer "
     "than N_min"},
    {"exploration_gain", "w_e", "expected newly explored area (a reward)"},
    {"cost_to_go", "w_T", "time to the viewpoints of the active frontiers"},
    {"heading_alignment", "w_h", "heading away from where the cost-to-go falls"},
    {"clearance", "", "constraint: clearance of at least d_safe at nodes and mid-points"},
    {"braking", "", "constraint: able to stop inside known free space"},
    {"rate_limit", "", "constraint: the model's limits on the change of inputs"},
    {"speed_limit", "", "constraint: speed limits of models with velocity in the state"},
};

}  // namespace

int list(const std::string& what, bool json, const SolverRegistry& registry) {
  const std::vector<std::string> known = {"solvers", "worlds", "terms", "sets", "modes"};
  if (what.empty()) {
    throw InputError("list: nothing named; expected one of: solvers, worlds, terms, sets, modes");
  }
  if (std::find(known.begin(), known.end(), what) == known.end()) {
    throw InputError("list: unknown '" + what + "'" + did_you_mean(what, known) +
                     "; expected one of: solvers, worlds, terms, sets, modes");
  }
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  if (what == "solvers") {
    for (const SolverInfo& s : registry.list()) {
      nlohmann::ordered_json options = nlohmann::ordered_json::array();
      for (const OptionInfo& o : s.options) {
        options.push_back(
            {{"name", o.name}, {"default", describe(o.fallback)}, {"description", o.description}});
      }
      out.push_back({{"name", s.name},
                     {"available", s.available},
                     {"needs", s.needs},
                     {"description", s.description},
                     {"options", options}});
      if (json) continue;
      std::printf("%-34s %s%s\n", s.name.c_str(), s.description.c_str(),
                  s.available ? "" : (" [not built in: needs " + s.needs + "]").c_str());
    }
  } else if (what == "worlds") {
    for (const std::string& name : builtin_world_names()) {
      out.push_back({{"name", name}, {"description", builtin_world_summary(name)}});
      if (!json) std::printf("%-12s %s\n", name.c_str(), builtin_world_summary(name).c_str());
    }
  } else if (what == "modes") {
    for (const ModeRow& row : mode_table()) {
      out.push_back({{"from", row.from ? to_string(*row.from) : "any"},
                     {"condition", row.condition},
                     {"to", to_string(row.to)},
                     {"cause", row.cause ? to_string(*row.cause) : "as before"}});
    }
    if (!json) std::cout << behaviour_tables();
  } else if (what == "sets") {
    for (const std::string& name : builtin_set_names()) {
      out.push_back({{"name", name}, {"description", builtin_set_summary(name)}});
      if (!json) std::printf("%-12s %s\n", name.c_str(), builtin_set_summary(name).c_str());
    }
  } else {
    for (const TermInfo& t : kTerms) {
      out.push_back({{"name", t.name}, {"weight", t.weight}, {"description", t.description}});
      if (!json) std::printf("%-26s %-6s %s\n", t.name, t.weight, t.description);
    }
  }
  if (json) std::cout << out.dump(2) << '\n';
  return kDone;
}

int print_reference(const std::string& file, const std::vector<std::string>& settings) {
  if (!file.empty() || !settings.empty()) {
    throw InputError("--reference: '" + (file.empty() ? "--set " + settings.front() : file) +
                     "' beside it; expected it alone, as it is of no configuration");
  }
  std::cout << configuration_reference();
  return kDone;
}

int print_configuration(const std::string& file, const std::vector<std::string>& settings,
                        const SolverRegistry& registry) {
  std::cout << effective_yaml(read_configuration(file, registry, settings).entries);
  return kDone;
}

}  // namespace prospect
