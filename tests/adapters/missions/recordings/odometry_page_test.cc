// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/odometry_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

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
                 bool truth = true) {
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
  return page.html(summary);
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

TEST(OdometryPage, RefusesNoFrames) {
  EXPECT_THROW(OdometryPage(0), std::invalid_argument);
  EXPECT_THROW(OdometryPage(5, 0), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::odometry_page_test
