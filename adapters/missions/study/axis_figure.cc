// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/axis_figure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "adapters/formats/files/parse_number.h"
#include "adapters/missions/bench/resampled_means.h"
#include "adapters/missions/study/study_drawing.h"

namespace prospect {

using namespace study_drawing;

namespace {

/// A number, if that is what the YAML says.
std::optional<double> number_of(const std::string& yaml) {
  double value = 0.0;
  return parse_number(yaml, value) && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Where the values of an axis stand, and what is written there. Numbers to scale, logarithmic over
/// more than a decade; words side by side, as letters with a key where they have no room.
struct AxisPlaces {
  std::vector<double> at;
  std::vector<std::string> words;
  double low = 0.0, high = 1.0;
  std::string note;  ///< what the words do not say
};

AxisPlaces places_of(const StudyAxis& axis, double width) {
  AxisPlaces places;
  for (const StudySetting& setting : axis.values) {
    if (const std::optional<double> number = number_of(setting.value)) {
      places.at.push_back(*number);
    }
    places.words.push_back(setting.value);
  }
  const bool numbers = places.at.size() == axis.values.size();
  if (!numbers) {
    places.at.clear();
    for (std::size_t v = 0; v < axis.values.size(); ++v) {
      places.at.push_back(static_cast<double>(v));
    }
  }
  auto [least, most] = std::minmax_element(places.at.begin(), places.at.end());
  if (numbers && *least > 0.0 && *most > 10.0 * *least) {
    places.note = " (logarithmic)";
    for (double& x : places.at) x = std::log10(x);
    std::tie(least, most) = std::minmax_element(places.at.begin(), places.at.end());
  }
  const double edge = numbers ? std::max(0.08 * (*most - *least), 1e-9) : 0.5;
  places.low = *least - edge;
  places.high = *most + edge;
  double room = width;
  std::vector<double> sorted = places.at;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t v = 1; v < sorted.size(); ++v) {
    room = std::min(room, width * (sorted[v] - sorted[v - 1]) / (places.high - places.low));
  }
  const bool fits = std::all_of(places.words.begin(), places.words.end(), [&](const auto& word) {
    return Drawing::text_width(word, kFont) <= room;
  });
  if (!fits) {
    for (std::size_t v = 0; v < places.words.size(); ++v) {
      std::string letter(1, static_cast<char>('a' + v % 26));
      places.note += (v == 0 ? ": " : ", ") + letter + " = " + places.words[v];
      places.words[v] = letter;
    }
  }
  return places;
}

}  // namespace

Drawing axis_figure(const StudyPlan& plan, const std::vector<StudyRow>& rows, std::size_t axis) {
  const StudyAxis& varied = plan.study.grid[axis];
  const std::vector<StudyNumber>& all = study_numbers(plan.study.kind);
  const std::vector<std::size_t> chief = chief_numbers(plan.study.kind);
  // Setups that differ in nothing but this key, by its values.
  std::map<std::pair<std::size_t, std::vector<std::size_t>>, std::vector<std::size_t>> series;
  std::vector<Name> names;
  for (std::size_t s = 0; s < plan.setups.size(); ++s) {
    std::vector<std::size_t> values = plan.setups[s].values;
    const std::size_t value = std::exchange(values[axis], 0);
    auto& setups = series[{plan.setups[s].condition, values}];
    setups.resize(varied.values.size());
    setups[value] = s;
  }
  for (const auto& [key, setups] : series) {
    std::string words = plan.study.conditions[key.first].name;
    for (std::size_t a = 0; a < key.second.size(); ++a) {
      if (a == axis) continue;
      const StudyAxis& other = plan.study.grid[a];
      words += (words.empty() ? "" : ", ") + other.key + "=" + other.values[key.second[a]].value;
    }
    names.push_back({setup_color(names.size()), words});
  }
  const bool named = names.size() > 1 || !names.front().words.empty();
  const AxisPlaces places = places_of(varied, PanelGrid::kWidth);
  const PanelGrid grid(chief.size());
  const std::vector<std::string> title = wrapped(varied.key + places.note, PanelGrid::kInner);
  const double keys = grid.below + kLine * static_cast<double>(title.size());
  Drawing drawing(PanelGrid::kPaper, keys + (named ? names_height(names, PanelGrid::kInner) : 0));
  for (std::size_t k = 0; k < chief.size(); ++k) {
    const StudyNumber& number = all[chief[k]];
    std::vector<std::vector<double>> values(plan.setups.size());
    for (const StudyRow& row : rows) {
      const double v = number.scale * value_of(row, chief[k]);
      if (std::isfinite(v)) values[row.cell->setup].push_back(v);
    }
    std::vector<MeanInterval> means(plan.setups.size());
    Panel panel = grid.at(k);
    panel.x0 = places.low;
    panel.x1 = places.high;
    panel.y1 = 0.0;
    for (std::size_t s = 0; s < values.size(); ++s) {
      if (values[s].empty()) continue;
      const auto count = static_cast<int>(values[s].size());
      means[s] = ResampledMeans(count, 4000)
                     .interval(Eigen::Map<const Eigen::VectorXd>(values[s].data(), count));
      panel.y0 = std::min(panel.y0, 1.05 * means[s].low);
      panel.y1 = std::max(panel.y1, 1.05 * means[s].high);
    }
    if (!(panel.y1 > panel.y0)) panel.y1 = panel.y0 + 1.0;
    draw_y_axis(drawing, panel, number.label);
    for (std::size_t v = 0; v < places.at.size(); ++v) {
      const Drawing::Point p = panel.at(places.at[v], panel.y0);
      drawing.line({p, {p.x(), p.y() + 2.5}}, kAxis, 0.6);
      drawing.text(places.words[v], {p.x(), p.y() + kLine}, kFont, kText, Drawing::Anchor::kCenter);
      const bool none = std::all_of(series.begin(), series.end(),
                                    [&](const auto& one) { return values[one.second[v]].empty(); });
      if (none) drawing.text("none", {p.x(), p.y() - 3.0}, kFont, kAxis, Drawing::Anchor::kCenter);
    }
    std::vector<std::size_t> order(places.at.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return places.at[a] < places.at[b]; });
    std::size_t n = 0;
    for (const auto& [key, setups] : series) {
      const Color color = setup_color(n);
      // Beside each other, so that intervals at one value do not hide each other.
      const double aside =
          2.2 * (static_cast<double>(n) - 0.5 * static_cast<double>(series.size() - 1));
      std::vector<Drawing::Point> line;
      for (const std::size_t v : order) {
        const std::size_t s = setups[v];
        if (values[s].empty()) {
          drawing.line(std::exchange(line, {}), color, 1.2);
          continue;
        }
        const auto at = [&](double y) -> Drawing::Point {
          return panel.at(places.at[v], y) + Drawing::Point(aside, 0.0);
        };
        if (values[s].size() > 1) drawing.line({at(means[s].low), at(means[s].high)}, color, 0.9);
        drawing.circle(at(means[s].mean), 1.9, color, kWhite, 0.4);
        line.push_back(at(means[s].mean));
      }
      drawing.line(std::move(line), color, 1.2);
      ++n;
    }
  }
  draw_lines(drawing, title, PanelGrid::kGapX, grid.below);
  if (named) draw_names(drawing, names, PanelGrid::kGapX, keys, PanelGrid::kInner);
  return drawing;
}

}  // namespace prospect
