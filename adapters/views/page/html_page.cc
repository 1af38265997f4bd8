// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/page/html_page.h"

#include <nlohmann/json.hpp>

#include "adapters/views/page/page_assets.h"

namespace prospect {
namespace {

std::string replace_all(std::string_view text, std::string_view from, std::string_view to) {
  std::string result;
  for (std::size_t at = 0;;) {
    const std::size_t found = text.find(from, at);
    result += text.substr(at, found - at);
    if (found == std::string_view::npos) return result;
    result += to;
    at = found + from.size();
  }
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string library_text(std::string_view text) {
  const std::size_t at = text.rfind("sourceMappingURL=");
  return std::string(at == std::string_view::npos ? text : text.substr(0, text.rfind('\n', at)));
}

std::string script_text(std::string_view text) {
  return replace_all(library_text(text), "</script", "<\\/script");
}

std::string page_script(std::string_view own) {
  return script_text(std::string(page_assets::page_script()) + std::string(own));
}

std::string json_text(const nlohmann::ordered_json& json) {
  return replace_all(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace),
                     "<", "\\u003c");
}

std::string fill_page(std::string_view page,
                      const std::vector<std::pair<std::string_view, std::string>>& parts) {
  std::string html;
  for (std::size_t at = 0;;) {
    const std::size_t open = page.find("{{", at);
    html += page.substr(at, open - at);
    if (open == std::string_view::npos) return html;
    at = page.find("}}", open) + 2;
    const std::string_view place = page.substr(open, at - open);
    for (const auto& [name, text] : parts) {
      if (name == place) html += text;
    }
  }
}

}  // namespace prospect
