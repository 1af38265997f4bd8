// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_page.h"

#include <nlohmann/json.hpp>

#include "adapters/missions/bench/bench_assets.h"
#include "adapters/views/page/html_page.h"
#include "adapters/views/page/page_assets.h"

namespace prospect {

std::string bench_page(const nlohmann::ordered_json& bench) {
  std::string title;
  for (const auto& set : bench.at("sets")) {
    title += (title.empty() ? "" : ", ") + set.at("name").get<std::string>();
  }
  return fill_page(
      bench_assets::bench_html(),
      {{"{{title}}", escape_html(title)},
       {"{{library style}}", library_text(page_assets::dygraph_style())},
       {"{{style}}", std::string(page_assets::style()) + std::string(bench_assets::bench_css())},
       {"{{bench}}", json_text(bench)},
       {"{{library}}", script_text(page_assets::dygraph_script())},
       {"{{script}}", page_script(bench_assets::bench_js())}});
}

}  // namespace prospect
