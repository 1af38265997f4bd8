// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/odometry_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/views/page/binary_text.h"
#include "tests/perception/rendered_room.h"

namespace prospect::odometry_page_test {
namespace {

using test::RenderedRoom;
using ::testing::HasSubstr;
using ::testing::Not;

StereoCamera camera() {
  StereoCamera c;
  c.left = {220.0, 220.0, 160.0, 120.0, 320.0, 240.0};
  return c;
}

/// The page of a run over so many frames, the last of which is blank.
std::string page(int frames, int max_images, const nlohmann::ordered_json& summary,
                 bool truth = true, const OdometryLoopsResult* loops = nullptr) {
  StereoOdometry odometry(camera());
  OdometryPage page(frames, max_images);
  for (int k = 0; k < frames; ++k) {
    const Eigen::Isometry3d T_WC = RenderedRoom::looking(-1.0 + 0.04 * k, 0.0, 1.05, 0.01 * k);
    const auto seen = RenderedRoom().render(camera(), T_WC, 2.0, static_cast<std::uint64_t>(k));
    StereoDataset::Pair pair{seen.left, seen.right};
    if (k == frames - 1) pair = {Image(320, 240, 90), Image(320, 240, 90)};
    const OdometryFrame frame = odometry.process(0.1 * k, pair.left.view(), pair.right.view());
    page.add({k + 1, frame, odometry, pair,
              truth ? std::optional<Eigen::Isometry3d>(T_WC) : std::nullopt});
  }
  return page.html(summary, loops);
}

nlohmann::ordered_json run_of(const std::string& html) {
  const std::string begin = "<script type=\"application/json\" id=\"run\">";
  const std::size_t from = html.find(begin) + begin.size();
  return nlohmann::ordered_json::parse(html.substr(from, html.find("</script>", from) - from));
}

TEST(OdometryPage, HoldsEveryFrameAndSomeImages) {
  const auto run = run_of(page(9, 4, {{"dataset", "a <b>/"}}));
  EXPECT_EQ(run.at("frames"), 9);
  ASSERT_EQ(run.at("pictures").size(), 3u);  // every third: the most that are not more than four
  EXPECT_EQ(run.at("pictures").at(2).at("frame"), 6);
  EXPECT_EQ(run.at("pictures").at(0).at("width"), 320);
  EXPECT_THAT(run.at("pictures").at(0).at("jpeg").get<std::string>(),
              ::testing::StartsWith("/9j/"));
  EXPECT_THAT(run.at("reasons").at("8").get<std::string>(), HasSubstr("too few points"));
}

TEST(OdometryPage, FetchesNothingAndEscapesNames) {
  const std::string html = page(2, 4, {{"dataset", "recordings/a <b>/"}});
  EXPECT_THAT(html, HasSubstr("<h1>a &lt;b&gt;</h1>"));
  EXPECT_FALSE(std::regex_search(html, std::regex(R"re((src|href)\s*=\s*["'](?!data:))re")));
  for (const char* place : {"{{title}}", "{{style}}", "{{run}}", "{{library}}", "{{script}}"}) {
    EXPECT_THAT(html, Not(HasSubstr(place)));
  }
}

TEST(OdometryPage, SameFramesSameBytes) {
  EXPECT_EQ(page(3, 4, {{"dataset", "x"}}), page(3, 4, {{"dataset", "x"}}));
}

TEST(OdometryPage, WithoutTruthThereAreNoErrors) {
  const auto with = run_of(page(3, 4, {{"dataset", "x"}}));
  const auto without = run_of(page(3, 4, {{"dataset", "x"}}, false));
  EXPECT_NE(with.at("columns").at("error"), without.at("columns").at("error"));
  EXPECT_EQ(with.at("columns").at("sigma"), without.at("columns").at("sigma"));
}

TEST(OdometryPage, ShowsThePathWithLoopsAndWhereTheyAre) {
  OdometryLoopsResult loops;
  loops.used = 1;
  // Frame 1 has no pose. Seen from above as the odometry's own path, which begins at a level
  // camera.
  for (const double stamp : {0.0, 0.2}) {
    loops.final.push_back({stamp, RenderedRoom::looking(3.0 + stamp, 2.0, 1.05, 0.0)});
  }
  loops.loops.push_back({0.0, 0.2, {3.0, 2.0, 1.05}, {3.2, 2.5, 1.05}});
  const nlohmann::ordered_json summary = {{"dataset", "x"}, {"loops", {{"used", 1}}}};
  const auto run = run_of(page(4, 4, summary, true, &loops));
  ASSERT_EQ(run.at("loops").size(), 1u);
  const auto& loop = run.at("loops").at(0);
  EXPECT_EQ(loop.at("older"), 0);
  EXPECT_EQ(loop.at("newer"), 2);
  const std::size_t x = run.at("axes").at(0) == "x" ? 0 : 1;
  ASSERT_EQ(run.at("axes").at(1 - x), "z");
  EXPECT_DOUBLE_EQ(loop.at("from").at(x), 3.0);
  EXPECT_DOUBLE_EQ(loop.at("to").at(1 - x), 1.05);
  const std::string path = run.at("columns").at(x == 0 ? "looped_x" : "looped_y");
  BinaryText expected;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double v : {3.0, nan, 3.2, nan}) expected.add_float(v);
  EXPECT_EQ(path, expected.base64());
  EXPECT_FALSE(run_of(page(3, 4, summary)).contains("loops"));
}

TEST(OdometryPage, RefusesNoFrames) {
  EXPECT_THROW(OdometryPage(0), std::invalid_argument);
  EXPECT_THROW(OdometryPage(5, 0), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::odometry_page_test
