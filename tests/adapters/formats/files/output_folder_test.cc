// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/output_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>

#include "adapters/formats/files/input_error.h"

namespace prospect::output_folder_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using State = OutputFolder::State;

class OutputFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }
  std::string path(const std::string& name) const { return root_ + "/" + name; }
  void write(const std::string& name, const std::string& content) const {
    fs::create_directories(fs::path(path(name)).parent_path());
    std::ofstream(path(name)) << content;
  }
  std::string content(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(path(name)).rdbuf();
    return text.str();
  }
  /// All that is there: content of files, where links lead to.
  std::map<std::string, std::string> tree() const {
    std::map<std::string, std::string> all;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root_)) {
      const std::string name = fs::relative(entry.path(), root_);
      all[name] = entry.is_symlink()        ? "-> " + fs::read_symlink(entry.path()).string()
                  : entry.is_regular_file() ? content(name)
                                            : "";
    }
    return all;
  }
  /// Empty: it is not refused. One that is refused leaves all as it was.
  std::string refusal(const std::function<void()>& call) const {
    const auto before = tree();
    try {
      call();
    } catch (const InputError& error) {
      EXPECT_EQ(error.lines().size(), 1U);
      EXPECT_EQ(tree(), before) << error.what();
      return error.what();
    }
    return "";
  }
  std::string refused_own(const std::string& name) const {
    return refusal([&] { OutputFolder::own(path(name), {"run", "drive"}).begin({"steps.csv"}); });
  }

  const std::string root_ = testing::TempDir() + "output_folder_" + std::to_string(getpid());
};

TEST_F(OutputFolderTest, WhatItNamesIsItsOwnAndNothingElse) {
  {
    OutputFolder folder = OutputFolder::own(path("deep/run"), {"run"});
    EXPECT_EQ(folder.state(), State::kNew);
    EXPECT_TRUE(fs::exists(path("deep/run/.prospect"))) << "before anything else";
    folder.begin({"steps.csv"});
    EXPECT_EQ(folder.write("steps.csv", "1"), "");
    EXPECT_EQ(folder.write("problems/one.h5", "2"), "");
  }
  write("deep/run/notes.txt", "mine");
  write("deep/run/problems/mine.h5", "mine");
  {
    OutputFolder folder = OutputFolder::own(path("deep/run"), {"run"});
    EXPECT_EQ(folder.state(), State::kBegun);
    EXPECT_THAT(refusal([&] { folder.write("notes.txt", ""); }), HasSubstr("not named"));
    folder.begin({"steps.csv"});
    EXPECT_FALSE(fs::exists(path("deep/run/steps.csv")));
    EXPECT_FALSE(fs::exists(path("deep/run/problems/one.h5")));
    EXPECT_EQ(content("deep/run/problems/mine.h5"), "mine");
    EXPECT_EQ(content("deep/run/notes.txt"), "mine");
    EXPECT_EQ(folder.write("steps.csv", "3"), "");
    EXPECT_EQ(folder.complete(), "");
  }
  // A name of before that is not written again is nobody's.
  write("deep/run/problems/one.h5", "mine, too");
  OutputFolder folder = OutputFolder::own(path("deep/run"), {"run"});
  EXPECT_EQ(folder.state(), State::kComplete);
  folder.begin({"steps.csv"}, {"steps.csv"});
  EXPECT_EQ(content("deep/run/steps.csv"), "3") << "kept";
  EXPECT_EQ(content("deep/run/problems/one.h5"), "mine, too");
}

TEST_F(OutputFolderTest, CompletenessIsAFactAndEndsWhenItIsBegunAnew) {
  const auto state = [&] { return OutputFolder::own(path("b"), {"bench"}).state(); };
  EXPECT_EQ(state(), State::kNew);
  {
    OutputFolder folder = OutputFolder::own(path("b"), {"bench"});
    folder.begin({"rows.jsonl"}, {"rows.jsonl"});
    folder.write("rows.jsonl", "1\n");
    folder.write("bench.json", "{}");  // all files of the end
  }
  EXPECT_EQ(state(), State::kBegun) << "whatever files are there";
  EXPECT_EQ(OutputFolder::own(path("b"), {"bench"}).complete(), "");
  EXPECT_EQ(state(), State::kComplete);
  OutputFolder::own(path("b"), {"bench"}).begin({"rows.jsonl"}, {"rows.jsonl"});
  EXPECT_EQ(state(), State::kBegun);
  EXPECT_EQ(content("b/rows.jsonl"), "1\n");
  EXPECT_FALSE(fs::exists(path("b/bench.json")));
}

TEST_F(OutputFolderTest, FoldersOfOthersAreRefusedUntouched) {
  write("mine/steps.csv", "my own,steps");
  write("mine/summary.json", "{}");
  write("file", "precious");
  fs::create_directories(path("bench"));
  OutputFolder::own(path("bench"), {"bench"}).write("rows.jsonl", "1");
  write("damaged/.prospect", "something else\n");
  fs::create_directories(path("odd/.prospect"));
  EXPECT_THAT(refused_own("mine"), HasSubstr("holds other files; expected a new or empty folder"));
  EXPECT_THAT(refused_own("file"), HasSubstr("is no folder"));
  EXPECT_THAT(refused_own("file/below"), HasSubstr("cannot be created"));
  EXPECT_THAT(refused_own("bench"), HasSubstr("of another kind: bench"));
  EXPECT_THAT(refused_own("damaged"), HasSubstr("line 1"));
  EXPECT_THAT(refused_own("odd"), HasSubstr("is no regular file"));
  EXPECT_THAT(refusal([&] { OutputFolder::shared(path("mine"), {"report"}); }),
              HasSubstr("holds other files"));
  for (const std::string line :
       {"file ../mine/steps.csv", "file /etc/passwd", "file ", "folder .."}) {
    write("outside/.prospect", "prospect run\n" + line + "\n");
    EXPECT_THAT(refused_own("outside"), HasSubstr("line 2")) << line;
  }
}

TEST_F(OutputFolderTest, SymbolicLinksAreNotFollowed) {
  write("theirs/steps.csv", "precious");
  write("theirs/one.h5", "precious");
  fs::create_directories(path("empty"));
  fs::create_directory_symlink(path("empty"), path("link"));
  for (const char* name : {"link", "link/", "link/.", "link//"}) {
    EXPECT_THAT(refused_own(name), HasSubstr("symbolic link")) << name;
  }
  EXPECT_TRUE(fs::is_empty(path("empty")));
  fs::create_directory_symlink(root_, path("disk"));
  EXPECT_EQ(refused_own("disk/run"), "") << "a folder above may be one";

  // A file that was ours, one that is not there yet, what a file is until it is whole, a folder.
  const std::map<std::string, std::string> links = {{"steps.csv", "theirs/steps.csv"},
                                                    {"map.bt", "theirs/new"},
                                                    {"report.html.part", "theirs/steps.csv"},
                                                    {"problems", "theirs"}};
  for (const auto& [name, target] : links) {
    fs::remove_all(path("run"));
    {
      OutputFolder folder = OutputFolder::own(path("run"), {"run"});
      folder.write("timing.csv", "1");
      folder.claim_all({"steps.csv", "problems/one.h5"});
    }
    fs::remove(path("run/problems"));
    fs::create_symlink(path(target), path("run/" + name));
    const std::string why = refusal([&] {
      OutputFolder folder = OutputFolder::own(path("run"), {"run"});
      folder.begin({"steps.csv", "map.bt", "report.html", "problems/one.h5"});
    });
    EXPECT_THAT(why, HasSubstr("run/" + name)) << why;
  }
  EXPECT_EQ(content("theirs/steps.csv"), "precious");
  EXPECT_EQ(content("theirs/one.h5"), "precious");
  EXPECT_FALSE(fs::exists(path("theirs/new")));
}

TEST_F(OutputFolderTest, OneAtATimeAndManyThatAdd) {
  OutputFolder first = OutputFolder::own(path("run"), {"run"});
  first.begin({"steps.csv"});
  EXPECT_THAT(refused_own("run"), HasSubstr("another run writes to it"));
  OutputFolder figures = OutputFolder::shared(path("run"), {"report", "run"});
  OutputFolder again = OutputFolder::shared(path("run"), {"report", "run"});
  EXPECT_EQ(figures.write("path.png", "1"), "");
  EXPECT_EQ(again.claim_folder("cells"), path("run/cells"));
  EXPECT_EQ(first.write("steps.csv", "2"), "");
  OutputFolder last = OutputFolder::shared(path("run"), {"run"});
  EXPECT_EQ(last.write("path.png", "3"), "") << "named by the one before";
  EXPECT_EQ(last.write("cells/any", "4"), "");
}

TEST_F(OutputFolderTest, BesideOthersFilesItsOwnAreReplacedAndNoOther) {
  write("worlds/cafe.world", "theirs");
  write("worlds/cafe.sdf.part", "theirs");
  const auto put = [&](const std::string& name) {
    return refusal([&] { OutputFolder::beside(path("worlds")).write(name, "ours"); });
  };
  EXPECT_EQ(put("room.sdf"), "");
  EXPECT_EQ(put("room.sdf"), "");
  EXPECT_THAT(put("cafe.world"), HasSubstr("cafe.world: is there"));
  EXPECT_THAT(put("cafe.sdf"), HasSubstr("cafe.sdf.part: is there"));
  EXPECT_EQ(content("worlds/cafe.world"), "theirs");
  EXPECT_THAT(refused_own("worlds"), HasSubstr("of another kind: files"));
}

TEST_F(OutputFolderTest, WhatIsAbandonedWasNeverThere) {
  write("there/notes.txt", "mine");
  const auto before = tree();
  {
    OutputFolder folder = OutputFolder::own(path("a/b/run"), {"run"});
    folder.begin({"steps.csv"});
    folder.write("steps.csv", "1");
    folder.abandon();
  }
  EXPECT_EQ(tree(), before);
}

TEST_F(OutputFolderTest, WhereNothingWasWrittenNothingIsLeft) {
  fs::create_directories(path("empty"));
  const auto before = tree();
  { OutputFolder::own(path("made/run"), {"run"}).begin({"steps.csv"}); }
  { OutputFolder::shared(path("empty"), {"report"}); }
  { OutputFolder::beside(path("made")).claim("one.sdf"); }
  EXPECT_EQ(tree(), before);
  OutputFolder::shared(path("study"), {"study"}).claim_folder("cells");
  EXPECT_TRUE(fs::exists(path("study/.prospect")));
}

TEST_F(OutputFolderTest, ALineThatIsCutOffCountsForNothing) {
  OutputFolder::own(path("run"), {"run"}).write("steps.csv", "1");
  write("run/map.bt", "theirs");
  std::ofstream(path("run/.prospect"), std::ios::app) << "file map.bt";
  OutputFolder folder = OutputFolder::shared(path("run"), {"run"});
  EXPECT_THAT(refusal([&] { folder.claim("map.bt"); }), HasSubstr("not named"));
}

}  // namespace
}  // namespace prospect::output_folder_test
