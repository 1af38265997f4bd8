// SPDX-License-Identifier: Apache-2.0
// Functions have at most 120 lines and seven parameters, and no two booleans side by side, which a
// caller would exchange.

#include "tests/architecture/function_shapes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

namespace prospect::function_shapes_test {
namespace {

namespace fs = std::filesystem;

TEST(FunctionShapes, OfTheProduct) {
  // Called from Python, by name: their parameters are a Python function's.
  const std::set<std::string> python = {"make_own", "from_functions", "make_belief"};
  const fs::path root = PROSPECT_SOURCE_DIR;
  std::vector<std::string> found;
  std::size_t functions = 0;
  for (const char* top : {"models", "engine", "solvers", "problems", "perception", "runtime",
                          "adapters", "benchmarks"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cc") continue;
      std::ifstream file(entry.path());
      const std::string source{std::istreambuf_iterator<char>(file), {}};
      functions += test::functions_in(source).size();
      for (const std::string& fault :
           test::shapeless_functions(fs::relative(entry.path(), root).generic_string(), source)) {
        const bool called = fault.find("/python/") != std::string::npos &&
                            std::any_of(python.begin(), python.end(), [&](const auto& name) {
                              return fault.find(": " + name + ": ") != std::string::npos &&
                                     fault.find("parameters") != std::string::npos;
                            });
        if (!called) found.push_back(fault);
      }
    }
  }
  EXPECT_THAT(found, testing::IsEmpty());
  EXPECT_GT(functions, 5000u) << "they are not read";
}

std::string of_lines(int lines) {
  std::string text = "int f(int a) {\n";
  for (int k = 0; k < lines - 2; ++k) text += k % 2 ? "  if (a) { a = 1; }\n" : "  // {\n";
  return text + "}\n";
}

TEST(FunctionShapes, EachKindIsFound) {
  using testing::ElementsAre;
  using testing::IsEmpty;
  const auto faults = [](const std::string& source) {
    return test::shapeless_functions("a.cc", source);
  };
  EXPECT_THAT(faults(of_lines(120)), IsEmpty());
  EXPECT_THAT(faults(of_lines(121)), ElementsAre("a.cc:1: f: 121 lines"));
  EXPECT_THAT(faults("namespace a {\nclass B {\n public:\n  " + of_lines(121) + "};\n}\n"),
              ElementsAre("a.cc:4: f: 121 lines"));
  EXPECT_THAT(faults("B::B(int a) : a_{a}, b_(a) {\n" + std::string(200, '\n') + "}\n"),
              ElementsAre("a.cc:1: B: 202 lines"));
  EXPECT_THAT(faults("void f(int a, int b, int c, int d, int e, int f, std::map<int, int> g);"),
              IsEmpty());
  EXPECT_THAT(faults("\nvoid f(int a, int b, int c, int d, int e, int f, int g, int h) const;"),
              ElementsAre("a.cc:2: f: 8 parameters"));
  EXPECT_THAT(faults("std::function<void(bool, bool)> f;\nusing F = void(bool a, bool b);"),
              IsEmpty());
  EXPECT_THAT(faults("void f(bool a, int b, bool c);"), IsEmpty());
  EXPECT_THAT(faults("template <typename T>\nT f(bool a,\n    bool b = true) { return {}; }"),
              ElementsAre("a.cc:1: f: two booleans side by side"));
  EXPECT_THAT(faults("const char* k = \"void f(bool a, bool b);\";"), IsEmpty());
}

}  // namespace
}  // namespace prospect::function_shapes_test
