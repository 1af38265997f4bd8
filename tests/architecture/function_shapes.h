// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

namespace prospect::test {

/// A function as it is declared or defined.
struct FunctionShape {
  std::string name;
  int line = 0;
  int lines = 0;  ///< of its definition, from its first line to the brace that ends it; else 0
  std::vector<std::string> parameters;
};

/// The text with blanks in place of comments, literals and lines of the preprocessor.
inline std::string code_alone(std::string text) {
  const auto blank = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < std::min(to, text.size()); ++i) {
      if (text[i] != '\n') text[i] = ' ';
    }
  };
  bool line_begins = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto end_of = [&](const char* what) { return std::min(text.find(what, i), text.size()); };
    if (c == '#' && line_begins) {
      std::size_t end = end_of("\n");
      while (end < text.size() && text[end - 1] == '\\')
        end = std::min(text.find('\n', end + 1), text.size());
      blank(i, end);
      i = end;
    } else if (text.compare(i, 2, "//") == 0) {
      const std::size_t end = end_of("\n");
      blank(i, end);
      i = end;
    } else if (text.compare(i, 2, "/*") == 0) {
      const std::size_t end = end_of("*/") + 2;
      blank(i, end);
      i = end - 1;
    } else if (c == '"' && i > 0 && text[i - 1] == 'R') {
      const std::size_t open = text.find('(', i);
      const std::string close = ')' + text.substr(i + 1, open - i - 1) + '"';
      const std::size_t end = std::min(text.find(close, open), text.size()) + close.size();
      blank(i, end);
      i = end - 1;
    } else if (c == '"' ||
               (c == '\'' && (i == 0 || !std::isalnum(static_cast<unsigned char>(text[i - 1]))))) {
      std::size_t end = i + 1;
      while (end < text.size() && text[end] != c) end += text[end] == '\\' ? 2 : 1;
      blank(i, end + 1);
      i = end;
    }
    if (i < text.size()) {
      line_begins =
          text[i] == '\n' || (line_begins && std::isspace(static_cast<unsigned char>(text[i])));
    }
  }
  return text;
}

/// The parts of a list, as commas outside of brackets divide it.
inline std::vector<std::string> parts_of_list(const std::string& list) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : list) {
    if (c == '(' || c == '[' || c == '{' || c == '<') ++depth;
    if (c == ')' || c == ']' || c == '}' || c == '>') --depth;
    if (c == ',' && depth == 0) {
      parts.emplace_back();
    } else if (!std::isspace(static_cast<unsigned char>(c)) ||
               (!parts.back().empty() && parts.back().back() != ' ')) {
      parts.back() += std::isspace(static_cast<unsigned char>(c)) ? ' ' : c;
    }
  }
  if (parts.size() == 1 && (parts[0].empty() || parts[0] == "void")) parts.clear();
  return parts;
}

/// What stands before a brace or semicolon outside of functions, as a function; no name: it is
/// none.
inline FunctionShape declared_by(const std::string& head) {
  static const std::regex none(
      R"(^\s*(using|typedef|static_assert|friend|template\s*class|extern\s*template)\b)");
  FunctionShape shape;
  if (std::regex_search(head, none)) return shape;
  int angle = 0;
  for (std::size_t i = 0; i < head.size(); ++i) {
    if (head[i] == '=' && angle == 0 && head.rfind("operator", i) == std::string::npos) break;
    if (head[i] == '<') ++angle;
    if (head[i] == '>' && angle > 0) --angle;
    if (head[i] != '(' || angle > 0) continue;
    std::size_t from = i;
    while (from > 0 &&
           (std::isalnum(static_cast<unsigned char>(head[from - 1])) || head[from - 1] == '_')) {
      --from;
    }
    const std::string name = head.substr(from, i - from);
    int depth = 0;
    std::size_t end = i;
    for (; end < head.size(); ++end) {
      depth += head[end] == '(' ? 1 : head[end] == ')' ? -1 : 0;
      if (depth == 0) break;
    }
    // Attributes and the like stand before the name.
    if (name == "alignas" || name == "decltype" || name == "noexcept" || name == "requires") {
      i = end;
      continue;
    }
    if (name.empty()) return shape;
    shape.name = name;
    shape.parameters = parts_of_list(head.substr(i + 1, end - i - 1));
    return shape;
  }
  return shape;
}

/// All functions that a file declares or defines, but for what functions hold.
inline std::vector<FunctionShape> functions_in(const std::string& source) {
  const std::string code = code_alone(source);
  static const std::regex type(R"(\b(namespace|struct|class|union|enum|extern)\b)");
  static const std::regex initialiser(R"(\)\s*(noexcept\s*)?:[^:])");
  static const std::regex body(R"((^|[^\w])(const|override|noexcept|final|try|mutable)\s*$)");
  std::vector<FunctionShape> found;
  int line = 1, first = 1;
  std::string head;
  const auto close_of = [&](std::size_t open) {
    int depth = 0;
    for (std::size_t i = open; i < code.size(); ++i) {
      depth += code[i] == '{' ? 1 : code[i] == '}' ? -1 : 0;
      if (depth == 0) return i;
    }
    return code.size() - 1;
  };
  const auto lines_until = [&](std::size_t from, std::size_t to) {
    return static_cast<int>(std::count(code.begin() + static_cast<std::ptrdiff_t>(from),
                                       code.begin() + static_cast<std::ptrdiff_t>(to), '\n'));
  };
  const auto reset = [&] { head.clear(); };
  for (std::size_t i = 0; i < code.size(); ++i) {
    const char c = code[i];
    if (c == '\n') ++line;
    if (c == ';' || c == '}') {
      FunctionShape shape = declared_by(head);
      shape.line = first;
      if (c == ';' && !shape.name.empty()) found.push_back(std::move(shape));
      reset();
    } else if (c == '{') {
      FunctionShape shape = declared_by(head);
      const std::size_t close = close_of(i);
      const std::size_t last = head.find_last_not_of(" \n");
      const bool word =
          last != std::string::npos && (std::isalnum(static_cast<unsigned char>(head[last])) ||
                                        head[last] == '_' || head[last] == '>');
      if (shape.name.empty()) {
        // What a namespace or type holds is read, what initialises a variable is not.
        if (std::regex_search(head, type) && head.find('=') == std::string::npos) {
          reset();
          continue;
        }
        line += lines_until(i, close);
        i = close;
      } else if (word && std::regex_search(head, initialiser) && !std::regex_search(head, body)) {
        line += lines_until(i, close);  // a member's initialiser
        head += "{}";
        i = close;
      } else {
        line += lines_until(i, close);
        shape.line = first;
        shape.lines = line - first + 1;
        found.push_back(std::move(shape));
        i = close;
        reset();
      }
    } else {
      if (c == ':' && (head == "public" || head == "private" || head == "protected")) {
        reset();
        continue;
      }
      if (head.empty()) {
        if (std::isspace(static_cast<unsigned char>(c))) continue;
        first = line;
      }
      head += c;
    }
  }
  return found;
}

/// What is wrong with the functions of a file, as "path:line: name: what".
inline std::vector<std::string> shapeless_functions(const std::string& path,
                                                    const std::string& source) {
  constexpr int kMostLines = 120;
  constexpr std::size_t kMostParameters = 7;
  static const std::regex boolean(R"(^(const )?bool( \w+)?( = \w+)? ?$)");
  std::vector<std::string> found;
  for (const FunctionShape& f : functions_in(source)) {
    const auto fault = [&](const std::string& what) {
      found.push_back(path + ':' + std::to_string(f.line) + ": " + f.name + ": " + what);
    };
    if (f.lines > kMostLines) fault(std::to_string(f.lines) + " lines");
    // Of a library's own signatures, Ipopt's are the only ones that long.
    const bool ipopt = std::any_of(f.parameters.begin(), f.parameters.end(), [](const auto& p) {
      return p.find("Ipopt::") != std::string::npos;
    });
    if (ipopt) continue;
    if (f.parameters.size() > kMostParameters) {
      fault(std::to_string(f.parameters.size()) + " parameters");
    }
    for (std::size_t i = 0; i + 1 < f.parameters.size(); ++i) {
      if (std::regex_match(f.parameters[i], boolean) &&
          std::regex_match(f.parameters[i + 1], boolean)) {
        fault("two booleans side by side");
        break;
      }
    }
  }
  return found;
}

}  // namespace prospect::test
