// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/comparison_page.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/views/report/report.h"
#include "tests/adapters/synthetic_run.h"

namespace prospect::comparison_page_test {
namespace {

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  EXPECT_NE(begin, std::string::npos) << from;
  if (begin == std::string::npos) return "";
  return text.substr(begin + from.size(), text.find(to, begin) - begin - from.size());
}

TEST(ComparisonPage, HoldsBothRunsAsTheirOwnPagesDo) {
  const RunRecord one = synthetic_run(30), other = synthetic_run(50);
  const std::string first = run_of_report(render_report(one), "a/report.html");
  EXPECT_EQ(first, report_run(one));
  Divergence parting;
  parting.step = 3;
  parting.time = 1.5;
  parting.what = "mode: explore, retreat";
  const std::string page =
      comparison_page({"a <b>", first}, {"{{run 1}}", report_run(other)}, parting);
  EXPECT_EQ(between(page, "id=\"run-1\">", "</script>"), report_run(one));
  EXPECT_EQ(between(page, "id=\"run-2\">", "</script>"), report_run(other));
  const auto data = nlohmann::json::parse(between(page, "id=\"comparison\">", "</script>"));
  EXPECT_EQ(data["names"][0], "a <b>");
  EXPECT_EQ(data["time"], 1.5);
  EXPECT_EQ(data["said"], "part at 1.5 s (step 3), mode: explore, retreat");
  // The page of each is there once, without a run.
  const std::string frame = data["frame"];
  EXPECT_EQ(between(frame, "id=\"run\">", "</script>"), data["place"].get<std::string>());
  EXPECT_EQ(page.find("a <b>"), std::string::npos);
  for (const char* fetched : {"src=\"http", "href=\"http", "@import"}) {
    EXPECT_EQ(page.find(fetched), std::string::npos) << fetched;
  }
}

TEST(ComparisonPage, WhatIsNoReportIsRefused) {
  const std::string whole = render_report(synthetic_run(5));
  for (const std::string& page :
       {std::string(), std::string("<html></html>"),
        whole.substr(0, whole.find("id=\"run\">") + 40),
        std::string("<script type=\"application/json\" id=\"run\">{\"steps\":1}</script>"),
        std::string("<script type=\"application/json\" id=\"run\">[]</script>")}) {
    try {
      run_of_report(page, "run/report.html");
      ADD_FAILURE() << page.substr(0, 80);
    } catch (const InputError& error) {
      const std::string said = error.what();
      EXPECT_EQ(said.rfind("run/report.html: ", 0), 0U) << said;
      EXPECT_NE(said.find("expected the report.html of a mission"), std::string::npos) << said;
    }
  }
}

TEST(ComparisonPage, SaysWhereTheyPart) {
  Divergence d;
  EXPECT_EQ(divergence_text(d), "the same as long as both last");
  d.step = 62;
  d.time = 12.4;
  d.what = "mode: explore, retreat";
  d.apart = 15.0;
  EXPECT_EQ(divergence_text(d),
            "part at 12.4 s (step 62), mode: explore, retreat; 0.5 m apart after 15.0 s");
}

}  // namespace
}  // namespace prospect::comparison_page_test
