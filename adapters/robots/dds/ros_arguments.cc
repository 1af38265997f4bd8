// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/ros_arguments.h"

#include <cstdlib>

#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

/// Both sides of "FROM:=TO".
std::pair<std::string, std::string> sides(const std::string& text, const std::string& option,
                                          const std::string& expected) {
  const std::size_t at = text.find(":=");
  if (at == std::string::npos || at == 0 || at + 2 == text.size()) {
    throw InputError(option + " " + text + ": no rule; expected " + expected);
  }
  return {text.substr(0, at), text.substr(at + 2)};
}

}  // namespace

RosArguments ros_arguments(const std::vector<std::string>& remap,
                           const std::vector<std::string>& parameters) {
  return {environment("ROS_DOMAIN_ID"), environment("CYCLONEDDS_URI"), remap, parameters};
}

NameRules::NameRules(const std::vector<std::string>& remap) {
  for (const std::string& text : remap) {
    const auto [from, to] = sides(text, "-r", "FROM:=TO, __ns:=/NAMESPACE or __node:=NAME");
    if (from == "__ns") {
      namespace_ = to;
    } else if (from == "__node" || from == "__name") {
      node_ = to;
    } else {
      rules_.push_back({from, to});
    }
  }
}

std::string NameRules::resolved(const std::string& name, const std::string& its_namespace,
                                const std::string& node) {
  if (name.starts_with("~/")) return its_namespace + "/" + node + name.substr(1);
  return name.starts_with("/") ? name : its_namespace + "/" + name;
}

std::string NameRules::remapped(const std::string& name, const std::string& its_namespace,
                                const std::string& node) {
  for (Rule& rule : rules_) {
    if (resolved(rule.from, its_namespace, node) != name) continue;
    rule.used = true;
    return resolved(rule.to, its_namespace, node);
  }
  return name;
}

std::vector<std::string> NameRules::unused() const {
  std::vector<std::string> lines;
  for (const Rule& rule : rules_) {
    if (!rule.used) {
      lines.push_back("-r " + rule.from + ":=" + rule.to +
                      ": no topic of that name is used; expected one of the file of topics");
    }
  }
  return lines;
}

std::vector<YamlSetting> settings_of(const RosArguments& arguments, const NameRules& names) {
  std::vector<YamlSetting> settings;
  const auto below = [&](const std::string& key, const std::string& variable,
                         const std::string& value) {
    if (value.empty()) return;
    settings.emplace_back(key + "=" + value, variable + " " + value);
    settings.back().unless_told = true;
  };
  below("domain", "ROS_DOMAIN_ID", arguments.domain_id);
  if (!names.its_namespace().empty()) {
    settings.emplace_back("namespace=" + yaml_text(names.its_namespace()),
                          "-r __ns:=" + names.its_namespace());
  }
  if (!names.node().empty()) {
    settings.emplace_back("node=" + yaml_text(names.node()), "-r __node:=" + names.node());
  }
  for (const std::string& text : arguments.parameters) {
    const auto [key, value] = sides(text, "-p", "use_sim_time:=true or false");
    if (key != "use_sim_time") {
      throw InputError("-p " + text + ": no such parameter; expected use_sim_time:=true or false");
    }
    settings.emplace_back(key + "=" + value, "-p " + text);
  }
  return settings;
}

}  // namespace prospect
