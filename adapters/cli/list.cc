#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "adapters/bench/problem_set.h"
#include "adapters/cli/commands.h"
#include "adapters/config/configuration.h"
#include "adapters/config/input_error.h"
#include "adapters/run/csv.h"
#include "adapters/worlds/builtin_worlds.h"
#include "engine/behaviour/behaviour.h"
#include "models/nearest_name.h"
#include "solvers/options.h"

namespace prospect {
namespace {

/// "w_T" of a built-in cost, "" of any other term.
std::string short_key(const TermEntry& entry) {
  const std::string& key = entry.weight_key;
  return key.empty() ? "" : key.substr(key.rfind('.') + 1);
}

/// "radius=0.5 [m], 0.05 to 10: the distance at which ..."
std::string in_words(const TermOption& o) {
  return o.name + "=" + csv::text(o.fallback) + " [" + o.unit + "], " + csv::text(o.least) +
         " to " + csv::text(o.most) + ": " + o.description;
}

nlohmann::ordered_json to_json(const TermEntry& entry) {
  nlohmann::ordered_json options = nlohmann::ordered_json::array();
  for (const TermOption& o : entry.options) {
    options.push_back({{"name", o.name},
                       {"default", o.fallback},
                       {"least", o.least},
                       {"most", o.most},
                       {"unit", o.unit},
                       {"description", o.description}});
  }
  return {{"name", entry.name},
          {"weight", short_key(entry)},
          {"description", entry.description},
          {"built_in", entry.built_in},
          {"version", entry.version},
          {"options", options}};
}

}  // namespace

int list(const std::string& what, bool json, const Registries& registries) {
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
    for (const SolverInfo& s : registries.solvers.list()) {
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
    for (const std::string& name : registries.problems.sets()) {
      const std::string& words = registries.problems.problems(name).front().set_description;
      out.push_back({{"name", name}, {"description", words}});
      if (!json) std::printf("%-12s %s\n", name.c_str(), words.c_str());
    }
  } else {
    for (const auto& t : registries.terms.list()) {
      out.push_back(to_json(*t));
      if (json) continue;
      std::printf("%-26s %-6s %s\n", t->name.c_str(), short_key(*t).c_str(),
                  t->description.c_str());
      for (const TermOption& o : t->options) std::printf("    %s\n", in_words(o).c_str());
    }
  }
  if (json) std::cout << out.dump(2) << '\n';
  return kDone;
}

int print_configuration(const std::string& file, const std::vector<std::string>& settings,
                        const Registries& registries) {
  std::cout << effective_yaml(read_configuration(file, registries, settings).entries);
  return kDone;
}

}  // namespace prospect
