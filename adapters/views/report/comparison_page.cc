// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/comparison_page.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "adapters/formats/files/input_error.h"
#include "adapters/views/page/html_page.h"
#include "adapters/views/page/page_assets.h"
#include "adapters/views/report/report.h"
#include "adapters/views/report/report_assets.h"
#include "models/formatted.h"

namespace prospect {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kBefore = "<script type=\"application/json\" id=\"run\">";
constexpr std::string_view kAfter = "</script>";
constexpr const char* kPlace = "@run@";  // of the run in a page without one

}  // namespace

std::string divergence_text(const Divergence& divergence) {
  if (divergence.step < 0) return "the same as long as both last";
  std::string text =
      formatted("part at %.1f s (step %d), ", divergence.time, divergence.step) + divergence.what;
  if (std::isfinite(divergence.apart)) {
    text += formatted("; %.1f m apart after %.1f s", Divergence::kApart, divergence.apart);
  }
  return text;
}

std::string run_of_report(const std::string& page, const std::string& path) {
  const auto none = [&](const char* what) {
    fail(path, std::string(what) + "; expected the report.html of a mission");
  };
  const std::size_t before = page.find(kBefore);
  if (before == std::string::npos) none("holds no run");
  const std::size_t from = before + kBefore.size(), to = page.find(kAfter, from);
  if (to == std::string::npos) none("is cut");
  std::string run = page.substr(from, to - from);
  const Json json = Json::parse(run, nullptr, false);
  for (const char* part : {"summary", "configuration", "columns", "words", "map", "horizon"}) {
    if (!json.is_object() || !json.contains(part)) none("holds no run");
  }
  return run;
}

std::string comparison_page(const ComparedRun& first, const ComparedRun& second,
                            const Divergence& divergence) {
  ReportPage frame;
  frame.title = "mission";
  frame.run = kPlace;
  frame.style = report_assets::comparison_frame_style();
  frame.script = report_assets::comparison_frame_script();
  Json data = {{"names", {first.name, second.name}},
               {"place", kPlace},
               {"frame", render_page(frame)},
               {"said", divergence_text(divergence)},
               {"step", divergence.step}};
  data["time"] = divergence.step < 0 ? Json() : Json(divergence.time);
  return fill_page(report_assets::comparison_page(),
                   {{"{{first}}", escape_html(first.name)},
                    {"{{second}}", escape_html(second.name)},
                    {"{{library style}}", library_text(page_assets::dygraph_style())},
                    {"{{style}}", std::string(page_assets::style()) +
                                      std::string(report_assets::comparison_style())},
                    {"{{comparison}}", json_text(data)},
                    {"{{run 1}}", first.run},
                    {"{{run 2}}", second.run},
                    {"{{library}}", script_text(page_assets::dygraph_script())},
                    {"{{script}}", page_script(report_assets::comparison_script())}});
}

}  // namespace prospect
