// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/loose_yaml.h"

#include <yaml-cpp/yaml.h>

#include <cmath>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"

namespace prospect {

struct LooseYaml::Node {
  YAML::Node yaml;
  std::string source;

  YAML::Node find(const std::string& key) const {
    return yaml.IsMap() ? yaml[key] : YAML::Node(YAML::NodeType::Undefined);
  }
  std::string at(const YAML::Node& node) const {
    return source + ":" + std::to_string(node.Mark().line + 1);
  }
  void collect(const YAML::Node& node, const std::string& key, int depth,
               std::vector<double>& out) const {
    if (node.IsSequence() && depth < 4) {
      for (const YAML::Node& item : node) collect(item, key, depth + 1, out);
      return;
    }
    double value = 0.0;
    if (!node.IsScalar() || !parse_number(node.Scalar(), value) || !std::isfinite(value)) {
      throw InputError(at(node) + ": " + key + " holds what is no number; expected numbers");
    }
    out.push_back(value);
  }
};

LooseYaml LooseYaml::from_text(std::string text, const std::string& source) {
  if (text.size() > (std::size_t{1} << 20)) {
    throw InputError(source + ": larger than 1 MB; expected a calibration");
  }
  if (text.starts_with("%")) text.insert(0, "#");
  auto node = std::make_shared<Node>();
  node->source = source;
  try {
    node->yaml = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(source + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg +
                     "; expected YAML");
  }
  if (!node->yaml.IsMap()) throw InputError(source + ": no mapping (key: value); expected one");
  return LooseYaml(std::move(node));
}

bool LooseYaml::has(const std::string& key) const { return node_->find(key).IsDefined(); }

std::string LooseYaml::first_of(const std::vector<std::string>& keys) const {
  for (const std::string& key : keys) {
    if (has(key)) return key;
  }
  return {};
}

LooseYaml LooseYaml::at(const std::string& key) const {
  const YAML::Node found = node_->find(key);
  if (!found.IsDefined()) {
    throw InputError(node_->at(node_->yaml) + ": " + key + " is missing; expected it");
  }
  if (!found.IsMap())
    throw InputError(node_->at(found) + ": " + key + " is no mapping; expected one");
  auto node = std::make_shared<Node>();
  node->yaml = found;
  node->source = node_->source;
  return LooseYaml(std::move(node));
}

std::vector<double> LooseYaml::numbers(const std::string& key, int size) const {
  YAML::Node found = node_->find(key);
  const std::string expected = size < 0 ? "a list of numbers" : std::to_string(size) + " numbers";
  if (!found.IsDefined()) {
    throw InputError(node_->source + ": " + key + " is missing; expected " + expected);
  }
  if (found.IsMap() && found["data"].IsDefined()) found.reset(found["data"]);
  if (!found.IsSequence()) {
    throw InputError(node_->at(found) + ": " + key + " is no list; expected " + expected);
  }
  std::vector<double> out;
  node_->collect(found, key, 0, out);
  if (size >= 0 && out.size() != static_cast<std::size_t>(size)) {
    throw InputError(node_->at(found) + ": " + key + " has " + std::to_string(out.size()) +
                     " numbers; expected " + std::to_string(size));
  }
  return out;
}

double LooseYaml::number(const std::string& key) const {
  const YAML::Node found = node_->find(key);
  double value = 0.0;
  if (!found.IsDefined()) throw InputError(node_->source + ": " + key + " is missing; expected it");
  if (!found.IsScalar() || !parse_number(found.Scalar(), value) || !std::isfinite(value)) {
    throw InputError(node_->at(found) + ": " + key + " is no number; expected one");
  }
  return value;
}

std::string LooseYaml::text(const std::string& key, const std::string& default_value) const {
  const YAML::Node found = node_->find(key);
  return found.IsDefined() && found.IsScalar() ? found.Scalar() : default_value;
}

std::string LooseYaml::where(const std::string& key) const {
  const YAML::Node found = node_->find(key);
  return found.IsDefined() ? node_->at(found) : node_->source;
}

}  // namespace prospect
