// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "adapters/missions/bench/bench_rows.h"
#include "adapters/missions/bench/bench_table.h"

namespace prospect::test {

/// A folder of the running test's own, in which benches lie as `prospect bench` leaves them;
/// removed with the test.
class BenchFolders : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(folder_); }
  /// The path of the bench that holds this table.
  std::string write(const std::string& name, const BenchTable& table) const {
    const std::string path = folder_ + "/" + name;
    std::filesystem::create_directories(path);
    const BenchRowFile rows(path, table);
    return path;
  }
  const ::testing::TestInfo& test_ = *::testing::UnitTest::GetInstance()->current_test_info();
  const std::string folder_ = ::testing::TempDir() + test_.test_suite_name() + "_" + test_.name();
};

}  // namespace prospect::test
