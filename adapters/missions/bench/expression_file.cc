// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/expression_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/bench/stated_problem.h"
#include "problems/stated_programme.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;
using UnorderedJson = nlohmann::json;

constexpr int kMostVariables = 1000;
constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// One problem of the file; every complaint begins with where it is.
class Entry {
 public:
  Entry(std::string where, const UnorderedJson& json) : where_(std::move(where)), json_(json) {
    if (!json.is_object()) fail("is no object", "{\"name\": ..., \"n\": ..., ...}");
  }
  void name(const std::string& name) { where_ += " '" + name + "'"; }
  /// Refuses lists that nothing reads: they state more than the problem that is solved.
  void check_entries(const std::set<std::string>& known) const {
    for (const auto& [key, value] : json_.items()) {
      if (value.is_array() && !known.contains(key)) {
        fail(key + " is not read",
             "no further lists: what states more than the problem is not solved");
      }
    }
  }

  [[noreturn]] void fail(const std::string& what, const std::string& expected) const {
    throw InputError(where_ + ": " + what + "; expected " + expected);
  }
  const UnorderedJson& at(const char* key, const char* expected) const {
    const auto found = json_.find(key);
    if (found == json_.end()) fail(std::string("has no ") + key, expected);
    return *found;
  }
  std::string text(const char* key) const {
    const UnorderedJson& value = at(key, "a text");
    if (!value.is_string()) fail(std::string(key) + " is no text", "a text");
    return value.get<std::string>();
  }
  double number(const char* key) const {
    const UnorderedJson& value = at(key, "a number");
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      fail(std::string(key) + " is no number", "a finite number");
    }
    return value.get<double>();
  }
  /// None if it is absent or null.
  std::optional<double> number_if_known(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end() || found->is_null()) return std::nullopt;
    return number(key);
  }
  /// n numbers; null becomes `instead`.
  Eigen::VectorXd numbers(const char* key, int n, double instead, bool may_be_null) const {
    const std::string expected =
        std::to_string(n) + (may_be_null ? " numbers or null" : " finite numbers");
    const UnorderedJson& value = at(key, expected.c_str());
    if (!value.is_array() || value.size() != static_cast<std::size_t>(n)) {
      fail(std::string(key) + " is not of that length", expected);
    }
    Eigen::VectorXd numbers(n);
    for (int i = 0; i < n; ++i) {
      const UnorderedJson& one = value[static_cast<std::size_t>(i)];
      if (may_be_null && one.is_null()) {
        numbers[i] = instead;
      } else if (one.is_number() && std::isfinite(one.get<double>())) {
        numbers[i] = one.get<double>();
      } else {
        fail(std::string(key) + "[" + std::to_string(i) + "] is no number", expected);
      }
    }
    return numbers;
  }
  Expression expression(const std::string& what, const std::string& text, int n) const {
    try {
      return Expression(text, n);
    } catch (const std::invalid_argument& e) {
      throw InputError(where_ + ": " + what + " '" + text + "', " + e.what());
    }
  }
  std::vector<Expression> expressions(const char* key, int n) const {
    const UnorderedJson& list = at(key, "a list of expressions, which may be empty");
    if (!list.is_array()) fail(std::string(key) + " is no list", "a list of expressions");
    std::vector<Expression> read;
    for (const UnorderedJson& one : list) {
      if (!one.is_string()) fail(std::string(key) + " holds no text", "a list of expressions");
      read.push_back(expression(key, one.get<std::string>(), n));
    }
    return read;
  }

 private:
  std::string where_;
  const UnorderedJson& json_;
};

BenchProblem read_function_problem(const std::string& path, std::size_t index,
                                   const UnorderedJson& json) {
  Entry entry(path + ": problem " + std::to_string(index + 1), json);
  const std::string name = entry.text("name");
  entry.name(name);
  entry.check_entries({"x0", "lower", "upper", "inequalities_nonneg", "equalities_zero"});
  const double variables = entry.number("n");
  const int n = static_cast<int>(std::clamp(variables, 0.0, 1e6));
  if (n < 1 || n > kMostVariables || n != variables) {
    entry.fail("n is no such number", "a whole number from 1 to " + std::to_string(kMostVariables));
  }
  const Eigen::VectorXd start = entry.numbers("x0", n, 0.0, false);
  const Eigen::VectorXd lower = entry.numbers("lower", n, -kNoBound, true);
  const Eigen::VectorXd upper = entry.numbers("upper", n, kNoBound, true);
  for (int i = 0; i < n; ++i) {
    if (!(lower[i] <= upper[i])) {
      entry.fail("lower[" + std::to_string(i) + "] is above upper", "lower <= upper");
    }
  }
  Expression objective = entry.expression("objective", entry.text("objective"), n);
  StatedProgramme p{name, start, lower, upper, std::move(objective), {}, std::nullopt};
  for (Expression& c : entry.expressions("inequalities_nonneg", n)) {
    p.rows.push_back({std::move(c), 0.0, kNoBound});
  }
  for (Expression& h : entry.expressions("equalities_zero", n)) {
    p.rows.push_back({std::move(h), 0.0, 0.0});
  }
  p.optimum = entry.number_if_known("f_opt");
  return stated_problem(std::move(p));
}

}  // namespace

ProblemSet read_expression_file(const std::string& path) {
  const char* const expected = "; expected {\"problems\": [...]}";
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw InputError(path + ": no such file" + expected);
  std::ifstream file(path, std::ios::binary);
  const UnorderedJson json = UnorderedJson::parse(file, nullptr, false);
  if (json.is_discarded()) throw InputError(path + ": is no JSON" + expected);
  const auto list = json.is_object() ? json.find("problems") : json.end();
  if (!json.is_object() || list == json.end() || !list->is_array() || list->empty()) {
    throw InputError(path + ": has no problems" + expected);
  }
  ProblemSet set;
  set.name = fs::path(path).stem().string();
  set.absolute_tolerance = 0.0;
  std::set<std::string> names;
  for (std::size_t i = 0; i < list->size(); ++i) {
    BenchProblem problem = read_function_problem(path, i, (*list)[i]);
    if (!names.insert(problem.name).second) {
      throw InputError(path + ": problem '" + problem.name +
                       "' is there twice; expected each once");
    }
    if (problem.best_known) set.best_known_source = "known optima";
    set.problems.push_back(std::move(problem));
  }
  return set;
}

}  // namespace prospect
