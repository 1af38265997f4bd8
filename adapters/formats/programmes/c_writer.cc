// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/programmes/c_writer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "adapters/formats/programmes/joined_expressions.h"
#include "adapters/formats/programmes/programme_templates.h"
#include "models/range_text.h"

namespace prospect {
namespace {

/// `kind name[] = {...};`, broken into lines; a zero more where C has no array.
template <typename Values, typename Text>
std::string table(const std::string& kind, const std::string& name, const Values& values,
                  Text&& text) {
  std::string line = "  ", made = "static const " + kind + " " + name + "[] = {\n";
  for (const auto& value : values) {
    const std::string one = text(value) + ",";
    if (line.size() + one.size() > 100) {
      made += line + "\n";
      line = "  ";
    }
    line += one;
  }
  if (std::size(values) == 0) line += "0";
  return made + line + "\n};\n";
}
std::string whole_table(const std::string& kind, const std::string& name,
                        const std::vector<int>& values) {
  return table(kind, name, values, [](int value) { return std::to_string(value); });
}
std::string number_of_c(double value) {
  if (std::isinf(value)) return value > 0.0 ? "INFINITY" : "-INFINITY";
  return exact_text(value);
}
std::string real_table(const std::string& name, const Eigen::VectorXd& values) {
  return table("double", name, std::vector<double>(values.begin(), values.end()), number_of_c);
}

/// {rows, columns, starts of columns..., rows of entries...}, as CasADi has it.
std::string pattern_table(const std::string& name, const ColumnPattern& pattern) {
  std::vector<int> values = {pattern.height, pattern.width()};
  values.insert(values.end(), pattern.starts.begin(), pattern.starts.end());
  values.insert(values.end(), pattern.rows.begin(), pattern.rows.end());
  return whole_table("casadi_int", name, values);
}
ColumnPattern dense(int height, int width) {
  ColumnPattern pattern;
  pattern.height = height;
  for (int j = 1; j <= width; ++j) {
    for (int i = 0; i < height; ++i) pattern.rows.push_back(i);
    pattern.starts.push_back(j * height);
  }
  return pattern;
}

std::string replaced(std::string_view text,
                     const std::vector<std::pair<std::string, std::string>>& by) {
  std::string made(text);
  for (const auto& [what, with] : by) {
    for (std::size_t at = 0; (at = made.find(what, at)) != std::string::npos; at += with.size()) {
      made.replace(at, what.size(), with);
    }
  }
  return made;
}

std::string beginning(const std::string& comment) {
  return "/* " + comment + " */\n" + std::string(programme_templates::interface_head());
}

/// The functions of a programme whose values FAMILY_values(x, f, gradient, g, jacobian, w) gives.
/// family: a word for what is static. macro: of its name, `name` unless it is defined. work: how
/// much of w FAMILY_values needs.
std::string functions(const ProgrammeData& data, const std::string& family,
                      const std::string& macro, const std::string& name, std::size_t work) {
  const auto n = static_cast<int>(data.start.size());
  const int m = data.jacobian.height;
  std::string text = "#ifndef " + macro + "\n#define " + macro + " " + name + "\n#endif\n";
  const auto pattern = [&](const std::string& which, const ColumnPattern& of) {
    text += pattern_table(family + "_" + which, of);
  };
  pattern("of_x", dense(n, 1));
  pattern("of_p", dense(0, 1));
  pattern("of_f", dense(1, 1));
  pattern("of_g", dense(m, 1));
  pattern("of_jac_f_x", dense(1, n));
  pattern("of_jac_f_p", dense(1, 0));
  pattern("of_jac_g_x", data.jacobian);
  pattern("of_jac_g_p", dense(m, 0));
  text += real_table(family + "_x0", data.start) + real_table(family + "_lbx", data.lower) +
          real_table(family + "_ubx", data.upper) + real_table(family + "_lbg", data.row_lower) +
          real_table(family + "_ubg", data.row_upper);
  return text + replaced(programme_templates::interface_functions(),
                         {{"@FAMILY@", family},
                          {"@MACRO@", macro},
                          {"@N@", std::to_string(n)},
                          {"@M@", std::to_string(m)},
                          {"@NONZEROS@", std::to_string(data.jacobian.nonzeros())},
                          {"@WORK@", std::to_string(work)}});
}

std::string ending() { return "#ifdef __cplusplus\n}\n#endif\n"; }

/// The tables of the expressions' operations, and the largest of them.
struct Tape {
  std::vector<int> operation, a, b, c, begin = {0};
  std::vector<double> numbers;
  std::size_t largest = 0;

  void add(const Expression& expression) {
    for (const Expression::Node& node : expression.nodes()) {
      operation.push_back(static_cast<int>(node.operation));
      const bool number = node.operation == Expression::Operation::kNumber;
      a.push_back(number ? static_cast<int>(numbers.size()) : node.a);
      b.push_back(node.b);
      c.push_back(node.c);
      if (number) numbers.push_back(node.number);
    }
    largest = std::max(largest, expression.nodes().size());
    begin.push_back(static_cast<int>(operation.size()));
  }
};

}  // namespace

std::string c_text(const StatedProgramme& programme, const std::string& name,
                   const std::string& comment) {
  const auto m = static_cast<Eigen::Index>(programme.rows.size());
  ProgrammeData data;
  data.start = programme.start;
  data.lower = programme.lower;
  data.upper = programme.upper;
  data.row_lower.resize(m);
  data.row_upper.resize(m);
  Tape tape;
  tape.add(programme.objective);
  std::vector<std::vector<int>> rows_of(static_cast<std::size_t>(programme.start.size()));
  for (Eigen::Index r = 0; r < m; ++r) {
    const StatedProgramme::Row& row = programme.rows[static_cast<std::size_t>(r)];
    data.row_lower[r] = row.lower;
    data.row_upper[r] = row.upper;
    tape.add(row.body);
    for (const int i : row.body.dependencies()) {
      rows_of[static_cast<std::size_t>(i)].push_back(static_cast<int>(r));
    }
  }
  data.jacobian.height = static_cast<int>(m);
  for (const std::vector<int>& rows : rows_of) {
    data.jacobian.rows.insert(data.jacobian.rows.end(), rows.begin(), rows.end());
    data.jacobian.starts.push_back(data.jacobian.nonzeros());
  }
  // What the sweep of a row leaves is put where the pattern has it.
  std::vector<int> places, first = {0};
  for (const StatedProgramme::Row& row : programme.rows) {
    const auto r = static_cast<int>(first.size()) - 1;
    for (const int i : row.body.dependencies()) places.push_back(data.jacobian.place(r, i));
    first.push_back(static_cast<int>(places.size()));
  }
  std::vector<int> columns;
  for (const StatedProgramme::Row& row : programme.rows) {
    for (const int i : row.body.dependencies()) columns.push_back(i);
  }
  std::string text = beginning(comment) + whole_table("unsigned char", "operation", tape.operation);
  text += whole_table("int", "operand_a", tape.a) + whole_table("int", "operand_b", tape.b) +
          whole_table("int", "operand_c", tape.c) + whole_table("int", "tape_begin", tape.begin) +
          table("double", "numbers", tape.numbers, number_of_c) +
          whole_table("int", "entry_begin", first) + whole_table("int", "entry_column", columns) +
          whole_table("int", "entry_place", places);
  text += replaced(programme_templates::expression_values(),
                   {{"@N@", std::to_string(programme.start.size())},
                    {"@M@", std::to_string(m)},
                    {"@LARGEST@", std::to_string(tape.largest)}});
  const std::size_t work = 2 * tape.largest + static_cast<std::size_t>(programme.start.size());
  return text + functions(data, "whole", "PROSPECT_NAME", name, work) + ending();
}

std::string c_text_of_file(const std::string& file, const ProgrammeData& whole,
                           const ProgrammeData& stages, const std::string& name,
                           const std::string& comment) {
  std::string quoted;
  for (const char c : file) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  std::string text =
      beginning(comment) + replaced(programme_templates::file_values(), {{"@FILE@", quoted}});
  const auto values = [&](const std::string& family, const ProgrammeData& data, int by_stages) {
    return replaced(programme_templates::family_values(),
                    {{"@FAMILY@", family},
                     {"@STAGES@", std::to_string(by_stages)},
                     {"@N@", std::to_string(data.start.size())},
                     {"@M@", std::to_string(data.jacobian.height)},
                     {"@NONZEROS@", std::to_string(data.jacobian.nonzeros())}});
  };
  text += values("whole", whole, 0) + functions(whole, "whole", "PROSPECT_NAME", name, 0);
  text += values("stages", stages, 1) +
          functions(stages, "stages", "PROSPECT_STAGES_NAME", name + "_stages", 0);
  return text + ending();
}

}  // namespace prospect
