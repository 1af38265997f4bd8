// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_page.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "adapters/missions/study/study_assets.h"
#include "adapters/missions/study/study_drawing.h"
#include "adapters/views/page/html_page.h"
#include "adapters/views/page/page_assets.h"
#include "adapters/views/report/run_figure.h"

namespace prospect {
namespace {

std::string fixed(double value, int digits) {
  if (!std::isfinite(value)) return "&ndash;";
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", digits, value);
  return buffer.data();
}

std::string with_interval(const MeanInterval& i, int digits) {
  if (!std::isfinite(i.mean)) return "&ndash;";
  return fixed(i.mean, digits) + " <small>[" + fixed(i.low, digits) + ", " + fixed(i.high, digits) +
         "]</small>";
}

std::string p_text(double p) { return p < 0.001 ? "&lt; 0.001" : fixed(p, 3); }

/// Below what a p value of `count` of them is beyond chance (Bonferroni).
double corrected_limit(std::size_t count) { return 0.05 / static_cast<double>(count); }

/// The chief numbers, or all.
std::string comparison_table(const StudyComparison& c, bool all) {
  std::string html =
      "<div class=\"scroll\"><table class=\"numbers\"><thead><tr><th></th>"
      "<th>reference, median</th><th>other, median</th><th>pairs</th>"
      "<th>mean difference [95 %]</th><th>ratio of means [95 %]</th><th>p</th></tr>"
      "</thead><tbody>";
  for (const NumberComparison& n : c.numbers) {
    if (!all && !n.number->chief) continue;
    const int digits = n.number->digits;
    const bool sure = n.pairs > 0 && n.p < corrected_limit(c.numbers.size());
    html += std::string("<tr") + (sure ? " class=\"sure\"" : "") + "><th>" +
            escape_html(n.number->label) + "</th>";
    if (n.pairs == 0) {
      html += "<td></td><td></td><td>0</td><td></td><td></td><td></td></tr>";
      continue;
    }
    html += "<td>" + fixed(n.median_reference, digits) + "</td><td>" +
            fixed(n.median_other, digits) + "</td><td>" + std::to_string(n.pairs);
    if (n.only_reference + n.only_other > 0) {
      html += " <small>(one side only: " + std::to_string(n.only_reference) + " / " +
              std::to_string(n.only_other) + ")</small>";
    }
    html += "</td><td>" + with_interval(n.difference, digits) + "</td><td>" +
            with_interval(n.ratio, 2) + "</td><td>" + p_text(n.p) + "</td></tr>";
  }
  return html + "</tbody></table></div>";
}

/// Ratios of the chief numbers in each world or set.
std::string input_table(const std::vector<StudyComparison>& inputs, bool benches) {
  if (inputs.empty()) return "";
  std::string html = std::string("<details><summary>Ratio of means by ") +
                     (benches ? "set" : "world") +
                     "</summary><div class=\"scroll\"><table "
                     "class=\"numbers\"><thead><tr><th></th><th>pairs</th>";
  for (const NumberComparison& n : inputs.front().numbers) {
    if (n.number->chief) html += "<th>" + escape_html(n.number->label) + "</th>";
  }
  html += "</tr></thead><tbody>";
  for (const StudyComparison& c : inputs) {
    html +=
        "<tr><th>" + escape_html(c.input) + "</th><td>" + std::to_string(c.pairs.size()) + "</td>";
    for (const NumberComparison& n : c.numbers) {
      if (!n.number->chief) continue;
      html += "<td>" + with_interval(n.ratio, 2) + "</td>";
    }
    html += "</tr>";
  }
  return html + "</tbody></table></div></details>";
}

std::string setup_table(const StudyPlan& plan, const std::vector<StudyRow>& rows) {
  std::string html =
      "<div class=\"scroll\"><table class=\"numbers\"><thead><tr><th>setup</th><th class=\"text\">"
      "differs from the base by</th><th>done</th><th>failed</th><th>missing</th><th "
      "class=\"text\">ended</th></tr></thead><tbody>";
  for (std::size_t s = 0; s < plan.setups.size(); ++s) {
    const StudySetup& setup = plan.setups[s];
    std::string settings;
    for (const StudySetting& setting : plan.condition(setup).settings) {
      settings += (settings.empty() ? "" : ", ") + setting.key + ": " + setting.value;
    }
    const std::vector<std::string> values = plan.values(setup);
    for (std::size_t a = 0; a < values.size(); ++a) {
      settings += (settings.empty() ? "" : ", ") + plan.study.grid[a].key + ": " + values[a];
    }
    std::array<int, 3> count{};
    std::map<std::string, int> ends;
    for (const StudyRow& row : rows) {
      if (row.cell->setup != s) continue;
      ++count[static_cast<std::size_t>(row.record.status)];
      if (row.record.status == CellRecord::Status::kDone) ++ends[row.reason];
    }
    std::string reasons;
    for (const auto& [reason, times] : ends) {
      reasons += (reasons.empty() ? "" : ", ") + reason + ": " + std::to_string(times);
    }
    const auto of = [&](CellRecord::Status status) {
      return std::to_string(count[static_cast<std::size_t>(status)]);
    };
    html += "<tr><th>" + escape_html(plan.label(setup)) + "</th><td class=\"text\">" +
            (settings.empty() ? "nothing" : escape_html(settings)) + "</td><td>" +
            of(CellRecord::Status::kDone) + "</td><td>" + of(CellRecord::Status::kFailed) +
            "</td><td>" + of(CellRecord::Status::kMissing) + "</td><td class=\"text\">" +
            escape_html(reasons) + "</td></tr>";
  }
  return html + "</tbody></table></div>";
}

std::string failures(const StudyPlan& plan, const std::vector<StudyRow>& rows) {
  std::string html;
  for (const StudyRow& row : rows) {
    if (row.record.status != CellRecord::Status::kFailed) continue;
    html += "<tr><th>" + row.id + "</th><td class=\"text\">" +
            escape_html(plan.study.inputs[row.cell->input].name) +
            (row.problem.empty() ? "" : ", " + escape_html(row.problem)) + ", seed " +
            std::to_string(row.cell->seed) + ", " + escape_html(plan.label(plan.setup(*row.cell))) +
            "</td><td class=\"text\">" + escape_html(row.reason) + "</td></tr>";
  }
  if (html.empty()) return "";
  return "<section class=\"card\"><h2>Failed</h2><div class=\"scroll\"><table "
         "class=\"numbers\"><tbody>" +
         html + "</tbody></table></div></section>";
}

}  // namespace

std::string study_page(const StudyPlan& plan, const std::vector<StudyRow>& rows,
                       const std::vector<StudyComparison>& comparisons,
                       const std::vector<StudyFigure>& figures) {
  std::size_t done = 0;
  std::set<std::string> versions, hosts;
  for (const StudyRow& row : rows) {
    if (row.record.status != CellRecord::Status::kDone) continue;
    ++done;
    if (!row.record.version.empty()) versions.insert(row.record.version);
    if (!row.record.host.empty()) hosts.insert(row.record.host);
  }
  const bool benches = plan.study.kind == Study::Kind::kBenches;
  std::string facts =
      std::to_string(done) + " of " + std::to_string(rows.size()) +
      (benches ? " solves: " : " runs: ") + std::to_string(plan.study.inputs.size()) +
      (benches ? " sets of problems, " : " worlds, ") + std::to_string(plan.study.seeds.size()) +
      " seeds, " + std::to_string(plan.setups.size()) + " setups";
  for (const std::string& version : versions) facts += " &middot; " + escape_html(version);
  if (!hosts.empty()) {
    facts += " &middot; " + std::to_string(hosts.size()) + (hosts.size() == 1 ? " host" : " hosts");
  }
  std::string compared;
  for (const StudyComparison& c : comparisons) {
    compared += "<section class=\"card\"><h2>" + escape_html(c.label) +
                (c.among.empty() ? "" : " <em>" + escape_html(c.among) + "</em>") + " <em>" +
                std::to_string(c.pairs.size()) + " pairs</em></h2>" + comparison_table(c, false) +
                "<details><summary>All " + std::to_string(c.numbers.size()) + " numbers</summary>" +
                comparison_table(c, true) + "</details>" + input_table(by_input(plan, c), benches) +
                "</section>";
  }
  Drawing::PageColors colors = study_drawing::page_colors();
  colors.merge(figure_page_colors());
  std::string pictures, against;
  for (const StudyFigure& figure : figures) {
    std::string& shelf = figure.name.starts_with("against_") ? against : pictures;
    shelf += "<figure class=\"card\">" + figure.drawing.svg(colors) + "<figcaption>" +
             escape_html(figure.caption) + " <small>figures/" + escape_html(figure.name) +
             "</small></figcaption></figure>";
  }
  return fill_page(
      study_assets::study_html(),
      {{"{{title}}", escape_html(plan.study.name)},
       {"{{style}}", std::string(page_assets::style()) + std::string(study_assets::study_css())},
       {"{{facts}}", facts},
       {"{{pairs}}",
        benches ? "Pairs share problem and seed; a pair lacks a number if either solve does: one "
                  "that came to no feasible point has no gap, one that did not solve has nothing "
                  "to target. Solved: a cost within 1 % of the best that is known, by any cell of "
                  "the study too."
                : "Pairs share world and seed; a pair lacks a number if either mission does."},
       {"{{setups}}", setup_table(plan, rows)},
       {"{{comparisons}}", compared},
       {"{{against}}", against.empty() ? "" : "<section class=\"wide\">" + against + "</section>"},
       {"{{figures}}", pictures},
       {"{{failures}}", failures(plan, rows)}});
}

}  // namespace prospect
