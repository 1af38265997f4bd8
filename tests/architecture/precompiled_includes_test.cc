// SPDX-License-Identifier: Apache-2.0
// The header that is precompiled for all files hides from the compiler whether a file includes what
// it uses of it. This is what checks it instead: by name, in the file or in the project's headers
// that it includes.

#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace prospect::precompiled_includes_test {
namespace {

namespace fs = std::filesystem;

// Names of the standard library that are found in one header only, and that header.
const std::map<std::string, std::string>& headers_of_names() {
  static const std::map<std::string, std::string> all = [] {
    std::map<std::string, std::string> headers;
    const std::vector<std::pair<std::string, std::string>> standard = {
        {"algorithm",
         "sort stable_sort partial_sort nth_element min max minmax clamp min_element max_element "
         "minmax_element copy copy_n copy_if fill fill_n find find_if any_of all_of none_of count "
         "count_if transform reverse rotate lower_bound upper_bound equal_range binary_search "
         "remove_if unique shuffle for_each generate replace is_sorted"},
        {"filesystem", "filesystem"},
        {"fstream", "ifstream ofstream fstream"},
        {"functional", "function"},
        {"map", "map multimap"},
        {"memory", "unique_ptr shared_ptr weak_ptr make_unique make_shared"},
        {"optional", "optional nullopt"},
        {"random",
         "mt19937 mt19937_64 uniform_real_distribution uniform_int_distribution "
         "normal_distribution poisson_distribution bernoulli_distribution"},
        {"set", "set multiset"},
        {"sstream", "istringstream ostringstream stringstream"},
        {"string", "string to_string stod stoi"},
        {"vector", "vector"},
    };
    for (const auto& [header, names] : standard) {
      std::istringstream words(names);
      for (std::string name; words >> name;) headers[name] = header;
    }
    return headers;
  }();
  return all;
}

bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

struct Source {
  std::set<std::string> system, project;
  std::map<std::string, std::string> uses;  // header, "Eigen/" for any of it, and a name of it
};

// What follows `space` + "::" in a line, each time: a name.
template <typename Visit>
void each_name(const std::string& line, const std::string& space, Visit visit) {
  const std::string wanted = space + "::";
  for (std::size_t at = 0; (at = line.find(wanted, at)) != std::string::npos;) {
    const bool whole = at == 0 || !in_word(line[at - 1]);
    at += wanted.size();
    std::size_t end = at;
    while (end < line.size() && in_word(line[end])) ++end;
    if (whole && end > at) visit(line.substr(at, end - at));
  }
}

// Without comments and strings. By hand: regular expressions take half a minute for all files.
std::string code_of(const std::string& line) {
  std::string code;
  bool quoted = false;
  for (std::size_t n = 0; n < line.size(); ++n) {
    if (quoted && line[n] == '\\') {
      ++n;
    } else if (line[n] == '"' && !(!quoted && n > 0 && line[n - 1] == '\'')) {
      quoted = !quoted;
    } else if (!quoted) {
      if (line.compare(n, 2, "//") == 0) break;
      code += line[n];
    }
  }
  return code;
}

Source read(const fs::path& path) {
  Source source;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::size_t hash = line.find_first_not_of(" \t");
    if (hash != std::string::npos && line[hash] == '#') {
      const std::size_t open = line.find_first_of("<\""), close = line.find_last_of(">\"");
      if (line.find("include") != std::string::npos && close != std::string::npos && close > open) {
        (line[open] == '<' ? source.system : source.project)
            .insert(line.substr(open + 1, close - open - 1));
        continue;
      }
    }
    const std::string code = code_of(line);
    each_name(code, "Eigen",
              [&](const std::string& name) { source.uses.emplace("Eigen/", "Eigen::" + name); });
    each_name(code, "std", [&](const std::string& name) {
      const auto header = headers_of_names().find(name);
      if (header != headers_of_names().end()) {
        source.uses.emplace(header->second, "std::" + name);
      }
    });
  }
  return source;
}

// What the files below `root`, in these rooms, use of the precompiled headers and do not include.
std::vector<std::string> missing_includes(const fs::path& root,
                                          const std::vector<std::string>& rooms) {
  std::map<std::string, Source> sources;
  for (const std::string& room : rooms) {
    if (!fs::exists(root / room)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".h" || extension == ".cc") {
        sources[fs::relative(entry.path(), root).generic_string()] = read(entry.path());
      }
    }
  }
  std::vector<std::string> missing;
  for (const auto& [path, source] : sources) {
    std::set<std::string> seen = {path}, included;
    for (std::vector<std::string> open = {path}; !open.empty();) {
      const Source& next = sources[open.back()];
      open.pop_back();
      included.insert(next.system.begin(), next.system.end());
      for (const std::string& header : next.project) {
        if (sources.count(header) && seen.insert(header).second) open.push_back(header);
      }
    }
    for (const auto& [header, name] : source.uses) {
      const auto found = included.lower_bound(header);
      const bool there = found != included.end() &&
                         (header.back() == '/' ? found->starts_with(header) : *found == header);
      if (there) continue;
      missing.push_back(path + ": uses " + name + " and does not include <" + header +
                        (header.back() == '/' ? "...>" : ">"));
    }
  }
  return missing;
}

TEST(PrecompiledIncludes, EveryFileIncludesWhatItUses) {
  for (const std::string& line : missing_includes(
           PROSPECT_SOURCE_DIR, {"models", "engine", "solvers", "problems", "perception", "runtime",
                                 "adapters", "benchmarks", "tests"})) {
    ADD_FAILURE() << line;
  }
}

TEST(PrecompiledIncludes, WhatIsMissingIsFound) {
  const fs::path root = fs::path(testing::TempDir()) / "prospect precompiled";
  fs::remove_all(root);
  fs::create_directories(root / "engine");
  std::ofstream(root / "engine/a.h")
      << "#pragma once\n#include <vector>\nusing A = std::vector<int>;\n";
  std::ofstream(root / "engine/b.h") << "#include \"engine/a.h\"\nstd::vector<int> b();\n";
  std::ofstream(root / "engine/c.cc") << "#include \"engine/b.h\"\n"
                                      << "std::vector<int> b() { return {std::max(1, 2)}; }\n"
                                      << "// std::map in a comment\nconst char* s = \"std::set\";\n"
                                      << "Eigen::Vector3d v;\n";
  const std::vector<std::string> missing = missing_includes(root, {"engine"});
  ASSERT_EQ(missing.size(), 2u);
  EXPECT_EQ(missing[0], "engine/c.cc: uses Eigen::Vector3d and does not include <Eigen/...>");
  EXPECT_EQ(missing[1], "engine/c.cc: uses std::max and does not include <algorithm>");
  fs::remove_all(root);
}

}  // namespace
}  // namespace prospect::precompiled_includes_test
