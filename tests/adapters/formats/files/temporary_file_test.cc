// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/temporary_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace prospect::temporary_file_test {
namespace {

TEST(TemporaryFile, HoldsWhatIsAppendedAndGoesWithItsObject) {
  std::string path;
  std::ifstream opened;
  {
    TemporaryFile file("prospect_test", "to test");
    path = file.path();
    file.append("one, ");
    file.append("two");
    opened.open(path);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  std::string content;
  std::getline(opened, content);
  EXPECT_EQ(content, "one, two");
}

TEST(TemporaryFile, AllThatAreThereCanBeRemovedBeforeTheirTime) {
  std::vector<std::unique_ptr<TemporaryFile>> files;
  for (int n = 0; n < 3; ++n) {
    files.push_back(std::make_unique<TemporaryFile>("prospect_test", "to test"));
  }
  const std::string gone = files[1]->path();
  files.erase(files.begin() + 1);
  files.push_back(std::make_unique<TemporaryFile>("prospect_test", "to test"));
  std::ofstream(gone) << "somebody else's";
  remove_temporary_files();
  for (const auto& file : files) EXPECT_FALSE(std::filesystem::exists(file->path()));
  EXPECT_TRUE(std::filesystem::exists(gone));
  std::filesystem::remove(gone);
}

}  // namespace
}  // namespace prospect::temporary_file_test
