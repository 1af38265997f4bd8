// The header that is precompiled for all files hides from the compiler whether a file includes what
// it uses of it. This is what checks it instead: by name, in the file or in the project's headers
// that it includes.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace prospect::precompiled_includes_test {
namespace {

namespace fs = std::filesystem;

struct Used {
  std::string header;
  std::regex names;
};

// Eigen, and names of the standard library that are found in one header only.
const std::vector<Used>& precompiled() {
  static const std::vector<Used> all = [] {
    std::vector<Used> list = {{"Eigen/", std::regex(R"(\bEigen::\w)")}};
    const std::vector<std::pair<std::string, std::string>> standard = {
        {"algorithm",
         "sort|stable_sort|partial_sort|nth_element|min|max|minmax|clamp|min_element|max_element|"
         "minmax_element|copy|copy_n|copy_if|fill|fill_n|find|find_if|any_of|all_of|none_of|count|"
         "count_if|transform|reverse|rotate|lower_bound|upper_bound|equal_range|binary_search|"
         "remove_if|unique|shuffle|for_each|generate|replace|is_sorted"},
        {"filesystem", "filesystem"},
        {"fstream", "ifstream|ofstream|fstream"},
        {"functional", "function"},
        {"map", "map|multimap"},
        {"memory", "unique_ptr|shared_ptr|weak_ptr|make_unique|make_shared"},
        {"optional", "optional|nullopt"},
        {"random",
         "mt19937|mt19937_64|uniform_real_distribution|uniform_int_distribution|"
         "normal_distribution|poisson_distribution|bernoulli_distribution"},
        {"set", "set|multiset"},
        {"sstream", "istringstream|ostringstream|stringstream"},
        {"string", "string|to_string|stod|stoi"},
        {"vector", "vector"},
    };
    for (const auto& [header, names] : standard) {
      list.push_back({header, std::regex("\\bstd::(" + names + ")\\b")});
    }
    return list;
  }();
  return all;
}

struct Source {
  std::set<std::string> system, project;
  std::string text;  // without comments and strings
};

Source read(const fs::path& path) {
  static const std::regex include(R"re(^\s*#\s*include\s*(<|")([^>"]+)[>"].*)re");
  static const std::regex quoted(R"re("(\\.|[^"\\])*")re");
  Source source;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (std::regex_match(line, match, include)) {
      (match[1] == "<" ? source.system : source.project).insert(match[2]);
      continue;
    }
    line = std::regex_replace(line, quoted, "");
    source.text += line.substr(0, line.find("//")) + '\n';
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
    for (const Used& used : precompiled()) {
      const auto found = included.lower_bound(used.header);
      const bool there =
          found != included.end() &&
          (used.header.back() == '/' ? found->starts_with(used.header) : *found == used.header);
      std::smatch match;
      if (!there && std::regex_search(source.text, match, used.names)) {
        missing.push_back(path + ": uses " + match.str() + " and does not include <" + used.header +
                          (used.header.back() == '/' ? "...>" : ">"));
      }
    }
  }
  return missing;
}

TEST(PrecompiledIncludes, EveryFileIncludesWhatItUses) {
  for (const std::string& line :
       missing_includes(PROSPECT_SOURCE_DIR, {"models", "engine", "solvers", "problems",
                                              "perception", "adapters", "benchmarks", "tests"})) {
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
  EXPECT_EQ(missing[0], "engine/c.cc: uses Eigen::V and does not include <Eigen/...>");
  EXPECT_EQ(missing[1], "engine/c.cc: uses std::max and does not include <algorithm>");
  fs::remove_all(root);
}

}  // namespace
}  // namespace prospect::precompiled_includes_test
