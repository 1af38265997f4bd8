// SPDX-License-Identifier: Apache-2.0
// Files of tests are compiled several as one, so the names of each are in a namespace named after
// it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

namespace prospect::test_namespaces_test {
namespace {

namespace fs = std::filesystem;

TEST(TestNamespaces, EveryFileOfTestsHasItsOwn) {
  int files = 0;
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(PROSPECT_SOURCE_DIR) / "tests")) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != ".cc" || !stem.ends_with("_test")) continue;
    ++files;
    const std::regex own("namespace prospect(::\\w+)*::" + stem + " \\{");
    std::ifstream file(entry.path());
    bool found = false;
    for (std::string line; !found && std::getline(file, line);) found = std::regex_match(line, own);
    EXPECT_TRUE(found) << fs::relative(entry.path(), PROSPECT_SOURCE_DIR).string()
                       << ": expected a line 'namespace prospect::" << stem << " {'";
  }
  EXPECT_GT(files, 100);
}

}  // namespace
}  // namespace prospect::test_namespaces_test
