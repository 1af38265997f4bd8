// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/programmes/nl_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "problems/expression_builder.h"

namespace prospect {
namespace {

using Operation = Expression::Operation;
using Node = Expression::Node;

constexpr int kMostVariables = 1000;
constexpr int kMostRows = 10000;
constexpr int kMostDepth = 5000;
constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kNoBound = 1e20;

/// The lines of the file, without comments, cut into words.
class Lines {
 public:
  explicit Lines(const std::string& path) : path_(path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      throw InputError(path + ": no such file; expected a file .nl");
    }
    file_.open(path, std::ios::binary);
  }
  /// The next line that holds something; false at the end.
  bool next() {
    words_.clear();
    while (words_.empty() && std::getline(file_, line_)) {
      ++number_;
      std::string_view rest = std::string_view(line_).substr(0, line_.find('#'));
      for (;;) {
        const std::size_t begin = rest.find_first_not_of(" \t\r");
        if (begin == std::string_view::npos) break;
        rest.remove_prefix(begin);
        const std::size_t length = std::min(rest.find_first_of(" \t\r"), rest.size());
        words_.push_back(rest.substr(0, length));
        rest.remove_prefix(length);
      }
    }
    return !words_.empty();
  }
  /// The same where one must be.
  void need(const std::string& expected) {
    if (!next()) {
      ++number_;
      fail("the file ends", expected);
    }
  }
  const std::vector<std::string_view>& words() const { return words_; }
  [[noreturn]] void fail(const std::string& what, const std::string& expected) const {
    throw InputError(path_ + ":" + std::to_string(number_) + ": " + what + "; expected " +
                     expected);
  }
  [[noreturn]] void fail_end(const std::string& what) const {
    throw InputError(path_ + ":" + std::to_string(number_ + 1) + ": " + what +
                     "; expected a whole file");
  }
  [[noreturn]] void fail_line(const std::string& expected) const {
    fail("'" + line_.substr(0, 40) + "'", expected);
  }
  /// Word i as a whole number within [lowest, highest].
  int whole(std::size_t i, int lowest, int highest, const std::string& what) const {
    int value = 0;
    if (i >= words_.size() || !parse_number(words_[i], value) || value < lowest ||
        value > highest) {
      fail_line(what + " from " + std::to_string(lowest) + " to " + std::to_string(highest));
    }
    return value;
  }
  double number(std::size_t i) const {
    std::string_view word = i < words_.size() ? words_[i] : std::string_view();
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0.0;
    if (!parse_number(word, value) || std::isnan(value)) fail_line("a number");
    return value;
  }

 private:
  std::string path_, line_;
  std::ifstream file_;
  std::vector<std::string_view> words_;
  int number_ = 0;
};

/// What an operation of the format is here; none for what is told by a function of its own.
const std::map<int, Operation>& operations() {
  using enum Operation;
  static const std::map<int, Operation> known = {
      {0, kAdd},     {1, kSubtract}, {2, kMultiply}, {3, kDivide}, {5, kPower},      {15, kAbs},
      {16, kNegate}, {20, kOr},      {21, kAnd},     {22, kLess},  {23, kLessEqual}, {24, kEqual},
      {34, kNot},    {35, kIf},      {37, kTanh},    {38, kTan},   {39, kSqrt},      {40, kSinh},
      {41, kSin},    {42, kLog10},   {43, kLog},     {44, kExp},   {45, kCosh},      {46, kCos},
      {47, kAtanh},  {48, kAtan2},   {49, kAtan},    {50, kAsinh}, {51, kAsin},      {52, kAcosh},
      {53, kAcos},   {76, kPower},   {78, kPower}};
  return known;
}

class NlReader {
 public:
  explicit NlReader(const std::string& path) : lines_(path) {}

  StatedProgramme read(const std::string& name) {
    header();
    while (lines_.next()) segment();
    whole();
    return programme(name);
  }

 private:
  struct Bounds {
    double lower = -kNone, upper = kNone;
  };

  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  int add(Operation operation, int a = 0, int b = 0, int c = 0, double number = 0.0) {
    nodes_.push_back({operation, a, b, c, number});
    return static_cast<int>(nodes_.size()) - 1;
  }
  int number(double value) { return add(Operation::kNumber, 0, 0, 0, value); }

  void header() {
    lines_.need("the header of a file .nl, 'g3 ...'");
    const std::string_view form = lines_.words()[0];
    if (form[0] == 'b') {
      lines_.fail("a binary .nl ('b')", "its text form, which begins with 'g'");
    }
    if (form[0] != 'g') lines_.fail_line("the header of a file .nl, 'g3 ...'");
    constexpr int kAny = std::numeric_limits<int>::max();
    lines_.need("the counts of variables, constraints and objectives");
    variables_ = lines_.whole(0, 1, kMostVariables, "a number of variables");
    count_ = lines_.whole(1, 0, kMostRows, "a number of constraints");
    if (lines_.whole(2, 0, kAny, "a number of objectives") > 1) {
      lines_.fail("several objectives", "one");
    }
    const auto none = [&](std::size_t i, const char* what) {
      if (i < lines_.words().size() && lines_.whole(i, 0, kAny, "a count") > 0) {
        lines_.fail(what, "none: smooth functions of continuous variables");
      }
    };
    none(5, "logical constraints");
    lines_.need("the counts of what is nonlinear");
    none(2, "complementarity");
    none(3, "complementarity");
    lines_.need("the counts of network constraints");
    lines_.need("the counts of variables in what is nonlinear");
    lines_.need("the counts of network variables and functions");
    none(1, "imported functions");
    lines_.need("the counts of discrete variables");
    for (std::size_t i = 0; i < 5; ++i) none(i, "binary or integer variables");
    lines_.need("the counts of nonzeros");
    rows_left_ = lines_.whole(0, 0, kAny, "a number of nonzeros");
    gradient_left_ = lines_.whole(1, 0, kAny, "a number of nonzeros");
    lines_.need("the lengths of names");
    lines_.need("the counts of common expressions");
    int defined = 0;
    for (std::size_t i = 0; i < 5; ++i) {
      defined += lines_.whole(i, 0, 1000000, "a number of common expressions");
    }
    for (int i = 0; i < variables_; ++i) add(Operation::kVariable, i);
    values_.assign(at(variables_ + defined), -1);
    for (int i = 0; i < variables_; ++i) values_[at(i)] = i;
    bounds_.resize(at(variables_));
    ranges_.resize(at(count_));
    bodies_.assign(at(count_), -1);
    linear_.resize(at(count_));
    start_.setZero(variables_);
  }

  /// The number behind the letter of a segment: 'C3', 'V12'.
  int index(int lowest, int highest, const std::string& what) const {
    int value = 0;
    if (!parse_number(lines_.words()[0].substr(1), value) || value < lowest || value > highest) {
      lines_.fail_line(what + " from " + std::to_string(lowest) + " to " + std::to_string(highest));
    }
    return value;
  }

  /// Refuses a file that was cut off between two segments.
  void whole() const {
    const auto missing = [&](const std::string& what) {
      lines_.fail_end("the file ends without " + what);
    };
    if (!bounded_) missing("b, bounds of the variables");
    if (count_ > 0 && !ranged_) missing("r, bounds of the constraints");
    for (int r = 0; r < count_; ++r) {
      if (bodies_[at(r)] < 0) missing("C" + std::to_string(r) + ", the body of a constraint");
    }
    if (rows_left_ > 0) missing("all entries of the Jacobian (J) that its header counts");
    if (gradient_left_ > 0) missing("all entries of the gradient (G) that its header counts");
  }

  void segment() {
    const char letter = lines_.words()[0][0];
    switch (letter) {
      case 'C': {
        int& body = bodies_[at(index(0, count_ - 1, "a constraint"))];
        if (body >= 0) lines_.fail("this constraint is there twice", "each once");
        body = expression(0);
        return;
      }
      case 'O': {
        index(0, 0, "an objective");
        if (objective_ >= 0) lines_.fail("the objective is there twice", "each once");
        maximise_ = lines_.whole(1, 0, 1, "0 (minimise) or 1 (maximise),") == 1;
        objective_ = expression(0);
        return;
      }
      case 'V':
        return defined_variable();
      case 'J': {
        const int row = index(0, count_ - 1, "a constraint");
        const int entries = lines_.whole(1, 0, variables_, "a count");
        rows_left_ -= entries;
        return linear_part(linear_[at(row)], entries);
      }
      case 'G': {
        index(0, 0, "an objective");
        const int entries = lines_.whole(1, 0, variables_, "a count");
        gradient_left_ -= entries;
        return linear_part(gradient_, entries);
      }
      case 'r':
        ranged_ = true;
        for (Bounds& range : ranges_) range = bounds("bounds of a constraint");
        return;
      case 'b':
        bounded_ = true;
        for (Bounds& bound : bounds_) bound = bounds("bounds of a variable");
        return;
      case 'x': {
        const int count = index(0, variables_, "a number of starts");
        for (int i = 0; i < count; ++i) {
          lines_.need("a variable and its start");
          const int variable = lines_.whole(0, 0, variables_ - 1, "a variable");
          start_[variable] = lines_.number(1);
          if (!std::isfinite(start_[variable])) lines_.fail_line("a finite start");
        }
        return;
      }
      case 'd':
        return skip(index(0, count_, "a number of multipliers"));
      case 'k':
      case 'K':
        return skip(index(0, variables_, "a number of columns"));
      case 'S':
        return skip(lines_.whole(1, 0, 1000000, "a number of values"));
      case 'F':
        lines_.fail("an imported function ('F')", "none: smooth functions that are built in");
      case 'L':
        lines_.fail("a logical constraint ('L')", "none: smooth functions");
      default:
        lines_.fail_line("a segment: C, O, V, J, G, r, b, x, d, k or S");
    }
  }

  void skip(int count) {
    for (int i = 0; i < count; ++i) lines_.need("what the segment has announced");
  }

  Bounds bounds(const std::string& expected) {
    lines_.need(expected);
    const int kind = lines_.whole(0, 0, 5, "a kind of bounds");
    if (kind == 5) lines_.fail("complementarity (5)", "bounds");
    Bounds b;
    if (kind == 0) b = {lines_.number(1), lines_.number(2)};
    if (kind == 1) b.upper = lines_.number(1);
    if (kind == 2) b.lower = lines_.number(1);
    if (kind == 4) b.lower = b.upper = lines_.number(1);
    if (b.lower <= -kNoBound) b.lower = -kNone;
    if (b.upper >= kNoBound) b.upper = kNone;
    if (!(b.lower <= b.upper) || b.lower == kNone || b.upper == -kNone) {
      lines_.fail_line("a lower bound that is not above the upper one");
    }
    return b;
  }

  using Linear = std::vector<std::pair<int, double>>;
  void linear_part(Linear& to, int count) {
    for (int i = 0; i < count; ++i) {
      lines_.need("a variable and its coefficient");
      const int variable = lines_.whole(0, 0, static_cast<int>(values_.size()) - 1, "a variable");
      const double factor = lines_.number(1);
      if (!std::isfinite(factor)) lines_.fail_line("a finite coefficient");
      if (factor != 0.0) to.emplace_back(variable, factor);
    }
  }
  /// The node of a body and its linear part; -1 for no body.
  int sum(int body, const Linear& linear) {
    if (body >= 0 && nodes_[at(body)].operation == Operation::kNumber &&
        nodes_[at(body)].number == 0.0 && !linear.empty()) {
      body = -1;
    }
    for (const auto& [variable, factor] : linear) {
      const int value = this->variable(variable);
      const int term = factor == 1.0 ? value : add(Operation::kMultiply, number(factor), value);
      body = body < 0 ? term : add(Operation::kAdd, body, term);
    }
    return body < 0 ? number(0.0) : body;
  }

  int variable(int index) {
    if (values_[at(index)] < 0) {
      lines_.fail("variable " + std::to_string(index) + " is used before it is defined",
                  "its segment V before");
    }
    return values_[at(index)];
  }

  void defined_variable() {
    const int place = index(variables_, static_cast<int>(values_.size()) - 1, "a defined variable");
    Linear linear;
    linear_part(linear, lines_.whole(1, 0, static_cast<int>(values_.size()), "a count"));
    const int body = expression(0);
    if (values_[at(place)] >= 0) lines_.fail("this variable is defined twice", "each once");
    values_[at(place)] = sum(body, linear);
  }

  /// Reads an expression in prefix form, a line an operation or operand; gives its node.
  int expression(int depth) {
    if (depth > kMostDepth) {
      lines_.fail("operations within each other",
                  "at most " + std::to_string(kMostDepth) + " deep");
    }
    lines_.need("an expression");
    const std::string_view word = lines_.words()[0], rest = word.substr(1);
    switch (word[0]) {
      case 'n':
      case 's':
      case 'l': {
        double value = 0.0;
        if (!parse_number(rest, value) || !std::isfinite(value)) {
          lines_.fail_line("a finite number");
        }
        return number(value);
      }
      case 'v':
        return variable(index(0, static_cast<int>(values_.size()) - 1, "a variable"));
      case 'o':
        return operation(index(0, 82, "an operation"), depth + 1);
      case 'f':
        lines_.fail("an imported function ('f')", "functions that are built in");
      case 'h':
        lines_.fail("a text ('h')", "numbers");
      default:
        lines_.fail_line("an expression: n, v or o");
    }
  }

  /// The operands of an operation with as many as it says.
  std::vector<int> list(int depth) {
    lines_.need("the number of operands");
    std::vector<int> operands(at(lines_.whole(0, 1, 1000000, "a number of operands")));
    for (int& operand : operands) operand = expression(depth);
    return operands;
  }
  int fold(Operation by, int depth) {
    std::vector<int> parts = list(depth);
    for (; parts.size() > 1; parts.resize((parts.size() + 1) / 2)) {  // by halves: not deep
      for (std::size_t i = 0; 2 * i < parts.size(); ++i) {
        parts[i] =
            2 * i + 1 < parts.size() ? add(by, parts[2 * i], parts[2 * i + 1]) : parts[2 * i];
      }
    }
    return parts[0];
  }

  int operation(int code, int depth) {
    using enum Operation;
    if (const auto found = operations().find(code); found != operations().end()) {
      std::array<int, 3> of{};
      const int count = Expression::operands(found->second);
      for (int i = 0; i < count; ++i) of[at(i)] = expression(depth);
      return add(found->second, of[0], of[1], of[2]);
    }
    switch (code) {
      case 6: {  // a less b = max(a - b, 0)
        const int a = expression(depth), b = expression(depth);
        return add(kMaximum, add(kSubtract, a, b), number(0.0));
      }
      case 11:
        return fold(kMinimum, depth);
      case 12:
        return fold(kMaximum, depth);
      case 28:
      case 29: {  // a >= b, a > b
        const int a = expression(depth), b = expression(depth);
        return add(code == 28 ? kLessEqual : kLess, b, a);
      }
      case 30: {
        const int a = expression(depth), b = expression(depth);
        return add(kNot, add(kEqual, a, b));
      }
      case 54:
        return fold(kAdd, depth);
      case 70:
        return fold(kAnd, depth);
      case 71:
        return fold(kOr, depth);
      case 77: {
        const int a = expression(depth);
        return add(kMultiply, a, a);
      }
      default:
        break;
    }
    static const std::map<int, std::string> names = {{4, "mod"},          {13, "floor"},
                                                     {14, "ceil"},        {55, "div"},
                                                     {56, "precision"},   {57, "round"},
                                                     {58, "trunc"},       {59, "count"},
                                                     {60, "numberof"},    {64, "piecewise linear"},
                                                     {65, "if of texts"}, {72, "implication"},
                                                     {73, "equivalence"}, {74, "alldiff"}};
    const auto name = names.find(code);
    lines_.fail("operation o" + std::to_string(code) +
                    (name == names.end() ? "" : " (" + name->second + ")"),
                "smooth functions, abs, min, max, if");
  }

  StatedProgramme programme(const std::string& name) {
    int objective = sum(objective_, gradient_);
    if (maximise_) objective = add(Operation::kNegate, objective);
    StatedProgramme made{name,
                         start_,
                         Eigen::VectorXd(variables_),
                         Eigen::VectorXd(variables_),
                         part_of(nodes_, objective, variables_),
                         {},
                         std::nullopt};
    for (int i = 0; i < variables_; ++i) {
      made.lower[i] = bounds_[at(i)].lower;
      made.upper[i] = bounds_[at(i)].upper;
    }
    for (int r = 0; r < count_; ++r) {
      const int body = sum(bodies_[at(r)], linear_[at(r)]);
      made.rows.push_back(
          {part_of(nodes_, body, variables_), ranges_[at(r)].lower, ranges_[at(r)].upper});
    }
    return made;
  }

  Lines lines_;
  int variables_ = 0, count_ = 0;
  std::vector<Node> nodes_;
  std::vector<int> values_;  // the node of each variable and defined variable; -1: not yet
  std::vector<Bounds> bounds_, ranges_;
  std::vector<int> bodies_;
  std::vector<Linear> linear_;
  int objective_ = -1;
  Linear gradient_;
  bool maximise_ = false, ranged_ = false, bounded_ = false;
  int rows_left_ = 0, gradient_left_ = 0;  // entries that are still to come
  Eigen::VectorXd start_;
};

}  // namespace

StatedProgramme read_nl(const std::string& path) {
  return NlReader(path).read(std::filesystem::path(path).stem().string());
}

}  // namespace prospect
