// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/architecture/include_rules.h"

namespace prospect::test::includes_test {
namespace {

namespace fs = std::filesystem;

/// A tree of source files in a folder of its own.
class Tree {
 public:
  Tree() : root_(fs::path(::testing::TempDir()) / "prospect includes") { fs::remove_all(root_); }
  ~Tree() { fs::remove_all(root_); }
  Tree& add(const std::string& path, const std::string& text) {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
    return *this;
  }
  std::vector<std::string> forbidden() const { return forbidden_includes(root_); }
  std::vector<std::string> outside() const { return outside_rooms(root_); }
  std::string loop() const { return include_loop(root_); }

 private:
  fs::path root_;
};

TEST(Includes, EveryRoomUsesOnlyWhatItMay) {
  const fs::path root = PROSPECT_SOURCE_DIR;
  for (const auto& [room, rules] : architecture()) EXPECT_TRUE(fs::exists(root / room)) << room;
  for (const std::string& line : forbidden_includes(root)) ADD_FAILURE() << line;
}

TEST(Includes, NoSourceLiesOutsideTheRooms) {
  for (const std::string& path : outside_rooms(PROSPECT_SOURCE_DIR)) ADD_FAILURE() << path;
  EXPECT_THAT(Tree().add("engine/street.h", "").add("engine/maps/a.h", "").outside(),
              testing::ElementsAre("engine/street.h"));
}

TEST(Includes, TheGraphHasNoLoop) {
  EXPECT_EQ(upward_rule(), "");
  EXPECT_EQ(include_loop(PROSPECT_SOURCE_DIR), "");
  Tree tree;
  tree.add("models/a.h", "#include \"models/b.h\"\n").add("models/b.h", "");
  EXPECT_EQ(tree.loop(), "");
  tree.add("models/b.h", "#include \"models/c.h\"\n")
      .add("models/c.h", "#include \"models/b.h\"\n");
  EXPECT_EQ(tree.loop(), "models/b.h models/c.h models/b.h");
}

TEST(Includes, EachForbiddenDirectionIsCaught) {
  struct Case {
    const char *path, *include, *why;
  };
  for (const Case& c : {
           Case{"models/a.cc", "\"engine/maps/grid.h\"", "models may not use engine/maps/grid.h"},
           Case{"models/a.h", "<octomap/OcTree.h>", "models may not use octomap"},
           Case{"engine/maps/a.cc", "\"solvers/registry.h\"",
                "engine/maps may not use solvers/registry.h"},
           Case{"engine/behaviour/a.cc", "\"engine/maps/belief.h\"",
                "engine/behaviour may not use engine/maps/belief.h"},
           Case{"engine/behaviour/monitors/a.h", "\"engine/problem/solver.h\"",
                "engine/behaviour may not use engine/problem/solver.h"},
           Case{"engine/problem/a.h", "\"engine/maps/grid.h\"",
                "engine/problem may not use engine/maps/grid.h"},
           Case{"engine/maps/a.h", "\"engine/planner/planner.h\"",
                "engine/maps may not use engine/planner/planner.h"},
           Case{"engine/terms/a.h", "\"engine/frontiers/frontiers.h\"",
                "engine/terms may not use engine/frontiers/frontiers.h"},
           Case{"solvers/a.h", "\"engine/maps/grid.h\"", "solvers may not use engine/maps/grid.h"},
           Case{"engine/planner/a.cc", "\"runtime/mission.h\"",
                "engine/planner may not use runtime/mission.h"},
           Case{"perception/mapping/a.h", "\"perception/fusion/wheel_fusion.h\"",
                "perception/mapping may not use perception/fusion/wheel_fusion.h"},
           Case{"perception/fusion/a.cc", "\"perception/pipeline/belief_builder.h\"",
                "perception/fusion may not use perception/pipeline/belief_builder.h"},
           Case{"adapters/missions/config/a.cc", "\"adapters/formats/worlds/world.h\"",
                "adapters/missions/config may not use adapters/formats/worlds/world.h"},
           Case{"adapters/missions/config/a.h", "\"adapters/robots/simulator/simulator.h\"",
                "adapters/missions/config may not use adapters/robots/simulator/simulator.h"},
           Case{"adapters/missions/run/a.cc", "\"adapters/views/report/report.h\"",
                "adapters/missions/run may not use adapters/views/report/report.h"},
           Case{"engine/terms/a.cc", "\"perception/mapping/occupancy_mapper.h\"",
                "engine/terms may not use perception/"},
           Case{"engine/maps/a.cc", "\"adapters/program/cli/commands.h\"",
                "engine/maps may not use adapters/"},
           Case{"engine/maps/a.cc", "<nlopt.h>", "engine/maps may not use nlopt"},
           Case{"engine/maps/a.cc", "<nlopt.hpp>", "engine/maps may not use nlopt"},
           Case{"engine/maps/a.cc", "<IpTNLP.hpp>", "engine/maps may not use Ipopt"},
           Case{"engine/maps/a.cc", "<coin/IpTNLP.hpp>", "engine/maps may not use Ipopt"},
           Case{"engine/maps/a.cc", "<ceres/ceres.h>", "engine/maps may not use ceres"},
           Case{"engine/maps/a.cc", "<opencv2/core.hpp>", "engine/maps may not use opencv2"},
           Case{"engine/maps/a.h", "<fcl/geometry/shape/box.h>", "forward-declare"},
           Case{"engine/maps/a.h", "<octomap/OcTree.h>", "forward-declare"},
           Case{"solvers/a.cc", "\"perception/mapping/occupancy_mapper.h\"",
                "solvers may not use perception/"},
           Case{"solvers/a.h", "<IpTNLP.hpp>", "forward-declare"},
           Case{"solvers/nlopt/a.h", "<nlopt.h>", "forward-declare"},
           Case{"solvers/a.cc", "<fcl/narrowphase/distance.h>", "solvers may not use fcl"},
           Case{"perception/odometry/a.cc", "\"solvers/registry.h\"",
                "perception/odometry may not use solvers/"},
           Case{"perception/odometry/a.h", "<opencv2/core.hpp>", "forward-declare"},
           Case{"perception/odometry/a.cc", "\"adapters/missions/run/run_record.h\"",
                "perception/odometry may not use adapters/"},
           Case{"adapters/program/cli/a.cc", "\"tests/engine/view_worlds.h\"",
                "adapters/program/cli may not use tests/"},
           Case{"engine/maps/a.cc", "\"problems/r1.h\"", "engine/maps may not use problems/"},
           Case{"problems/a.cc", "\"solvers/registry.h\"", "problems may not use solvers/"},
           Case{"engine/maps/a.cc", "<boost/optional.hpp>", "engine/maps may not use boost"},
       }) {
    const auto found =
        Tree()
            .add(c.path, std::string("// a comment\n  #  include ") + c.include + "  // why\n")
            .forbidden();
    ASSERT_EQ(found.size(), 1u) << c.path << " with " << c.include;
    EXPECT_NE(found[0].find(std::string(c.path) + ":2: "), std::string::npos) << found[0];
    EXPECT_NE(found[0].find(c.why), std::string::npos) << found[0];
  }
}

TEST(Includes, WhatIsAllowedPasses) {
  Tree tree;
  tree.add("models/a.h", "#include <Eigen/Core>\n#include \"models/types.h\"\n#include <vector>\n")
      .add("engine/maps/a.cc", "#include <octomap/OcTree.h>\n#include <fcl/math/bv/AABB.h>\n")
      .add("solvers/a.cc", "#include <nlopt.h>\n#include \"engine/problem/solver.h\"\n")
      .add("adapters/program/cli/a.cc",
           "#include <sys/ioctl.h>\n#include \"perception/mapping/occupancy_mapper.h\"\n")
      .add("engine/maps/notes.md", "#include \"solvers/registry.h\"\n")
      .add("benchmarks/a.cc", "#include \"adapters/missions/run/run_record.h\"\n");
  EXPECT_EQ(tree.forbidden(), std::vector<std::string>());
}

}  // namespace
}  // namespace prospect::test::includes_test
