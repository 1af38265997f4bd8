// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace prospect {

// Pages that work offline: a template with {{places}}, filled with styles, data and scripts.

/// Fit for the text of an element or for a quoted attribute.
std::string escape_html(std::string_view text);

/// A library's text without the line that points a browser at a separate source map.
std::string library_text(std::string_view text);

/// Fit for a <script> element: inside JavaScript, </script can only stand in a string or a regular
/// expression, where \/ means /. Without the pointer to a source map.
std::string script_text(std::string_view text);

/// A page's own script, after what all pages share (page.js); fit for a <script> element.
std::string page_script(std::string_view own);

/// Fit for a <script> element: inside JSON, < can only stand in a string.
std::string json_text(const nlohmann::ordered_json& json);

/// The template with each place, "{{name}}", replaced by its text. One pass, so that nothing in a
/// filled-in text counts as a place; a place that is not among the parts becomes nothing.
std::string fill_page(std::string_view page,
                      const std::vector<std::pair<std::string_view, std::string>>& parts);

}  // namespace prospect
