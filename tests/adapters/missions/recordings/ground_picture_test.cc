// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/ground_picture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "adapters/formats/worlds/ros_map.h"

namespace prospect::ground_picture_test {
namespace {

namespace fs = std::filesystem;

class Pictures : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("prospect picture " + std::to_string(::getpid()));
    fs::create_directories(folder_);
    std::mt19937 generator(3);
    for (int j = -7; j < 31; ++j) {
      for (int i = -40; i < 5; ++i) {
        map_.set({i, j}, static_cast<CellState>(generator() % 3));
      }
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  World read_back(const GroundPicture& picture) {
    std::ofstream(folder_ / "map.png", std::ios::binary) << picture.png;
    std::ofstream(folder_ / "map.yaml") << picture.yaml;
    WorldOptions options;
    options.resolution = 0.05;
    return world_from_ros_map((folder_ / "map.yaml").string(), options);
  }

  fs::path folder_;
  GroundMap map_{GridFrame{0.05, 0, 0, 16, 16}};
};

TEST_F(Pictures, OfObstaclesIsReadBackCellForCell) {
  const World world = read_back(obstacle_picture(map_, "map.png"));
  const GridFrame f = map_.frame();
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    EXPECT_EQ(world.voxels.state(c.i, c.j, 1), map_.state(c)) << c.i << " " << c.j;
  }
}

TEST_F(Pictures, OfExplorationIsReadBackCellForCell) {
  const World world = read_back(exploration_picture(map_, "map.png"));
  const GridFrame f = map_.frame();
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    EXPECT_EQ(world.voxels.state(c.i, c.j, 1) != CellState::kUnknown, map_.explored(c));
  }
}

TEST_F(Pictures, IsCutToWhatIsKnown) {
  const GroundPicture picture = obstacle_picture(map_, "map.png");
  EXPECT_NE(picture.yaml.find("origin: [-2, -0.35"), std::string::npos) << picture.yaml;
  EXPECT_NE(picture.yaml.find("image: map.png\n"), std::string::npos);
}

TEST_F(Pictures, OfNothingIsAnImage) {
  EXPECT_FALSE(obstacle_picture(GroundMap(GridFrame{0.05, 0, 0, 16, 16}), "map.png").png.empty());
}

}  // namespace
}  // namespace prospect::ground_picture_test
