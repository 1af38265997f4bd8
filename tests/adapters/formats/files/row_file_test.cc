// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/row_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace prospect::row_file_test {
namespace {

namespace fs = std::filesystem;

std::string path(const std::string& name) {
  return testing::TempDir() + "row_file_" + std::to_string(getpid()) + "_" + name;
}

std::string content(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

TEST(RowFile, AppendsToAnEmptiedFile) {
  const std::string file = path("plain");
  std::ofstream(file) << "old\n";
  RowFile rows(file);
  ASSERT_TRUE(rows.is_open());
  EXPECT_TRUE(rows.append("a,b\n"));
  EXPECT_EQ(content(file), "a,b\n") << "nothing waits in the process";
  EXPECT_TRUE(rows.append("1,2\n3,4\n"));
  EXPECT_EQ(content(file), "a,b\n1,2\n3,4\n");
  fs::remove(file);
}

TEST(RowFile, MovesItsFile) {
  const std::string file = path("moved");
  RowFile rows;
  EXPECT_FALSE(rows.is_open());
  EXPECT_FALSE(rows.append("lost\n"));
  EXPECT_EQ(errno, EBADF);
  rows = RowFile(file);
  RowFile other(std::move(rows));
  EXPECT_TRUE(other.append("kept\n"));
  EXPECT_EQ(content(file), "kept\n");
  fs::remove(file);
}

TEST(RowFile, SaysWhyAFullDiskTakesNoRow) {
  RowFile rows("/dev/full");
  ASSERT_TRUE(rows.is_open());
  EXPECT_FALSE(rows.append("1,2\n"));
  EXPECT_EQ(errno, ENOSPC);
}

TEST(RowFile, TakesBackARowThatFitsOnlyInPart) {
  // In a process of its own, as the limit of file size is the process's.
  const std::string file = path("limited");
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{10, 10};
    setrlimit(RLIMIT_FSIZE, &limit);
    RowFile rows(file);
    const bool first = rows.append("12345\n");      // 6 of 10 bytes
    const bool second = rows.append("too long\n");  // 4 would fit
    const int reason = errno;
    const bool third = rows.append("abc\n");  // fits exactly
    _exit(first && !second && reason == EFBIG && third ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(content(file), "12345\nabc\n");
  fs::remove(file);
}

}  // namespace
}  // namespace prospect::row_file_test
