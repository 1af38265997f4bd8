// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/map_page.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "perception/mapping/scan_mapper.h"

namespace prospect::map_page_test {
namespace {

MapRun run_of(bool mapped) {
  MapRun run;
  ScanMapper mapper;
  for (int k = 0; k < 3; ++k) {
    DepthScan scan;
    for (int i = 0; i < 20; ++i) scan.hits.emplace_back(1.5, -1.0 + 0.1 * i, 0.0);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << (k == 2 ? 50.0 : 0.1 * k), 0.0, 0.35;
    MapRunFrame frame;
    frame.mapped = mapper.process(k, scan, T);
    run.frames.push_back(frame);
  }
  if (mapped) run.maps = mapper.map().snapshot();
  return run;
}

nlohmann::ordered_json data_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"run\">";
  const auto begin = page.find(open) + open.size();
  return nlohmann::ordered_json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

const nlohmann::ordered_json kSummary = {{"dataset", "/data/<hall>/"}, {"notes", {"a </script>"}}};

TEST(MapPage, IsOneWholeFile) {
  const std::string page = map_page(run_of(true), kSummary);
  EXPECT_EQ(page, map_page(run_of(true), kSummary)) << "the same bytes for the same run";
  const auto has = [&](const std::string& part) { return page.find(part) != std::string::npos; };
  EXPECT_TRUE(has("<title>&lt;hall&gt; – map</title>"));
  for (const char* place :
       {"title", "library style", "style", "run", "library", "three", "controls", "script"}) {
    EXPECT_FALSE(has("{{" + std::string(place) + "}}")) << place;
  }
  for (const char* fetched : {"src=\"http", "href=\"http", "@import", "url(http"}) {
    EXPECT_FALSE(has(fetched)) << fetched;
  }
  EXPECT_TRUE(has("three.js r111, copyright")) << "the libraries' licence stays with them";
  EXPECT_TRUE(has("© 2010-2019 three.js authors"));
  EXPECT_TRUE(has("Dan Vanderkam"));
  EXPECT_TRUE(
      has("The above copyright notice and this permission notice shall be included in all"));
  EXPECT_TRUE(has("REVISION=\"111\"")) << "which the page names";
  const auto data = data_of(page);
  EXPECT_EQ(data["frames"], 3);
  EXPECT_EQ(data["reasons"]["2"], "the pose jumps");
  EXPECT_GT(data["voxels"]["rectangles"].get<int>(), 5);
  EXPECT_EQ(data["summary"]["notes"][0], "a </script>");
  EXPECT_EQ(data["ground"]["resolution"], 0.1);
}

TEST(MapPage, WithoutAMapItHasNoLibraryForIt) {
  const std::string page = map_page(run_of(false), kSummary);
  EXPECT_LT(page.size(), 300'000u);
  EXPECT_TRUE(data_of(page)["voxels"].is_null());
  EXPECT_TRUE(data_of(page)["ground"].is_null());
}

TEST(MapPage, WithLoopsHoldsBothMaps) {
  MapRun with = run_of(true);
  with.loops = MapRunLoops{5, 4, 0.5};
  for (MapRunFrame& frame : with.frames) frame.mapped.T_WC.translation().y() += 0.5;
  auto summary = kSummary;
  summary["loops"] = {{"used", 4}};
  const auto data = data_of(map_page(with, summary, run_of(true), kSummary));
  EXPECT_EQ(data["summary"]["loops"]["used"], 4);
  const auto& drawn = data["drawn"];
  EXPECT_EQ(drawn["summary"], kSummary);
  EXPECT_EQ(drawn["voxels"]["occupied"], data["voxels"]["occupied"]);
  EXPECT_EQ(drawn["columns"]["x"], data["columns"]["x"]);
  EXPECT_NE(drawn["columns"]["y"], data["columns"]["y"]);
  EXPECT_FALSE(data_of(map_page(with, summary)).contains("drawn"));
}

TEST(MapPage, HypothesesOfTheFloorHaveTheirCourse) {
  MapRun run = run_of(true);
  run.ground = {
      {.frame = 0, .hypothesis = 0, .height = 0.4, .support = 1, .taken = true, .why = "alone"},
      {.frame = 1, .hypothesis = 0, .height = 0.41, .support = 1, .why = "a table"},
      {.frame = 1, .hypothesis = 1, .height = 1.4, .support = 1, .taken = true, .why = "lower"}};
  const auto floors = data_of(map_page(run, kSummary))["hypotheses"];
  ASSERT_EQ(floors.size(), 2u);
  EXPECT_EQ(floors[0]["frames"], (std::vector<int>{0, 1}));
  EXPECT_EQ(floors[0]["taken"], (std::vector<bool>{true, false}));
  EXPECT_EQ(floors[1]["height"][0], 1.4);
  EXPECT_EQ(floors[1]["why"], "lower");
}

}  // namespace
}  // namespace prospect::map_page_test
