// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/map_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/ros_map.h"
#include "tests/adapters/formats/field_outcomes.h"

namespace prospect::map_fields_test {
namespace {

namespace fs = std::filesystem;

class RosMapFields : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("prospect map fields " + std::to_string(::getpid()));
    fs::create_directories(folder_);
    // White, a black wall, and greys on both sides of each threshold.
    for (const int wall : {10, 12}) {
      std::ofstream image(folder_ / ("wall_at_" + std::to_string(wall) + ".pgm"));
      image << "P2\n40 40\n255\n";
      for (int n = 0; n < 1600; ++n) {
        const int column = n % 40;
        image << (column == wall ? 0 : column == 20 ? 100 : column == 30 ? 200 : 254) << '\n';
      }
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// What is read of a map with another value of a key.
  std::string read(const std::string& key, const std::string& value) const {
    std::map<std::string, std::string> keys{{"image", "wall_at_10.pgm"}, {"resolution", "0.1"},
                                            {"origin", "[-2, -2, 0]"},   {"negate", "0"},
                                            {"free_thresh", "0.1"},      {"occupied_thresh", "0.9"},
                                            {"mode", "trinary"}};
    if (!key.empty()) keys[key] = value;
    std::ofstream yaml(folder_ / "map.yaml");
    for (const auto& [name, text] : keys) yaml << name << ": " << text << '\n';
    yaml.close();
    std::ostringstream out;
    try {
      const World world = world_from_ros_map((folder_ / "map.yaml").string());
      const GridFrame& frame = world.voxels.frame();
      out << frame.resolution << ' ' << frame.i0 << ' ' << frame.j0 << ' ' << frame.width << ' '
          << frame.height << ' ';
      for (const CellState state : world.voxels.data()) out << static_cast<int>(state);
      left_out_ = world.left_out.text();
    } catch (const InputError& error) {
      return std::string("refused: ") + error.what();
    }
    return out.str();
  }

  fs::path folder_;
  mutable std::string left_out_;
};

TEST_F(RosMapFields, EachKeyIsWhatTheTableSays) {
  test::expect_fields(ros_map_fields(),
                      {{"image", {"wall_at_12.pgm"}},
                       {"resolution", {"0.2", "0.125"}},
                       {"origin", {"[-1, -2, 0]", "[-2, -1, 0]", "[-2, -2, 0.5]"}},
                       {"negate", {"1"}},
                       {"free_thresh", {"0.3"}},
                       {"occupied_thresh", {"0.5", "0.2"}},
                       {"mode", {"raw"}}},
                      [this](const auto& key, const auto& value) { return read(key, value); });
}

TEST_F(RosMapFields, NamesAllThatIsReadAndWhatIsNotIsTold) {
  std::set<std::string> listed;
  for (const FieldRule& rule : ros_map_fields()) listed.insert(rule.name);
  EXPECT_EQ(test::keys_asked_for("adapters/formats/worlds/ros_map.cc", R"(root\.\w+\(\s*"(\w+)\")"),
            listed);
  EXPECT_EQ(read("building", "north"), read("", ""));
  read("building", "north");
  EXPECT_THAT(left_out_, ::testing::HasSubstr("key 'building'"));
  EXPECT_THAT(read("resolutoin", "1"), ::testing::StartsWith("refused"));
}

}  // namespace
}  // namespace prospect::map_fields_test
