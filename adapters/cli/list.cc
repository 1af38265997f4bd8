#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "adapters/bench/problem_set.h"
#include "adapters/cli/commands.h"
#include "adapters/config/configuration.h"
#include "adapters/worlds/builtin_worlds.h"
#include "engine/behaviour/behaviour.h"
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

/// Names, several a line, under a heading.
void print_names(const std::string& heading, const std::vector<std::string>& names) {
  constexpr std::size_t kColumns = 100;
  std::string text = heading + "\n ";
  std::size_t column = 1;
  for (const std::string& name : names) {
    if (column + 1 + name.size() > kColumns) {
      text += "\n ";
      column = 1;
    }
    text += ' ' + name;
    column += 1 + name.size();
  }
  std::printf("%s\n", text.c_str());
}

nlohmann::ordered_json as_json(const std::string& what, const SolverRegistry& registry) {
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
    }
  } else if (what == "worlds") {
    for (const std::string& name : builtin_world_names()) {
      out.push_back({{"name", name}, {"description", builtin_world_summary(name)}});
    }
  } else if (what == "modes") {
    for (const ModeRow& row : mode_table()) {
      out.push_back({{"from", row.from ? to_string(*row.from) : "any"},
                     {"condition", row.condition},
                     {"to", to_string(row.to)},
                     {"cause", row.cause ? to_string(*row.cause) : "as before"}});
    }
  } else if (what == "sets") {
    for (const std::string& name : builtin_set_names()) {
      out.push_back({{"name", name}, {"description", builtin_set_summary(name)}});
    }
  } else {
    for (const TermInfo& t : kTerms) {
      out.push_back({{"name", t.name}, {"weight", t.weight}, {"description", t.description}});
    }
  }
  return out;
}

void print_in_full(const std::string& what, const nlohmann::ordered_json& entries) {
  if (what == "modes") {
    std::cout << behaviour_tables();
    return;
  }
  const int width = what == "solvers" ? 34 : what == "terms" ? 26 : 12;
  for (const auto& entry : entries) {
    const auto text = [&](const char* key) { return entry.at(key).get<std::string>(); };
    std::printf("%-*s ", width, text("name").c_str());
    if (what == "terms") std::printf("%-6s ", text("weight").c_str());
    std::printf("%s", text("description").c_str());
    if (what == "solvers" && !entry.at("available").get<bool>()) {
      std::printf(" [not built in: needs %s]", text("needs").c_str());
    }
    std::printf("\n");
  }
}

/// Each once; of modes those that the table leads to.
std::vector<std::string> names_of(const std::string& what, const nlohmann::ordered_json& entries) {
  std::vector<std::string> names;
  for (const auto& entry : entries) {
    const auto name = entry.at(what == "modes" ? "to" : "name").get<std::string>();
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

}  // namespace

std::vector<std::string> list_kinds() { return {"solvers", "worlds", "terms", "sets", "modes"}; }

int list(const std::string& what, bool json, const SolverRegistry& registry) {
  if (!what.empty()) {
    const nlohmann::ordered_json entries = as_json(what, registry);
    if (json) {
      std::cout << entries.dump(2) << '\n';
    } else {
      print_in_full(what, entries);
    }
    return kDone;
  }
  nlohmann::ordered_json all;
  for (const std::string& kind : list_kinds()) all[kind] = as_json(kind, registry);
  if (json) {
    std::cout << all.dump(2) << '\n';
    return kDone;
  }
  for (const std::string& kind : list_kinds()) print_names(kind, names_of(kind, all.at(kind)));
  std::printf("In full: prospect list %s\n", "solvers|worlds|terms|sets|modes");
  return kDone;
}

int print_configuration(const std::string& file, const std::vector<std::string>& settings,
                        const SolverRegistry& registry) {
  std::cout << effective_yaml(read_configuration(file, registry, settings).entries);
  return kDone;
}

}  // namespace prospect
