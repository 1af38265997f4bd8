// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace prospect {

/// A reader of YAML that other programs write, as cameras' calibrations: what is not asked for is
/// passed over. Numbers may lie in lists of lists, or under `data` of a matrix. Throws InputError,
/// `file:line: what; expected what`. Files are at most 1 MB. Views share the document.
class LooseYaml {
 public:
  /// OpenCV's first line `%YAML:1.0`, which is not YAML, is passed over.
  static LooseYaml from_text(std::string text, const std::string& source);

  bool has(const std::string& key) const;
  /// The first of the keys that is there, "" if none is.
  std::string first_of(const std::vector<std::string>& keys) const;
  /// The mapping under a key.
  LooseYaml at(const std::string& key) const;
  /// All finite numbers under a key, in order; `size` of them unless it is negative.
  std::vector<double> numbers(const std::string& key, int size = -1) const;
  double number(const std::string& key) const;
  std::string text(const std::string& key, const std::string& default_value) const;
  std::string where(const std::string& key) const;

 private:
  struct Node;
  explicit LooseYaml(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
  std::shared_ptr<const Node> node_;
};

}  // namespace prospect
