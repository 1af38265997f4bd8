// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/problem/solver.h"

namespace prospect {

/// max_evaluations, tolerance, feasibility_tolerance, seed, trace: see CommonOptions.
std::vector<OptionInfo> common_options();
/// "threads", for back ends that evaluate batches.
OptionInfo threads_option();

/// The options of one solve: every known one with its value, given or fallback.
///
/// Strict: an unknown name, a value of the wrong type, a non-finite number or a common option out
/// of its range is an error in one sentence that names the nearest valid name. An int given for a
/// number is promoted; a number is never cut to an int.
class OptionSet {
 public:
  OptionSet(const std::vector<OptionInfo>& known, const Options& given);

  /// Empty, or what is wrong with the options given.
  const std::string& error() const { return error_; }

  /// The value of a known option of that type; anything else is a mistake of the caller and throws
  /// std::logic_error.
  double number(const std::string& name) const;
  int integer(const std::string& name) const;
  const std::string& text(const std::string& name) const;
  CommonOptions common() const;
  /// The value of a known option, whatever its type.
  const OptionValue& value(const std::string& name) const { return values_.at(name); }
  /// Whether it was given, not left at its fallback.
  bool is_given(const std::string& name) const { return given_.contains(name); }

  /// Records an error for an option out of range; the first one stands.
  void require(bool condition, const std::string& message);
  /// The same for the value of one: "option 'name' is VALUE; expected ...".
  void require_value(const std::string& name, bool good, const std::string& expected);

 private:
  std::map<std::string, OptionValue> values_;
  std::set<std::string> given_;
  std::string error_;
};

/// "1e-06" for numbers, quoted text: as messages print it.
std::string describe(const OptionValue& value);

}  // namespace prospect
