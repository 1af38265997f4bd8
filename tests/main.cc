// SPDX-License-Identifier: Apache-2.0
// The program of a room's tests: GoogleTest's own, and --file=NAME, which runs the tests of NAME.cc
// alone. That is how CTest runs them, each file in a process of its own, though a room is one
// program. --gtest_filter and GTEST_FILTER choose among those of the file.

#include <fnmatch.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <sstream>
#include <string>
#include <string_view>

namespace {

// Whether one of the patterns, separated by colons, fits the name.
bool fits(const std::string& patterns, const std::string& name) {
  std::istringstream list(patterns);
  for (std::string pattern; std::getline(list, pattern, ':');) {
    if (fnmatch(pattern.c_str(), name.c_str(), 0) == 0) return true;
  }
  return false;
}

// GoogleTest's filter for those tests of file.cc that `filter` ("WANTED-UNWANTED") leaves. `found`
// says whether the file has tests at all.
std::string filter_of(std::string_view file, const std::string& filter, bool& found) {
  const auto dash = filter.find('-');
  const std::string wanted = filter.substr(0, dash).empty() ? "*" : filter.substr(0, dash);
  const std::string unwanted = dash == std::string::npos ? "" : filter.substr(dash + 1);
  const std::string ending = "/" + std::string(file) + ".cc";
  std::string chosen;
  found = false;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int j = 0; j < suite.total_test_count(); ++j) {
      const testing::TestInfo& test = *suite.GetTestInfo(j);
      if (!std::string_view(test.file()).ends_with(ending)) continue;
      found = true;
      const std::string name = std::string(suite.name()) + '.' + test.name();
      if (fits(wanted, name) && !fits(unwanted, name)) chosen += (chosen.empty() ? "" : ":") + name;
    }
  }
  return chosen.empty() ? "-*" : chosen;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  constexpr std::string_view option = "--file=";
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    bool found = false;
    if (argument.starts_with(option)) {
      GTEST_FLAG_SET(filter,
                     filter_of(argument.substr(option.size()), GTEST_FLAG_GET(filter), found));
    }
    if (!found) {
      std::cerr << argv[0] << ": '" << argument
                << "': expected --file=NAME, NAME.cc being a file with tests of this program\n";
      return 2;
    }
  }
  return RUN_ALL_TESTS();
}
