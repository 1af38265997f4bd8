// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/robot_in_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "adapters/formats/files/input_error.h"
#include "tests/adapters/mesh_files.h"

namespace prospect::robot_in_world_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kRobot = "<model name=\"robot\"><pose>1 2 0.2 0 0 0</pose></model>";

std::string sdf(const std::string& content, const std::string& version = "1.5") {
  return "<?xml version='1.0'?>\n<sdf version='" + version + "'>\n" + content + "\n</sdf>\n";
}

struct InFolder {
  std::string problem(const std::string& text, const std::string& to) const {
    const std::string path = folder.write("a.world", text);
    try {
      gazebo_world_with_robot(path, kRobot, to);
    } catch (const InputError& error) {
      EXPECT_EQ(error.lines().size(), 1u);
      EXPECT_THAT(error.what(), HasSubstr("a.world:"));
      return error.what();
    }
    return "";
  }
  test::Folder folder{"robot in world"};
};

TEST(RobotInWorld, AllElseStays) {
  const InFolder in;
  const std::string path = in.folder.write(
      "b.world", "<!-- first -->\n" + sdf("<world name='w'><include><uri>model://cafe</uri>"
                                          "</include><actor name='a'><pose>0 1 0 0 0 0</pose>"
                                          "</actor></world>"));
  const std::string with = gazebo_world_with_robot(path, kRobot, "/");
  EXPECT_THAT(with, HasSubstr("<uri>model://cafe</uri>"));
  EXPECT_THAT(with, HasSubstr("<actor name=\"a\">"));
  EXPECT_THAT(with, HasSubstr("<pose>1 2 0.2 0 0 0</pose>"));
  EXPECT_LT(with.find("<actor"), with.find("<model name=\"robot\">"));
  EXPECT_LT(with.find("<model name=\"robot\">"), with.find("</world>"));
}

TEST(RobotInWorld, RefusesWhatItCannotBePutInto) {
  const InFolder in;
  EXPECT_THAT(in.problem(sdf("<world name='w'>"), "/"), HasSubstr("no whole XML"));
  EXPECT_THAT(in.problem("<robot/>", "/"), HasSubstr("no <sdf>"));
  EXPECT_THAT(in.problem(sdf("<model name='m'/>"), "/"), HasSubstr("a model without a <world>"));
  EXPECT_THAT(in.problem(sdf("<world name='w'/>", "1.4"), "/"), HasSubstr("a.world:2: SDF of"));
  EXPECT_THAT(in.problem(sdf("<world name='w'><model name='robot'/></world>"), "/"),
              HasSubstr("a.world:3: a model 'robot' is in it"));
  EXPECT_THAT(in.problem(sdf("<world name='w'><include><name>robot</name></include></world>"), "/"),
              HasSubstr("a model 'robot' is in it"));
}

TEST(RobotInWorld, FilesBesideTheWorldAreFoundFromItsOwnFolderOnly) {
  const InFolder in;
  in.folder.write("wall.obj", "v 0 0 0\n");
  const std::string world =
      sdf("<world name='w'><model name='m'><link name='l'><visual name='v'><geometry><mesh>\n"
          "<uri>wall.obj</uri></mesh></geometry></visual></link></model></world>");
  EXPECT_THAT(in.problem(world, "/"), HasSubstr("a.world:4: <uri> names 'wall.obj'"));
  EXPECT_EQ(in.problem(world, in.folder.path("")), "");
}

}  // namespace
}  // namespace prospect::robot_in_world_test
