// SPDX-License-Identifier: Apache-2.0
#include "tests/architecture/docs_pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/architecture/include_rules.h"

namespace prospect::docs_pages_test {
namespace {

namespace fs = std::filesystem;
using namespace prospect::test;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

const fs::path& source() {
  static const fs::path path = PROSPECT_SOURCE_DIR;
  return path;
}

/// A project in a scratch folder.
class Project {
 public:
  Project() {
    const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
    root_ = fs::temp_directory_path() / ("prospect_docs_" + test);
    fs::remove_all(root_);
    add("README.md", "# A project\n").add("docs/README.md", "# Index\n");
  }
  ~Project() { fs::remove_all(root_); }
  Project(const Project&) = delete;
  Project& operator=(const Project&) = delete;
  Project& add(const std::string& path, const std::string& text) {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
    return *this;
  }
  const fs::path& root() const { return root_; }

 private:
  fs::path root_;
};

TEST(DocsPages, EveryLinkOfTheProjectLeadsToAFileAndAHeading) {
  EXPECT_THAT(broken_links(source()), IsEmpty());
}

TEST(DocsPages, EveryFileOfTheDocsThatTheProjectNamesIsThere) {
  EXPECT_THAT(mentions_of_nothing(source()), IsEmpty());
}

TEST(DocsPages, EveryPageStandsInTheIndex) {
  EXPECT_THAT(pages_not_in_the_index(source()), IsEmpty());
}

TEST(DocsPages, ReferenceAndTutorialsSayWhatIsInTheWordsOfTheField) {
  EXPECT_THAT(words_out_of_place(source()), IsEmpty());
}

// What comes in lets something go: results that a newer planner has, what another page says, too.
TEST(DocsPages, ThePagesAreNoLongerThanAReaderActsOn) {
  const DocsSize size = docs_size(source());
  EXPECT_LE(size.all, 70000);
  EXPECT_LE(size.results, 15000);
  EXPECT_GT(size.results, 5000) << "they are not read";
}

TEST(DocsPages, TheArchitecturePageHasTheRoomsOfTheRulesInTheirOrder) {
  std::vector<std::string> rooms, exceptions;
  for (const auto& [room, rules] : architecture()) {
    rooms.push_back(room);
    for (const std::string& other : rules.may_use) {
      if (fs::path(other).extension() == ".h") exceptions.push_back(other);
    }
  }
  const fs::path page = source() / "docs/reference/architecture.md";
  static const std::regex row("^\\| `([a-z_/]+)/` \\|.*");
  std::vector<std::string> rows;
  std::string text;
  for (const auto& [number, line] : prose_of(page, false)) {
    std::smatch match;
    if (std::regex_match(line, match, row)) rows.push_back(match[1]);
    text += line;
  }
  rooms.insert(rooms.end(), {"benchmarks", "tests"});  // which may use everything
  EXPECT_THAT(rows, ElementsAreArray(rooms));
  for (const std::string& file : exceptions) {
    EXPECT_NE(text.find('`' + file + '`'), std::string::npos) << file;
  }
}

TEST(DocsPages, LinksToMissingFilesAndHeadingsAreFound) {
  Project p;
  p.add("docs/a.md",
        "# First page\n## What `code` costs, in ms\n[here](#first-page) [b](b.md#none)\n")
      .add("docs/b.md",
           "# B\n[gone](gone.md) [up](../README.md)\n[a](a.md#what-code-costs-in-ms) "
           "[net](https://example.org/x)\n```\n[not a](link.md)\n```\n`[nor](this.md)`\n");
  EXPECT_THAT(broken_links(p.root()),
              UnorderedElementsAre("docs/a.md:3: b.md#none: no such heading",
                                   "docs/b.md:2: gone.md: no such file"));
}

TEST(DocsPages, NamesOfMissingPagesInSourcesAreFound) {
  Project p;
  p.add("docs/reference/a.md", "# A\n")
      .add("engine/x.h", "/// See docs/reference/a.md.\n/// And docs/b.md, docs/examples.\n");
  EXPECT_THAT(mentions_of_nothing(p.root()),
              ElementsAre("engine/x.h:2: docs/b.md", "engine/x.h:2: docs/examples"));
}

TEST(DocsPages, ExamplesAreOptimisedWhereNothingElseIsAskedFor) {
  int examples = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source() / "docs" / "examples")) {
    // What is no project of its own is built with the tests.
    if (!std::filesystem::exists(entry.path() / "CMakeLists.txt")) continue;
    std::ifstream file(entry.path() / "CMakeLists.txt");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NE(text.find("set(CMAKE_BUILD_TYPE Release)"), std::string::npos) << entry.path();
    ++examples;
  }
  EXPECT_GE(examples, 6);
}

TEST(DocsPages, PagesThatTheIndexLacksAreFound) {
  Project p;
  p.add("docs/README.md", "[a](reference/a.md): a.\n<!-- [c](results/c.md): c. -->\n")
      .add("docs/reference/a.md", "# A\n")
      .add("docs/results/b.md", "# B\n")
      .add("docs/results/c.md", "# C\n");
  EXPECT_THAT(pages_not_in_the_index(p.root()), ElementsAre("results/b.md", "results/c.md"));
}

TEST(DocsPages, WordsAreCounted) {
  Project p;
  p.add("docs/results/a.md", "# A\nthree words here\n")
      .add("docs/reference/configuration.md", "a b c\n");
  EXPECT_EQ(docs_size(p.root()).all, 3 + 2 + 5);
  EXPECT_EQ(docs_size(p.root()).results, 5);
}

TEST(DocsPages, HistoryAndCoinedWordsAreFound) {
  Project p;
  p.add("docs/reference/a.md",
        "# A\nIt no longer does.\nThe Impasse.\nAn entry `crowding` is one.\n*Tried:* x.\n"
        "Guided by nothing.\n")
      .add("docs/decisions/b.md", "# B\n*Tried:* much, no longer done.\n");
  EXPECT_THAT(words_out_of_place(p.root()),
              ElementsAre("docs/reference/a.md:2: no longer", "docs/reference/a.md:3: impasses?",
                          "docs/reference/a.md:5: [*]tried"));
}

}  // namespace
}  // namespace prospect::docs_pages_test
