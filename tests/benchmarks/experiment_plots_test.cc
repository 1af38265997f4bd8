#include "benchmarks/experiments/experiment_plots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "adapters/files/input_error.h"

namespace prospect::experiment_plots_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::vector<ExperimentRow> rows_of(const std::string& sensors) {
  std::vector<ExperimentRow> rows;
  for (const char* condition : {"with", "without"}) {
    for (const char* world : {"office", "../maps/it's 100 %.bt"}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        ExperimentRow r;
        r.world = world;
        r.condition = condition;
        r.seed = seed;
        r.sensors = sensors;
        r.reason = "explored";
        r.losses = 3.0 * static_cast<double>(seed) + (r.condition == "without" ? 2.0 : 0.0);
        // No error at all: nothing to show on a logarithmic axis.
        r.error_rms_m = seed == 1 ? 0.0 : 0.1 * static_cast<double>(seed);
        rows.push_back(r);
      }
    }
  }
  return rows;
}

class ExperimentPlots : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::remove_all(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  const std::string folder_ =
      (std::filesystem::temp_directory_path() / "prospect plot's" / "new").string();
};

TEST_F(ExperimentPlots, DrawsRatiosAndPairs) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "gnuplot is not installed";
  }
  std::vector<ExperimentRow> rows = rows_of("model");
  for (const ExperimentRow& r : rows_of("camera")) rows.push_back(r);
  const std::vector<std::string> pictures = write_experiment_plots(rows, folder_);
  EXPECT_THAT(pictures, ElementsAre(folder_ + "/ratios.svg", folder_ + "/pairs_model_without.svg",
                                    folder_ + "/pairs_camera_without.svg"));
  for (const std::string& picture : pictures) EXPECT_THAT(content(picture), HasSubstr("</svg>"));
  EXPECT_THAT(content(pictures[0]), HasSubstr("without / with, cameras, 6 pairs"));
  EXPECT_THAT(content(pictures[0]), HasSubstr("losses of localization"));
  EXPECT_THAT(content(pictures[1]), HasSubstr("it's 100 %.bt"));
  EXPECT_THAT(content(pictures[1]), Not(HasSubstr("maps"))) << "file names in the key, no folders";
  // 24 of 18 losses a world, and the pair of seed 2.
  EXPECT_THAT(content(folder_ + "/ratios.gp"), HasSubstr("\n1.33333 "));
  EXPECT_THAT(content(folder_ + "/pairs_model_without.gp"), HasSubstr("\n6 8\n"));
  EXPECT_THAT(content(folder_ + "/pairs_model_without.gp"), Not(HasSubstr("\n0 0\n")));
}

TEST_F(ExperimentPlots, WithoutPairsThereIsNothingToDraw) {
  std::vector<ExperimentRow> rows = rows_of("model");
  std::erase_if(rows, [](const ExperimentRow& r) { return r.condition == "without"; });
  EXPECT_TRUE(write_experiment_plots(rows, folder_).empty());
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(ExperimentPlots, SaysWhereItCannotWrite) {
  std::filesystem::create_directories(std::filesystem::path(folder_).parent_path());
  std::ofstream(folder_) << "a file";
  try {
    write_experiment_plots(rows_of("model"), folder_);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr(folder_));
  }
}

}  // namespace
}  // namespace prospect::experiment_plots_test
