// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/term_settings.h"

#include <exception>
#include <memory>

#include "engine/planner/set_term.h"

namespace prospect {
namespace {

/// "w_T" of "planner.weights.w_T".
std::string key_of(const std::string& path) { return path.substr(path.rfind('.') + 1); }

}  // namespace

std::vector<std::string> read_terms(YamlMap planner, const TermRegistry& registry,
                                    PlannerParameters& parameters) {
  std::vector<std::string> replaced;
  YamlMap terms =
      planner.free_map("terms", "by name, with weight and options, see `prospect list terms`");
  YamlMap weights = planner.map("weights");
  for (const std::string& name : terms.keys()) {
    YamlMap settings = terms.map(name);
    std::shared_ptr<const TermEntry> entry;
    try {
      entry = registry.find(name);
    } catch (const std::exception& e) {
      terms.problem(name, e.what());
      settings.leave_rest();
      continue;
    }
    const std::size_t problems = settings.problem_count();
    const double most = entry->constraint ? 1.0 : TermEntry::kMostWeight;
    // Without it the weight of a built-in term would be said in two places.
    const double weight =
        entry->built_in ? settings.required_number("weight", 0.0, most, "1", entry->description)
                        : settings.number("weight", 1.0, 0.0, most, "1", entry->description);
    TermOptions options;
    for (const TermOption& o : entry->options) {
      options[o.name] = settings.number(o.name, o.fallback, o.least, o.most, o.unit, o.description);
    }
    if (!entry->weight_key.empty() && weights.has(key_of(entry->weight_key))) {
      settings.problem("weight", entry->weight_key + " and planner.terms." + name +
                                     ".weight are both set; expected one of them");
    }
    if (settings.problem_count() != problems) continue;
    try {
      set_term(parameters, registry.use(name, weight, options));
    } catch (const std::exception& e) {
      settings.problem("weight", e.what());
    }
    if (!entry->weight_key.empty()) replaced.push_back(entry->weight_key);
  }
  return replaced;
}

}  // namespace prospect
