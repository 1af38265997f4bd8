// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/programmes/casadi_writer.h"

#include <cstddef>
#include <vector>

#include "adapters/formats/programmes/joined_expressions.h"
#include "models/range_text.h"

namespace prospect {
namespace {

using Operation = Expression::Operation;

/// A number of Python that is no integer, which would be exact where a float is not.
std::string python_number(double value) {
  std::string text = exact_text(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return value < 0.0 ? "(" + text + ")" : text;
}

class CasadiText {
 public:
  explicit CasadiText(const StatedProgramme& programme)
      : p_(programme), joined_(joined_expressions(p_, 20)) {}

  std::string text(const std::string& comment) {
    text_ = "# " + comment + "\nimport casadi\n\ninf = float(\"inf\")\nx = casadi.SX.sym(\"x\", " +
            std::to_string(p_.lower.size()) + ")\n";
    for (std::size_t i = 0; i < joined_.nodes.size(); ++i) {
      if (joined_.named[i]) text_ += "t" + std::to_string(i) + " = " + operation(i) + "\n";
    }
    text_ += "f = casadi.SX(" + expression(joined_.results[0]) + ")\ng = ";
    if (p_.rows.empty()) {
      text_ += "casadi.SX(0, 1)\n";
    } else {
      text_ += "casadi.vertcat(\n";
      for (std::size_t r = 0; r < p_.rows.size(); ++r) {
        text_ += "    " + expression(joined_.results[r + 1]) + ",\n";
      }
      text_ += ")\n";
    }
    Eigen::VectorXd lower(static_cast<Eigen::Index>(p_.rows.size())), upper = lower;
    for (Eigen::Index r = 0; r < lower.size(); ++r) {
      lower[r] = p_.rows[static_cast<std::size_t>(r)].lower;
      upper[r] = p_.rows[static_cast<std::size_t>(r)].upper;
    }
    list("lbx", p_.lower);
    list("ubx", p_.upper);
    list("lbg", lower);
    list("ubg", upper);
    list("x0", p_.start);
    text_ += "nlp = {\"x\": x, \"f\": f, \"g\": g}\n";
    return text_;
  }

 private:
  void list(const std::string& name, const Eigen::VectorXd& values) {
    text_ += name + " = [";
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      text_ += (i > 0 ? ", " : "") + exact_text(values[i]);
    }
    text_ += "]\n";
  }

  std::string expression(int node) const {
    const auto i = static_cast<std::size_t>(node);
    return joined_.named[i] ? "t" + std::to_string(i) : operation(i);
  }
  std::string operation(std::size_t i) const {
    using enum Operation;
    const Expression::Node& node = joined_.nodes[i];
    if (node.operation == kNumber) return python_number(node.number);
    if (node.operation == kVariable) return "x[" + std::to_string(node.a) + "]";
    const int count = Expression::operands(node.operation);
    const std::string a = expression(node.a);
    const std::string b = count > 1 ? expression(node.b) : "";
    const auto between = [&](const char* sign) { return "(" + a + " " + sign + " " + b + ")"; };
    const auto call = [&](const char* name) {
      return "casadi." + std::string(name) + "(" + a + (count > 1 ? ", " + b : "") +
             (count > 2 ? ", " + expression(node.c) : "") + ")";
    };
    switch (node.operation) {
      case kNegate:
        return "(-" + a + ")";
      case kAdd:
        return between("+");
      case kSubtract:
        return between("-");
      case kMultiply:
        return between("*");
      case kDivide:
        return between("/");
      case kPower:
        return between("**");
      case kLess:
        return between("<");
      case kLessEqual:
        return between("<=");
      case kEqual:
        return between("==");
      case kSin:
        return call("sin");
      case kCos:
        return call("cos");
      case kTan:
        return call("tan");
      case kExp:
        return call("exp");
      case kLog:
        return call("log");
      case kSqrt:
        return call("sqrt");
      case kAbs:
        return call("fabs");
      case kTanh:
        return call("tanh");
      case kSinh:
        return call("sinh");
      case kCosh:
        return call("cosh");
      case kAsin:
        return call("asin");
      case kAcos:
        return call("acos");
      case kAtan:
        return call("atan");
      case kAsinh:
        return call("asinh");
      case kAcosh:
        return call("acosh");
      case kAtanh:
        return call("atanh");
      case kLog10:
        return call("log10");
      case kAtan2:
        return call("atan2");
      case kMinimum:
        return call("fmin");
      case kMaximum:
        return call("fmax");
      case kAnd:
        return call("logic_and");
      case kOr:
        return call("logic_or");
      case kNot:
        return call("logic_not");
      case kIf:
        return call("if_else");
      case kNumber:
      case kVariable:
        break;
    }
    return "";
  }

  const StatedProgramme& p_;
  JoinedExpressions joined_;
  std::string text_;
};

}  // namespace

std::string casadi_text(const StatedProgramme& programme, const std::string& comment) {
  return CasadiText(programme).text(comment);
}

}  // namespace prospect
