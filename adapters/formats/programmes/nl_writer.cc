// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/programmes/nl_writer.h"

#include <array>
#include <cmath>
#include <vector>

#include "adapters/formats/programmes/joined_expressions.h"
#include "models/range_text.h"

namespace prospect {
namespace {

using Operation = Expression::Operation;

int code_of(Operation operation) {
  using enum Operation;
  switch (operation) {
    case kAdd:
      return 0;
    case kSubtract:
      return 1;
    case kMultiply:
      return 2;
    case kDivide:
      return 3;
    case kPower:
      return 5;
    case kMinimum:
      return 11;
    case kMaximum:
      return 12;
    case kAbs:
      return 15;
    case kNegate:
      return 16;
    case kOr:
      return 20;
    case kAnd:
      return 21;
    case kLess:
      return 22;
    case kLessEqual:
      return 23;
    case kEqual:
      return 24;
    case kNot:
      return 34;
    case kIf:
      return 35;
    case kTanh:
      return 37;
    case kTan:
      return 38;
    case kSqrt:
      return 39;
    case kSinh:
      return 40;
    case kSin:
      return 41;
    case kLog10:
      return 42;
    case kLog:
      return 43;
    case kExp:
      return 44;
    case kCosh:
      return 45;
    case kCos:
      return 46;
    case kAtanh:
      return 47;
    case kAtan2:
      return 48;
    case kAtan:
      return 49;
    case kAsinh:
      return 50;
    case kAsin:
      return 51;
    case kAcosh:
      return 52;
    case kAcos:
      return 53;
    case kNumber:
    case kVariable:
      break;
  }
  return -1;
}

class NlText {
 public:
  explicit NlText(const StatedProgramme& programme)
      : p_(programme),
        variables_(static_cast<int>(p_.lower.size())),
        joined_(joined_expressions(p_, 200)),
        names_(joined_.nodes.size(), -1) {}

  std::string text(const std::string& comment) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (joined_.named[i]) names_[i] = variables_ + defined_++;
    }
    header(comment);
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] < 0) continue;
      line("V" + std::to_string(names_[i]) + " 0 0");
      operation(i);
    }
    for (std::size_t r = 0; r < p_.rows.size(); ++r) {
      line("C" + std::to_string(r));
      expression(joined_.results[r + 1]);
    }
    line("O0 0");
    expression(joined_.results[0]);
    line("x" + std::to_string(variables_));
    for (int i = 0; i < variables_; ++i) {
      line(std::to_string(i) + " " + exact_text(p_.start[i]));
    }
    if (!p_.rows.empty()) line("r");
    for (const StatedProgramme::Row& row : p_.rows) bounds(row.lower, row.upper);
    line("b");
    for (int i = 0; i < variables_; ++i) bounds(p_.lower[i], p_.upper[i]);
    jacobian();
    return text_;
  }

 private:
  void line(const std::string& text) { text_ += text + '\n'; }

  void header(const std::string& comment) {
    const auto m = static_cast<int>(p_.rows.size());
    int ranges = 0, equations = 0;
    long nonzeros = 0;
    for (const StatedProgramme::Row& row : p_.rows) {
      equations += row.lower == row.upper;
      ranges += std::isfinite(row.lower) && std::isfinite(row.upper) && row.lower < row.upper;
      nonzeros += static_cast<long>(row.body.dependencies().size());
    }
    const std::string n = std::to_string(variables_), rows = std::to_string(m);
    const std::string in_rows = m > 0 ? n : "0";
    line("g3 1 1 0\t# " + comment);
    line(" " + n + " " + rows + " 1 " + std::to_string(ranges) + " " + std::to_string(equations));
    line(" " + rows + " 1");
    line(" 0 0");
    line(" " + in_rows + " " + n + " " + in_rows);
    line(" 0 0 0 1");
    line(" 0 0 0 0 0");
    line(" " + std::to_string(nonzeros) + " " + std::to_string(p_.objective.dependencies().size()));
    line(" 0 0");
    line(" " + std::to_string(defined_) + " 0 0 0 0");
  }

  void bounds(double lower, double upper) {
    const bool below = std::isfinite(lower), above = std::isfinite(upper);
    if (below && lower == upper) {
      line("4 " + exact_text(lower));
    } else if (below && above) {
      line("0 " + exact_text(lower) + " " + exact_text(upper));
    } else if (above) {
      line("1 " + exact_text(upper));
    } else if (below) {
      line("2 " + exact_text(lower));
    } else {
      line("3");
    }
  }

  void expression(int node) {
    const auto i = static_cast<std::size_t>(node);
    if (names_[i] >= 0) {
      line("v" + std::to_string(names_[i]));
    } else {
      operation(i);
    }
  }
  void operation(std::size_t i) {
    const Expression::Node& node = joined_.nodes[i];
    if (node.operation == Operation::kNumber) return line("n" + exact_text(node.number));
    if (node.operation == Operation::kVariable) return line("v" + std::to_string(node.a));
    line("o" + std::to_string(code_of(node.operation)));
    const int count = Expression::operands(node.operation);
    if (node.operation == Operation::kMinimum || node.operation == Operation::kMaximum) {
      line(std::to_string(count));
    }
    const std::array<int, 3> operands = {node.a, node.b, node.c};
    for (int k = 0; k < count; ++k) expression(operands[static_cast<std::size_t>(k)]);
  }

  void jacobian() {
    std::vector<int> by_column(static_cast<std::size_t>(variables_), 0);
    for (const StatedProgramme::Row& row : p_.rows) {
      for (const int i : row.body.dependencies()) ++by_column[static_cast<std::size_t>(i)];
    }
    line("k" + std::to_string(variables_ - 1));
    int sum = 0;
    for (int i = 0; i + 1 < variables_; ++i) {
      line(std::to_string(sum += by_column[static_cast<std::size_t>(i)]));
    }
    const auto entries = [&](const std::string& name, const std::vector<int>& dependencies) {
      if (dependencies.empty()) return;
      line(name + " " + std::to_string(dependencies.size()));
      for (const int i : dependencies) line(std::to_string(i) + " 0");
    };
    for (std::size_t r = 0; r < p_.rows.size(); ++r) {
      entries("J" + std::to_string(r), p_.rows[r].body.dependencies());
    }
    entries("G0", p_.objective.dependencies());
  }

  const StatedProgramme& p_;
  int variables_, defined_ = 0;
  JoinedExpressions joined_;
  std::vector<int> names_;  // the defined variable of a node; -1: none
  std::string text_;
};

}  // namespace

std::string nl_text(const StatedProgramme& programme, const std::string& comment) {
  return NlText(programme).text(comment);
}

}  // namespace prospect
