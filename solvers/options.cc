// SPDX-License-Identifier: Apache-2.0
#include "solvers/options.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "models/nearest_name.h"

namespace prospect {
namespace {

std::string_view type_name(const OptionValue& value) {
  if (std::holds_alternative<double>(value)) return "a number";
  return std::holds_alternative<int>(value) ? "an integer" : "a text";
}

}  // namespace

std::vector<OptionInfo> common_options() {
  const CommonOptions fallback;
  return {
      {"max_evaluations", fallback.max_evaluations,
       "cost evaluations, gradients included, 1 or more"},
      {"tolerance", fallback.tolerance,
       "relative change of cost that counts as converged, 0 to 1 [-]"},
      {"feasibility_tolerance", fallback.feasibility_tolerance,
       "largest violation of a constraint that counts as feasible, above 0 [unit of constraint]"},
      {"seed", static_cast<int>(fallback.seed), "of the random numbers, 0 or more"},
      {"trace", static_cast<int>(fallback.trace),
       "1: keep every improvement of the incumbent with its time, 0 or 1"},
  };
}

OptionInfo threads_option() {
  return {"threads", CommonOptions().threads,
          "that share the evaluations, with the same results for any number, 1 to 256"};
}

std::string describe(const OptionValue& value) {
  std::ostringstream out;
  if (const double* number = std::get_if<double>(&value)) {
    out << *number;
  } else if (const int* integer = std::get_if<int>(&value)) {
    out << *integer;
  } else {
    out << '\'' << std::get<std::string>(value) << '\'';
  }
  return out.str();
}

OptionSet::OptionSet(const std::vector<OptionInfo>& known, const Options& given) {
  std::vector<std::string> names;
  for (const OptionInfo& info : known) {
    values_[info.name] = info.fallback;
    names.push_back(info.name);
  }
  for (const auto& [name, value] : given) {
    const auto found = values_.find(name);
    if (found == values_.end()) {
      require(false,
              "unknown option '" + name + "'" + did_you_mean(name, names) + expected_one_of(names));
      continue;
    }
    given_.insert(name);
    OptionValue& target = found->second;
    const int* integer = std::get_if<int>(&value);
    if (integer && std::holds_alternative<double>(target)) {
      target = static_cast<double>(*integer);
    } else if (value.index() == target.index()) {
      const double* number = std::get_if<double>(&value);
      require(!number || std::isfinite(*number),
              "option '" + name + "' is " + describe(value) + "; expected a finite number");
      target = value;
    } else {
      require(false, "option '" + name + "' is " + std::string(type_name(value)) + ", " +
                         describe(value) + "; expected " + std::string(type_name(target)));
    }
  }
  if (!values_.contains("max_evaluations")) return;
  require_value("max_evaluations", integer("max_evaluations") >= 1, "1 or more");
  require_value("tolerance", number("tolerance") >= 0.0 && number("tolerance") <= 1.0, "0 to 1");
  require_value("feasibility_tolerance", number("feasibility_tolerance") > 0.0, "a number above 0");
  require_value("seed", integer("seed") >= 0, "0 or more");
  require_value("trace", integer("trace") == 0 || integer("trace") == 1, "0 or 1");
  if (values_.contains("threads")) {
    require_value("threads", integer("threads") >= 1 && integer("threads") <= 256, "1 to 256");
  }
}

void OptionSet::require(bool condition, const std::string& message) {
  if (!condition && error_.empty()) error_ = message;
}

void OptionSet::require_value(const std::string& name, bool good, const std::string& expected) {
  require(good, "option '" + name + "' is " + describe(value(name)) + "; expected " + expected);
}

double OptionSet::number(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end() || !std::holds_alternative<double>(found->second)) {
    throw std::logic_error("no option of type number: " + name);
  }
  return std::get<double>(found->second);
}

int OptionSet::integer(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end() || !std::holds_alternative<int>(found->second)) {
    throw std::logic_error("no option of type integer: " + name);
  }
  return std::get<int>(found->second);
}

const std::string& OptionSet::text(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end() || !std::holds_alternative<std::string>(found->second)) {
    throw std::logic_error("no option of type text: " + name);
  }
  return std::get<std::string>(found->second);
}

CommonOptions OptionSet::common() const {
  return {integer("max_evaluations"),      number("tolerance"),
          number("feasibility_tolerance"), static_cast<std::uint64_t>(integer("seed")),
          integer("trace") == 1,           values_.contains("threads") ? integer("threads") : 1};
}

}  // namespace prospect
