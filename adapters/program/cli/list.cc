// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/builtin_worlds.h"
#include "adapters/missions/bench/problem_set.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/configuration_reference.h"
#include "adapters/program/cli/adapter_table.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/robots/dds/dds_links.h"
#include "engine/behaviour/behaviour.h"
#include "models/range_text.h"
#include "runtime/drive_mode.h"
#include "runtime/link.h"
#include "solvers/options.h"

namespace prospect {
namespace {

/// "w_T" of a built-in cost, "" of any other term.
std::string short_key(const TermEntry& entry) {
  const std::string& key = entry.weight_key;
  return key.empty() ? "" : key.substr(key.rfind('.') + 1);
}

/// "radius=0.5 [m], 0.05 to 10: the distance at which ..."
std::string in_words(const nlohmann::ordered_json& option) {
  const auto text = [&](const char* key) { return option.at(key).get<std::string>(); };
  const auto number = [&](const char* key) { return exact_text(option.at(key).get<double>()); };
  return text("name") + "=" + number("default") + " [" + text("unit") + "], " + number("least") +
         " to " + number("most") + ": " + text("description");
}

/// "base.rate=115200: of the line [baud]"
std::string key_in_words(const nlohmann::ordered_json& option) {
  const auto text = [&](const char* key) { return option.at(key).get<std::string>(); };
  return "base." + text("name") + "=" + text("default") + ": " + text("description");
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

nlohmann::ordered_json to_json(const Link& link) {
  const auto number = [](const std::optional<double>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
  };
  const auto cause = [](const std::optional<DriveCause>& value) {
    return value ? nlohmann::ordered_json(to_string(*value)) : nlohmann::ordered_json();
  };
  return {{"signal", link.signal},
          {"topic", link.topic},
          {"least_publishers", link.least},
          {"most_publishers",
           link.most == 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(link.most)},
          {"silence", number(link.heartbeat)},
          {"age", number(link.age)},
          {"frame", link.frame},
          {"values", link.values},
          {"absent", cause(link.absent)},
          {"too_many", cause(link.doubled)},
          {"wrong", cause(link.wrong)}};
}

nlohmann::ordered_json to_json(const OfferedRobot& offered) {
  nlohmann::ordered_json options = nlohmann::ordered_json::array();
  for (const OptionInfo& o : offered.robot.options) {
    options.push_back(
        {{"name", o.name}, {"default", describe(o.fallback)}, {"description", o.description}});
  }
  return {{"name", offered.robot.name},
          {"description", offered.description},
          {"file", offered.file},
          {"options", options}};
}

/// What drives: the built-in ones, and those of plug-ins.
nlohmann::ordered_json bases(const Registries& registries) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const auto& [name, description] :
       {std::pair{"simulator", "the simulator as a robot with a clock"},
        std::pair{"gazebo", "the robot of the Gazebo that runs"},
        std::pair{"dds", "a robot behind topics of ROS 2"}}) {
    out.push_back({{"name", name},
                   {"description", description},
                   {"file", ""},
                   {"options", nlohmann::ordered_json::array()}});
  }
  for (const OfferedRobot& offered : registries.robots) out.push_back(to_json(offered));
  return out;
}

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

nlohmann::ordered_json as_json(const std::string& what, const DdsOptions& topics,
                               const Registries& registries) {
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
  } else if (what == "drive-modes") {
    for (const DriveModeRow& row : drive_mode_table()) {
      out.push_back({{"from", to_string(row.from)},
                     {"condition", row.condition},
                     {"to", to_string(row.to)},
                     {"cause", row.cause ? to_string(*row.cause) : "as before"}});
    }
  } else if (what == "links") {
    for (const Link& link : dds_links(topics)) out.push_back(to_json(link));
  } else if (what == "adapters") {
    for (const Adapter& a : adapters()) {
      const std::string lacking = lacks(a);
      out.push_back({{"name", a.name},
                     {"available", lacking.empty()},
                     {"needs", lacking.empty() ? std::string(a.needs) : lacking},
                     {"description", a.description}});
    }
  } else if (what == "bases") {
    out = bases(registries);
  } else if (what == "sets") {
    for (const std::string& name : builtin_set_names()) {
      out.push_back({{"name", name}, {"description", builtin_set_summary(name)}});
    }
    for (const std::string& name : registries.problems.sets()) {
      const std::string& words = registries.problems.problems(name).front().set_description;
      out.push_back({{"name", name}, {"description", words}});
    }
  } else {
    for (const auto& t : registries.terms.list()) {
      out.push_back(to_json(*t));
    }
  }
  return out;
}

void print_in_full(const std::string& what, const DdsOptions& topics,
                   const nlohmann::ordered_json& entries) {
  if (what == "modes") {
    std::cout << behaviour_tables();
    return;
  }
  if (what == "drive-modes") {
    std::cout << drive_mode_tables();
    return;
  }
  if (what == "links") {
    std::cout << link_table(dds_links(topics));
    return;
  }
  const int width = what == "solvers" ? 34 : what == "terms" ? 26 : 12;
  for (const auto& entry : entries) {
    const auto text = [&](const char* key) { return entry.at(key).get<std::string>(); };
    std::printf("%-*s ", width, text("name").c_str());
    if (what == "terms") std::printf("%-6s ", text("weight").c_str());
    std::printf("%s", text("description").c_str());
    if (entry.contains("available") && !entry.at("available").get<bool>()) {
      std::printf(" [not built in: needs %s]", text("needs").c_str());
    }
    std::printf("\n");
    if (what != "terms" && what != "bases") continue;
    for (const auto& option : entry.at("options")) {
      std::printf("    %s\n", (what == "terms" ? in_words(option) : key_in_words(option)).c_str());
    }
  }
}

/// Each once; of modes those that the table leads to.
std::vector<std::string> names_of(const std::string& what, const nlohmann::ordered_json& entries) {
  std::vector<std::string> names;
  for (const auto& entry : entries) {
    const bool table = what == "modes" || what == "drive-modes";
    const char* key = table ? "to" : what == "links" ? "signal" : "name";
    const auto name = entry.at(key).get<std::string>();
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::vector<std::string> list_kinds() {
  return {"solvers",     "worlds", "terms", "sets",    "modes",
          "drive-modes", "links",  "bases", "adapters"};
}

struct ListArguments {
  std::string what;  ///< one of list_kinds(), in full; "": all of them, in short unless `json`
  std::string ros;   ///< file of topics, of "links"; "": the defaults
  bool json = false;
};

int list(const ListArguments& arguments, const Registries& registries) {
  const std::string& what = arguments.what;
  const bool json = arguments.json;
  if (!arguments.ros.empty() && what != "links") {
    throw InputError("--ros: given with '" + what + "'; expected it with links");
  }
  const DdsOptions topics =
      arguments.ros.empty() ? DdsOptions() : read_dds_options(arguments.ros, ros_arguments());
  if (!what.empty()) {
    const nlohmann::ordered_json entries = as_json(what, topics, registries);
    if (json) {
      std::cout << entries.dump(2) << '\n';
    } else {
      print_in_full(what, topics, entries);
    }
    return kDone;
  }
  nlohmann::ordered_json all;
  for (const std::string& kind : list_kinds()) all[kind] = as_json(kind, topics, registries);
  if (json) {
    std::cout << all.dump(2) << '\n';
    return kDone;
  }
  for (const std::string& kind : list_kinds()) print_names(kind, names_of(kind, all.at(kind)));
  std::printf("In full: prospect list %s\n",
              "solvers|worlds|terms|sets|modes|drive-modes|links|bases|adapters");
  return kDone;
}

}  // namespace

Command list_command(CLI::App& program) {
  const auto given = std::make_shared<ListArguments>();
  CLI::App* command = program.add_subcommand(
      "list",
      "What there is: solvers, worlds, terms, sets, modes, drive-modes, links, bases or adapters");
  one_of(command->add_option("what", given->what, "Which of them, in full [all, in short]"),
         list_kinds());
  command
      ->add_option(
          "--ros", given->ros,
          "With links: those of the robot with these topics (YAML) [those of the defaults]")
      ->type_name("FILE");
  command->add_flag("--json", given->json, "Print JSON");
  return {command, [given](const Invocation& in) { return list(*given, in.registries); }};
}

}  // namespace prospect
