// SPDX-License-Identifier: Apache-2.0
// docs/safety.md names tests: they are there, in the files named beside them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

namespace prospect::safety_page_test {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What is wrong with the rows of the page's tables: "page:line: what".
std::vector<std::string> faults_of(const fs::path& root, const fs::path& page) {
  static const std::regex span("`([^`]+)`"), test(R"((\w+)\.(\w+))");
  std::vector<std::string> faults;
  std::ifstream file(page);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (!line.starts_with("| ") || line.starts_with("| hazard ")) continue;
    const auto fault = [&](const std::string& what) {
      faults.push_back(page.filename().string() + ":" + std::to_string(number) + ": " + what);
    };
    std::string text;
    int tests = 0;
    for (std::sregex_iterator it(line.begin(), line.end(), span), end; it != end; ++it) {
      const std::string name = (*it)[1];
      std::smatch match;
      if (name.starts_with("tests/")) {
        if (!fs::exists(root / name)) fault("no file " + name);
        text += read(root / name);
      } else if (std::regex_match(name, match, test)) {
        ++tests;
        const std::string written = "(" + match.str(1) + ", " + match.str(2) + ")";
        if (text.find(written) == std::string::npos) fault("no test " + name);
      }
    }
    if (tests == 0) fault("no test");
  }
  return faults;
}

TEST(SafetyPage, EveryTestThatItNamesIsThere) {
  const fs::path root = PROSPECT_SOURCE_DIR;
  EXPECT_THAT(faults_of(root, root / "docs/safety.md"), testing::IsEmpty());
}

TEST(SafetyPage, AWrongNameIsFound) {
  const fs::path root = fs::path(testing::TempDir()) / "prospect safety page";
  fs::remove_all(root);
  fs::create_directories(root / "tests");
  std::ofstream(root / "tests/a_test.cc") << "TEST(A, IsThere) {}\n";
  std::ofstream(root / "page.md") << "| hazard | rule | test |\n|---|---|---|\n"
                                  << "| h | r | `tests/a_test.cc` `A.IsThere` |\n"
                                  << "| h | r | `tests/a_test.cc` `A.IsNot` |\n"
                                  << "| h | r | `tests/b_test.cc` `A.IsThere` |\n"
                                  << "| h | r | |\n";
  EXPECT_THAT(
      faults_of(root, root / "page.md"),
      testing::ElementsAre("page.md:4: no test A.IsNot", "page.md:5: no file tests/b_test.cc",
                           "page.md:5: no test A.IsThere", "page.md:6: no test"));
}

}  // namespace
}  // namespace prospect::safety_page_test
