// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/strict_yaml.h"

namespace prospect {

/// What users of ROS 2 tell a node beside its own file: the environment, and arguments behind
/// --ros-args. Arguments stand above the file, the environment below it.
struct RosArguments {
  std::string domain_id;                ///< ROS_DOMAIN_ID; "": not set
  std::string cyclonedds_uri;           ///< CYCLONEDDS_URI; likewise
  std::vector<std::string> remap;       ///< of -r: "FROM:=TO", "__ns:=/robot", "__node:=name"
  std::vector<std::string> parameters;  ///< of -p: "use_sim_time:=true"
};

/// With what the environment of this process says.
RosArguments ros_arguments(const std::vector<std::string>& remap = {},
                           const std::vector<std::string>& parameters = {});

/// Names of topics by rules, the first that fits, as ROS 2 resolves them: "cmd_vel" is of the
/// node's namespace, "~/map" of the node itself.
class NameRules {
 public:
  /// Takes the rules of topics; throws InputError, one line, for what is no rule.
  explicit NameRules(const std::vector<std::string>& remap);

  /// Of "__ns" and "__node"; "": no rule.
  const std::string& its_namespace() const { return namespace_; }
  const std::string& node() const { return node_; }

  /// A name in full: of a namespace ("" or "/robot") where it does not begin with a slash.
  static std::string resolved(const std::string& name, const std::string& its_namespace,
                              const std::string& node);
  /// What is to be used instead of a name in full.
  std::string remapped(const std::string& name, const std::string& its_namespace,
                       const std::string& node);
  /// A line for each rule that has fitted nothing.
  std::vector<std::string> unused() const;

 private:
  struct Rule {
    std::string from, to;
    bool used = false;
  };
  std::vector<Rule> rules_;
  std::string namespace_, node_;
};

/// The arguments as settings of the file of topics. Throws InputError, one line.
std::vector<YamlSetting> settings_of(const RosArguments& arguments, const NameRules& names);

}  // namespace prospect
