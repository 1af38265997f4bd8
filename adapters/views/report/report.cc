// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/report.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "adapters/missions/run/step_fields.h"
#include "adapters/missions/run/summary.h"
#include "adapters/views/page/binary_text.h"
#include "adapters/views/page/html_page.h"
#include "adapters/views/page/page_assets.h"
#include "adapters/views/report/field_picture.h"
#include "adapters/views/report/palette.h"
#include "adapters/views/report/report_assets.h"
#include "engine/support/named.h"

namespace prospect {
namespace {

using Json = nlohmann::ordered_json;

using Steps = std::vector<std::reference_wrapper<const StepRecord>>;

/// The rectangle of cells that a run ever touches. A cell is stored as its row-major index there.
struct Extent {
  int i0 = INT_MAX, j0 = INT_MAX, i1 = INT_MIN, j1 = INT_MIN;

  void add(Cell c) {
    i0 = std::min(i0, c.i);
    j0 = std::min(j0, c.j);
    i1 = std::max(i1, c.i);
    j1 = std::max(j1, c.j);
  }
  bool empty() const { return i0 > i1; }
  std::int64_t width() const { return empty() ? 0 : std::int64_t{i1} - i0 + 1; }
  std::int64_t height() const { return empty() ? 0 : std::int64_t{j1} - j0 + 1; }
  std::int64_t index(Cell c) const {
    return (std::int64_t{c.j} - j0) * width() + (std::int64_t{c.i} - i0);
  }
};

/// Frontier cells of a step as cells; points that are no cell of any map are left out.
std::vector<Cell> frontier_cells(const StepRecord& step, double resolution) {
  std::vector<Cell> cells;
  for (const Eigen::Vector2f& p : step.frontier_cells) {
    const double i = std::floor(p.x() / resolution);
    const double j = std::floor(p.y() / resolution);
    if (!(std::abs(i) < 1e9 && std::abs(j) < 1e9)) continue;
    cells.push_back({static_cast<int>(i), static_cast<int>(j)});
  }
  return cells;
}

/// Each step: how many runs of equal state, then for each the gap since the last run's end and
/// 4 length + state.
std::string map_text(const Steps& steps, const Extent& extent) {
  BinaryText text;
  for (const StepRecord& step : steps) {
    std::map<std::int64_t, CellState> cells;  // the last change of a cell counts
    for (const auto& [cell, state] : step.map_changes) cells[extent.index(cell)] = state;
    struct Run {
      std::int64_t start, length;
      CellState state;
    };
    std::vector<Run> runs;
    for (const auto& [index, state] : cells) {
      if (!runs.empty() && runs.back().state == state &&
          runs.back().start + runs.back().length == index) {
        ++runs.back().length;
      } else {
        runs.push_back({index, 1, state});
      }
    }
    text.add_varint(runs.size());
    std::int64_t end = 0;
    for (const Run& run : runs) {
      text.add_varint(static_cast<std::uint64_t>(run.start - end));
      text.add_varint(static_cast<std::uint64_t>(4 * run.length) +
                      static_cast<std::uint64_t>(run.state));
      end = run.start + run.length;
    }
  }
  return text.base64();
}

/// Each step: how many cells became or ceased to be frontier since the step before, then their
/// indices, ascending, each as its distance from the one before. As the same list leads back, the
/// page can walk both ways. A step whose cells were not kept shows those of the step before.
std::string frontier_text(const Steps& steps, double resolution, const Extent& extent) {
  BinaryText text;
  std::vector<std::int64_t> before, now, toggled;
  for (const StepRecord& step : steps) {
    if (step.active_frontiers == 0 || !step.frontier_cells.empty()) {
      now.clear();
      for (const Cell& cell : frontier_cells(step, resolution)) now.push_back(extent.index(cell));
      std::sort(now.begin(), now.end());
      now.erase(std::unique(now.begin(), now.end()), now.end());
    }
    toggled.clear();
    std::set_symmetric_difference(before.begin(), before.end(), now.begin(), now.end(),
                                  std::back_inserter(toggled));
    text.add_varint(toggled.size());
    std::int64_t last = 0;
    for (const std::int64_t index : toggled) {
      text.add_varint(static_cast<std::uint64_t>(index - last));
      last = index;
    }
    before = now;
  }
  return text.base64();
}

/// A landmark appears in many steps and moves little: positions are kept once, to the centimetre
/// (finer than a screen shows), and each step names its landmarks by index. Each step: how many,
/// then for each the distance from the index before and its visibility in 1/127.
Json landmark_json(const Steps& steps) {
  BinaryText positions, text;
  std::map<std::pair<std::int32_t, std::int32_t>, std::uint64_t> known;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> row;
  for (const StepRecord& step : steps) {
    row.clear();
    for (const LandmarkView& l : step.landmarks) {
      if (!(std::abs(l.x) < 1e6F && std::abs(l.y) < 1e6F)) continue;
      const std::pair<std::int32_t, std::int32_t> key{std::lround(100.0 * l.x),
                                                      std::lround(100.0 * l.y)};
      const auto [entry, added] = known.emplace(key, known.size());
      if (added) {
        positions.add_float(0.01 * key.first);
        positions.add_float(0.01 * key.second);
      }
      const double visibility = std::isfinite(l.visibility) ? l.visibility : 0.0;
      row.emplace_back(entry->second, static_cast<std::uint64_t>(
                                          std::lround(127.0 * std::clamp(visibility, 0.0, 1.0))));
    }
    std::sort(row.begin(), row.end());
    text.add_varint(row.size());
    std::uint64_t last = 0;
    for (const auto& [index, visibility] : row) {
      text.add_varint(index - last);
      text.add_varint(visibility);
      last = index;
    }
  }
  return {{"positions", positions.base64()}, {"steps", text.base64()}};
}

Json horizon_json(const Steps& steps) {
  BinaryText counts, poses;
  for (const StepRecord& step : steps) {
    counts.add_varint(step.horizon.size());
    for (const Pose& p : step.horizon) {
      poses.add_float(p.position.x());
      poses.add_float(p.position.y());
      poses.add_float(p.yaw);
    }
  }
  return {{"counts", counts.base64()}, {"poses", poses.base64()}};
}

/// Those that are not sound are left out: x, y, vx, vy, radius of each.
Json mover_json(const Steps& steps) {
  BinaryText counts, values;
  for (const StepRecord& step : steps) {
    std::uint64_t count = 0;
    for (const Mover& mover : step.movers) {
      if (!mover.sound()) continue;
      ++count;
      for (const double value : {mover.position.x(), mover.position.y(), mover.velocity.x(),
                                 mover.velocity.y(), mover.radius}) {
        values.add_float(value);
      }
    }
    counts.add_varint(count);
  }
  return {{"counts", counts.base64()}, {"values", values.base64()}};
}

template <typename Get>
std::string column(const Steps& steps, const Get& get) {
  BinaryText text;
  for (const StepRecord& step : steps) text.add_float(get(step));
  return text.base64();
}
std::string column(const Steps& steps, const StepField& field, const std::string& name = "") {
  return column(steps, [&](const StepRecord& step) { return number_of(field.of(step, name)); });
}

/// Appends the names of the cost terms that are not there yet.
void add_cost_terms(const Explanation& explanation, std::vector<std::string>& names) {
  for (const TermValue& term : explanation.terms) {
    if (term.constraint) continue;
    if (std::find(names.begin(), names.end(), term.name) == names.end()) {
      names.push_back(term.name);
    }
  }
}

/// Weighted; NaN if there is no such term.
double cost_term(const Explanation& explanation, const std::string& name) {
  for (const TermValue& term : explanation.terms) {
    if (!term.constraint && term.name == name) return term.weighted;
  }
  return std::nan("");
}

/// Every cost term that any step has: weighted, and what there is of its weight, by the fields'
/// names; NaN at the steps that lack it.
Json term_json(const Steps& steps) {
  std::vector<std::string> names;
  for (const StepRecord& step : steps) add_cost_terms(step.explanation, names);
  Json terms = Json::array();
  for (const std::string& name : names) {
    Json term = {{"name", name}, {"weighted", column(steps, [&](const StepRecord& step) {
                                    return cost_term(step.explanation, name);
                                  })}};
    for (const StepField& field : step_fields()) {
      if (field.per == FieldPer::kWeight)
        term[std::string(field.name)] = column(steps, field, name);
    }
    terms.push_back(std::move(term));
  }
  return terms;
}

/// Words by number, in the order of their coming.
class WordList {
 public:
  std::uint64_t number(const std::string& word) {
    const auto [entry, added] = known_.emplace(word, words_.size());
    if (added) words_.push_back(word);
    return entry->second;
  }
  const std::vector<std::string>& words() const { return words_; }

 private:
  std::vector<std::string> words_;
  std::map<std::string, std::uint64_t> known_;
};

/// Each step: how many frontiers, then why each stands where it does. `values`: of each x, y, E, A
/// and the time, which is infinite where no path is known.
Json standing_json(const Steps& steps) {
  WordList whys;
  BinaryText text, values;
  for (const StepRecord& step : steps) {
    text.add_varint(step.standings.size());
    for (const FrontierRecord& f : step.standings) {
      text.add_varint(whys.number(std::string(name(f.why))));
      for (const double value : {f.place.x(), f.place.y(), f.area, f.unknown, f.time}) {
        values.add_float(value);
      }
    }
  }
  return {{"whys", whys.words()}, {"steps", text.base64()}, {"values", values.base64()}};
}

/// The candidates of each step. `steps`: how many there are; for each: name, verdict, 1 if
/// polished, how many points its path has, and these in cm, the first from the origin, each further
/// one from the one before it (signed). `values`: for each its cost, then each term of `terms`, NaN
/// where it lacks that.
Json candidate_json(const Steps& steps) {
  std::vector<std::string> terms;
  for (const StepRecord& step : steps) {
    for (const CandidateRecord& c : step.candidates) add_cost_terms(c.explanation, terms);
  }
  WordList names, verdicts;
  BinaryText text, values;
  for (const StepRecord& step : steps) {
    text.add_varint(step.candidates.size());
    for (const CandidateRecord& c : step.candidates) {
      text.add_varint(names.number(c.name));
      text.add_varint(verdicts.number(to_string(c.verdict)));
      text.add_varint(c.polished ? 1 : 0);
      // The part before the first point that is none.
      std::vector<std::pair<std::int64_t, std::int64_t>> path;
      for (const Eigen::Vector2f& p : c.path) {
        if (!(std::abs(p.x()) < 1e6F && std::abs(p.y()) < 1e6F)) break;
        path.emplace_back(std::llround(100.0 * p.x()), std::llround(100.0 * p.y()));
      }
      text.add_varint(path.size());
      std::pair<std::int64_t, std::int64_t> last{0, 0};
      for (const auto& point : path) {
        text.add_signed_varint(point.first - last.first);
        text.add_signed_varint(point.second - last.second);
        last = point;
      }
      values.add_float(c.explanation.cost);
      for (const std::string& term : terms) values.add_float(cost_term(c.explanation, term));
    }
  }
  return {{"names", names.words()},
          {"verdicts", verdicts.words()},
          {"terms", terms},
          {"steps", text.base64()},
          {"values", values.base64()}};
}

Json cost_to_go_json(const Steps& steps) {
  Json pictures = Json::array();
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const std::optional<CostToGoPicture>& picture = steps[k].get().cost_to_go;
    if (!picture) continue;
    const FieldPicture field = field_picture(*picture);
    if (field.png.empty()) continue;
    BinaryText png;
    png.add_bytes(field.png);
    const double size = field.frame.resolution;
    pictures.push_back({{"step", k},
                        {"x", size * field.frame.i0},
                        {"y", size * field.frame.j0},
                        {"width", field.frame.width},
                        {"height", field.frame.height},
                        {"size", size},
                        {"most", field.most},
                        {"png", png.base64()}});
  }
  return pictures;
}

/// A column of words: the distinct ones, and for each step which.
Json word_column(const Steps& steps, const StepField& field) {
  WordList words;
  BinaryText text;
  for (const StepRecord& step : steps) text.add_varint(words.number(text_of(field.of(step, ""))));
  return {{"words", words.words()}, {"steps", text.base64()}};
}

/// Colours: of each mode by name, and the scale of quantities.
Json palette_json(const Steps& steps) {
  WordList modes;
  for (const StepRecord& step : steps) modes.number(name_of(step.mode));
  const std::vector<Color> colors = mode_colors(modes.words());
  Json by_mode = Json::object(), scale = Json::array();
  for (std::size_t i = 0; i < colors.size(); ++i) by_mode[modes.words()[i]] = hex(colors[i]);
  for (const Color& color : scale_colors()) scale.push_back(hex(color));
  return {{"modes", std::move(by_mode)}, {"scale", std::move(scale)}};
}

/// A list of [x, y] in cm precision; null for none.
Json polygon_json(const Polygon& polygon) {
  Json corners = Json::array();
  for (const Eigen::Vector2d& p : polygon) {
    corners.push_back({0.01 * std::round(100.0 * p.x()), 0.01 * std::round(100.0 * p.y())});
  }
  return corners;
}

Json zones_json(const RunRecord& record) {
  Json keep_out = Json::array(), slow = Json::array();
  for (const Polygon& polygon : record.zones.keep_out) keep_out.push_back(polygon_json(polygon));
  for (const SpeedZone& zone : record.zones.slow) {
    slow.push_back({{"area", polygon_json(zone.area)}, {"max_speed", zone.max_speed}});
  }
  const auto optional = [](const std::optional<Polygon>& polygon) {
    return polygon ? polygon_json(*polygon) : Json();
  };
  return {{"bound", optional(record.zones.bound)},
          {"area", optional(record.area)},
          {"keep_out", std::move(keep_out)},
          {"slow", std::move(slow)}};
}

Json steps_json(const Steps& steps, double resolution) {
  Extent extent;
  for (const StepRecord& step : steps) {
    for (const auto& [cell, state] : step.map_changes) extent.add(cell);
    for (const Cell& cell : frontier_cells(step, resolution)) extent.add(cell);
  }
  Json columns = Json::object(), words = Json::object();
  for (const StepField& field : step_fields()) {
    if (!field.in(kPage) || field.per != FieldPer::kStep) continue;
    const std::string name(field.name);
    if (field.holds_text()) {
      words[name] = word_column(steps, field);
    } else {
      columns[name] = column(steps, field);
    }
  }
  return {
      {"steps", steps.size()},
      {"extent",
       {{"i0", extent.empty() ? 0 : extent.i0},
        {"j0", extent.empty() ? 0 : extent.j0},
        {"width", extent.width()},
        {"height", extent.height()}}},
      {"columns", std::move(columns)},
      {"words", std::move(words)},
      {"terms", term_json(steps)},
      {"map", map_text(steps, extent)},
      {"frontiers", frontier_text(steps, resolution, extent)},
      {"landmarks", landmark_json(steps)},
      {"horizon", horizon_json(steps)},
      {"movers", mover_json(steps)},
      {"standings", standing_json(steps)},
      {"candidates", candidate_json(steps)},
      {"cost_to_go", cost_to_go_json(steps)},
      {"palette", palette_json(steps)},
  };
}

/// What does not change from step to step.
Json start_json(const RunRecord& record) {
  return {{"summary", Json::parse(summary_json(record.summary))},
          {"resolution", record.resolution},
          {"robot_radius", record.robot_radius},
          {"sensor_range", record.sensor_range},
          {"sensor_fov", record.sensor_fov},
          {"zones", zones_json(record)},
          {"configuration", record.configuration}};
}

}  // namespace

std::string report_run(const RunRecord& record) {
  Json run = start_json(record);
  run.update(steps_json(Steps(record.steps.begin(), record.steps.end()), record.resolution));
  run["pictures"] = pictures_json(record.pictures);
  return json_text(run);
}

std::string render_report(const RunRecord& record) {
  ReportPage page;
  page.title = record.summary.world;
  page.run = report_run(record);
  return render_page(page);
}

std::string report_start(const RunRecord& record) { return json_text(start_json(record)); }

std::string report_steps(const std::vector<std::shared_ptr<const StepRecord>>& steps,
                         double resolution) {
  Steps part;
  for (const auto& step : steps) part.push_back(*step);
  return json_text(steps_json(part, resolution));
}

std::string render_page(const ReportPage& page) {
  return fill_page(report_assets::page(),
                   {{"{{title}}", escape_html(page.title)},
                    {"{{kicker}}", escape_html(page.kicker)},
                    {"{{connect}}", escape_html(page.connect)},
                    {"{{library style}}", library_text(page_assets::dygraph_style())},
                    {"{{style}}", std::string(page_assets::style()) + std::string(page.style)},
                    {"{{controls}}", std::string(page.controls)},
                    {"{{run}}", page.run},
                    {"{{library}}", script_text(page_assets::dygraph_script())},
                    {"{{script}}", page_script(std::string(report_assets::script()) +
                                               std::string(page.script))}});
}

}  // namespace prospect
