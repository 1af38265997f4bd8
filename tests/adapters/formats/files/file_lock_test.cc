// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/file_lock.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace prospect::file_lock_test {
namespace {

TEST(FileLock, IsHeldByOneUntilItIsGone) {
  const std::string path = testing::TempDir() + "file_lock_" + std::to_string(getpid());
  std::ofstream(path) << "kept";
  {
    FileLock first(path);
    EXPECT_TRUE(first.held());
    const FileLock second(path);
    EXPECT_FALSE(second.held());
    EXPECT_TRUE(second.busy());
    EXPECT_NE(second.reason(), "");
    const FileLock moved = std::move(first);
    EXPECT_TRUE(moved.held());
    EXPECT_TRUE(FileLock(path).busy()) << "moved, not given up";
  }
  EXPECT_TRUE(FileLock(path).held());
  EXPECT_EQ(std::filesystem::file_size(path), 4U) << "what it holds stays";
  std::filesystem::remove(path);
}

TEST(FileLock, SaysWhyThereIsNoFile) {
  const FileLock lock("/nowhere/at/all");
  EXPECT_FALSE(lock.held());
  EXPECT_FALSE(lock.busy());
  EXPECT_EQ(lock.reason(), "No such file or directory");
}

}  // namespace
}  // namespace prospect::file_lock_test
