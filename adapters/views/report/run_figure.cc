// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/run_figure.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <sstream>

namespace prospect {
namespace {

constexpr double kColumn = 252.0, kMostHeight = 330.0;      // of the map [pt]
constexpr double kMargin = 4.0, kLine = 11.0, kSize = 7.5;  // [pt]
constexpr double kRoom = 0.3;                               // around what is drawn [m]
constexpr Color kInk = {0x1a, 0x20, 0x2c}, kFreeGround = {0xe4, 0xe9, 0xf0},
                kOccupiedGround = {0x2b, 0x34, 0x40}, kPath = {0x25, 0x63, 0xeb},
                kPaper = {0xff, 0xff, 0xff}, kUnknownGround = {0xf3, 0xd9, 0x9b},
                kReachableGround = {0xb9, 0xd3, 0xfa};

constexpr int kShades = 64, kScaleSteps = 48;  // of a quantity along the path; of its scale

struct Bounds {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  void add(const Eigen::Vector2d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  bool empty() const { return !(low.x() <= high.x()); }
};

/// Where metres lie on the paper.
struct Placement {
  double scale = 1.0;                                // [pt/m]
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  // of the left and upper edge [m]
  double left = 0.0, bottom = 0.0;                   // of the map's area [pt]
  Drawing::Point operator()(const Eigen::Vector2d& p) const {
    return {left + scale * (p.x() - corner.x()), kMargin + scale * (corner.y() - p.y())};
  }
};

Placement placement_of(Bounds box) {
  if (box.empty()) box.add(Eigen::Vector2d::Zero());
  box.low.array() -= kRoom;
  box.high.array() += kRoom;
  const Eigen::Vector2d size = box.high - box.low;
  Placement at;
  at.scale = std::min((kColumn - 2.0 * kMargin) / size.x(), kMostHeight / size.y());
  at.left = 0.5 * (kColumn - at.scale * size.x());
  at.corner = {box.low.x(), box.high.y()};
  at.bottom = kMargin + at.scale * size.y();
  return at;
}

Bounds extent_of(const GroundMap& map) {
  Bounds box;
  const GridFrame& f = map.frame();
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    if (!map.explored(c)) continue;
    box.add({c.i * f.resolution, c.j * f.resolution});
    box.add({(c.i + 1) * f.resolution, (c.j + 1) * f.resolution});
  }
  return box;
}

/// The cells that are chosen as few rectangles: runs of a row, joined with equal runs of the rows
/// below.
template <typename Chosen>
std::vector<Drawing::Rectangle> areas_of(const GridFrame& f, const Chosen& chosen,
                                         const Placement& at) {
  struct Run {
    int end, j0;
  };
  std::vector<Drawing::Rectangle> areas;
  std::map<int, Run> open;  // by their first column
  const auto close = [&](int start, const Run& run, int j) {
    const Eigen::Vector2d high = at({start * f.resolution, j * f.resolution});
    const Eigen::Vector2d low = at({run.end * f.resolution, run.j0 * f.resolution});
    areas.push_back({high.x(), high.y(), low.x() - high.x(), low.y() - high.y()});
  };
  for (int j = f.j0; j <= f.j0 + f.height; ++j) {
    std::map<int, Run> row;
    for (int i = f.i0; j < f.j0 + f.height && i < f.i0 + f.width; ++i) {
      if (!chosen(Cell{i, j})) continue;
      const int start = i;
      while (i < f.i0 + f.width && chosen(Cell{i, j})) ++i;
      row[start] = {i, j};
    }
    for (const auto& [start, run] : open) {
      const auto same = row.find(start);
      if (same != row.end() && same->second.end == run.end) {
        same->second.j0 = run.j0;
      } else {
        close(start, run, j);
      }
    }
    open = std::move(row);
  }
  return areas;
}

/// The cells of one state. state_of(Cell): that of a cell.
template <typename StateOf>
void draw_state(Drawing& drawing, const GridFrame& frame, const StateOf& state_of, CellState state,
                Color color, const Placement& at) {
  const auto chosen = [&](Cell c) { return state_of(c) == state; };
  drawing.rectangles(areas_of(frame, chosen, at), color);
}

void draw_map(Drawing& drawing, const GroundMap& map, const Placement& at) {
  const auto state_of = [&](Cell c) { return map.state(c); };
  draw_state(drawing, map.frame(), state_of, CellState::kFree, kFreeGround, at);
  draw_state(drawing, map.frame(), state_of, CellState::kOccupied, kOccupiedGround, at);
}

std::string metres(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g m", value);
  return text;
}

/// A round length, at most a quarter of the figure.
void draw_scale_bar(Drawing& drawing, const Placement& at, double y) {
  const double most = kColumn / 4.0 / at.scale;
  const double unit = std::pow(10.0, std::floor(std::log10(most)));
  const double length = (most >= 5.0 * unit ? 5.0 : most >= 2.0 * unit ? 2.0 : 1.0) * unit;
  const double left = kMargin + 1.0, right = left + at.scale * length;
  drawing.line({{left, y - 3.0}, {left, y}, {right, y}, {right, y - 3.0}}, kInk, 0.8);
  drawing.text(metres(length), {right + 4.0, y}, kSize, kInk);
}

struct Key {
  Color color;
  std::string word;
  bool area = false;  // a square, not a line
};

/// Each word once, in the order of their coming.
std::vector<std::string> distinct(const std::vector<std::string>& words) {
  std::vector<std::string> once;
  for (const std::string& word : words) {
    if (std::find(once.begin(), once.end(), word) == once.end()) once.push_back(word);
  }
  return once;
}

double key_width(const Key& key) { return 18.0 + Drawing::text_width(key.word, kSize) + 6.0; }

/// Keys in lines, from `left`, then from the margin. Returns the base line of the last one.
double draw_keys(Drawing& drawing, const std::vector<Key>& keys, double left, double y) {
  double x = left;
  for (const Key& key : keys) {
    if (x + key_width(key) > kColumn - kMargin + 6.0 && x > kMargin + 1.0) {
      x = kMargin + 1.0;
      y += kLine;
    }
    if (key.area) {
      drawing.rectangles({{x + 5.0, y - 6.5, 8.0, 7.0}}, key.color);
    } else {
      drawing.line({{x + 1.0, y - 2.7}, {x + 13.0, y - 2.7}}, key.color, 1.8);
    }
    drawing.text(key.word, {x + 17.0, y}, kSize, kInk);
    x += key_width(key);
  }
  return y;
}

/// How many lines draw_keys() takes.
int key_lines(const std::vector<Key>& keys, double left) {
  Drawing nowhere(kColumn, 0.0);
  return 1 + static_cast<int>(std::lround(draw_keys(nowhere, keys, left, 0.0) / kLine));
}

/// What stands at the ends of a quantity's scale, and its name.
struct Scale {
  std::string name, from, to;
  double end = 1.0;
};

Scale path_scale(const ColoredPath& path) {
  Scale scale;
  scale.end = scale_end(path.values);
  const bool beyond = std::any_of(path.values.begin(), path.values.end(),
                                  [&](double v) { return std::isfinite(v) && v > scale.end; });
  char text[48];
  const char* format = "%s%.2f m";
  if (path.by == PathColor::kFeatures) {
    scale.name = "features in view";
    format = "%s%.0f";
  } else if (path.by == PathColor::kError) {
    scale.name = "localization error";
  } else {
    scale.name = "speed";
    format = "%s%.2f m/s";
  }
  std::snprintf(text, sizeof text, format, beyond ? ">= " : "", scale.end);
  scale.to = text;
  scale.from = "0";
  return scale;
}

void draw_scale(Drawing& drawing, const Scale& scale, double y) {
  constexpr double kLength = 80.0;
  const double right = kColumn - kMargin - 1.0 - Drawing::text_width(scale.to, kSize);
  const double left = right - 4.0 - kLength;
  for (int i = 0; i < kScaleSteps; ++i) {
    drawing.rectangles(
        {{left + kLength * i / kScaleSteps, y - 6.0, kLength / kScaleSteps + 0.05, 6.0}},
        color_on_white((i + 0.5) / kScaleSteps));
  }
  drawing.text(scale.to, {right, y}, kSize, kInk);
  drawing.text(scale.from, {left - 4.0, y}, kSize, kInk, Drawing::Anchor::kRight);
  drawing.text(scale.name, {left - 4.0, y - kLine}, kSize, kInk);
}

void draw_path(Drawing& drawing, const ColoredPath& path, const Placement& at) {
  constexpr double kPathWidth = 1.3;
  const std::size_t n = path.points.size();
  std::map<std::string, Color> by_mode;
  const std::vector<std::string> words = distinct(path.modes);
  const std::vector<Color> colors = mode_colors(words);
  for (std::size_t i = 0; i < words.size(); ++i) by_mode[words[i]] = colors[i];
  const double end = path.values.empty() ? 1.0 : scale_end(path.values);
  const auto color = [&](std::size_t k) {
    if (path.by == PathColor::kPlain) return kPath;
    if (path.by == PathColor::kMode) return by_mode[path.modes[k]];
    // Pieces of one shade are one line.
    return color_on_white(std::round(kShades * path.values[k] / end) / kShades);
  };
  for (const bool halo : {true, false}) {
    std::vector<Drawing::Point> piece;
    Color last;
    const auto flush = [&] {
      drawing.line(piece, halo ? kPaper : last, halo ? kPathWidth + 1.2 : kPathWidth);
      piece.clear();
    };
    for (std::size_t k = 0; k < n; ++k) {
      if (!path.points[k].allFinite()) {
        flush();
        continue;
      }
      const Drawing::Point p = at(path.points[k]);
      const Color now = color(k);
      if (!piece.empty()) {
        if (!halo && piece.size() > 1 && !(now == last)) {
          const Drawing::Point before = piece.back();
          flush();
          piece.push_back(before);
        }
        last = now;
      }
      piece.push_back(p);
    }
    flush();
  }
}

void draw_ends(Drawing& drawing, const ColoredPath& path, const Placement& at) {
  const auto finite = [](const Eigen::Vector2d& p) { return p.allFinite(); };
  const auto first = std::find_if(path.points.begin(), path.points.end(), finite);
  if (first == path.points.end()) return;
  const auto last = std::find_if(path.points.rbegin(), path.points.rend(), finite);
  const auto mark = [&](const Eigen::Vector2d& p, Color fill, const char* word, double dy) {
    const Drawing::Point q = at(p);
    drawing.circle(q, 2.6, fill, kInk, 1.0);
    const double width = Drawing::text_width(word, kSize);
    const bool left = q.x() + 6.0 + width > kColumn - kMargin;
    const Drawing::Point base(left ? q.x() - 5.0 : q.x() + 5.0, q.y() + dy);
    drawing.text(word, base, kSize, kInk, left ? Drawing::Anchor::kRight : Drawing::Anchor::kLeft);
  };
  // Apart, also where the robot came back to its start.
  const bool together = (at(*first) - at(*last)).norm() < 12.0;
  mark(*first, kPaper, "start", together ? -3.5 : 2.7);
  mark(*last, kInk, "end", together ? 8.0 : 2.7);
}

/// Sentences in lines that fit the figure.
std::vector<std::string> wrapped(const std::vector<std::string>& sentences) {
  std::vector<std::string> lines;
  for (const std::string& sentence : sentences) {
    std::istringstream words(sentence);
    std::string line;
    for (std::string word; words >> word;) {
      const std::string longer = line.empty() ? word : line + ' ' + word;
      if (!line.empty() && Drawing::text_width(longer, kSize) > kColumn - 2.0 * kMargin) {
        lines.push_back(line);
        line = "  " + word;
      } else {
        line = longer;
      }
    }
    lines.push_back(line);
  }
  return lines;
}

}  // namespace

Drawing path_figure(const GroundMap* map, const ColoredPath& path) {
  Bounds box;
  if (map) box = extent_of(*map);
  for (const Eigen::Vector2d& p : path.points) {
    if (p.allFinite()) box.add(p);
  }
  const Placement at = placement_of(box);
  std::vector<Key> keys;
  const bool quantity = path.by != PathColor::kPlain && path.by != PathColor::kMode;
  if (path.by == PathColor::kPlain) keys.push_back({kPath, "path"});
  if (path.by == PathColor::kMode) {
    const std::vector<std::string> words = distinct(path.modes);
    const std::vector<Color> colors = mode_colors(words);
    for (std::size_t i = 0; i < words.size(); ++i) {
      keys.push_back({colors[i], words[i].empty() ? "no plan" : words[i]});
    }
  }
  const double first = at.bottom + kLine + (quantity ? kLine : 0.0);
  constexpr double kKeyLeft = 108.0;  // right of the scale bar
  const int lines = keys.empty() ? 1 : key_lines(keys, kKeyLeft);
  Drawing drawing(kColumn, first + (lines - 1) * kLine + kMargin);
  if (map) draw_map(drawing, *map, at);
  draw_path(drawing, path, at);
  draw_ends(drawing, path, at);
  draw_scale_bar(drawing, at, first);
  if (quantity) draw_scale(drawing, path_scale(path), first);
  draw_keys(drawing, keys, kKeyLeft, first);
  return drawing;
}

Drawing map_figure(const GroundMap& map) {
  const Placement at = placement_of(extent_of(map));
  const double first = at.bottom + kLine;
  Drawing drawing(kColumn, first + kMargin);
  draw_map(drawing, map, at);
  draw_scale_bar(drawing, at, first);
  const std::vector<Key> keys = {{kFreeGround, "free", true}, {kOccupiedGround, "occupied", true}};
  double width = 0.0;
  for (const Key& key : keys) width += key_width(key);
  draw_keys(drawing, keys, kColumn - kMargin - width, first);
  return drawing;
}

Drawing world_figure(const Grid<CellState>& read, const Grid<std::uint8_t>& reachable,
                     const Pose& start, const std::vector<std::string>& facts) {
  const GridFrame& f = read.frame;
  const Eigen::Vector2d low = f.resolution * Eigen::Vector2d(f.i0, f.j0);
  const Eigen::Vector2d high = low + f.resolution * Eigen::Vector2d(f.width, f.height);
  Bounds rim;
  rim.add(low);
  rim.add(high);
  const Placement at = placement_of(rim);
  const std::vector<Key> keys = {{kReachableGround, "can be seen", true},
                                 {kFreeGround, "free", true},
                                 {kOccupiedGround, "occupied", true},
                                 {kUnknownGround, "unknown, taken for solid", true},
                                 {kInk, "rim: solid beyond"}};
  const double first = at.bottom + kLine;
  constexpr double kKeyLeft = 108.0;  // right of the scale bar
  const double after = first + kLine * (key_lines(keys, kKeyLeft) - 1);
  const std::vector<std::string> lines = wrapped(facts);
  Drawing drawing(kColumn, after + kLine * static_cast<double>(lines.size()) + kMargin);

  const auto state_of = [&](Cell c) { return read[c]; };
  draw_state(drawing, f, state_of, CellState::kFree, kFreeGround, at);
  draw_state(drawing, f, state_of, CellState::kOccupied, kOccupiedGround, at);
  draw_state(drawing, f, state_of, CellState::kUnknown, kUnknownGround, at);
  const auto is_seen = [&reachable](Cell c) { return reachable[c] != 0; };
  drawing.rectangles(areas_of(reachable.frame, is_seen, at), kReachableGround);
  drawing.line({at(low), at({high.x(), low.y()}), at(high), at({low.x(), high.y()}), at(low)}, kInk,
               0.8);
  const Drawing::Point from = at(start.position.head<2>());
  const Drawing::Point ahead(std::cos(start.yaw), -std::sin(start.yaw)),
      side(-ahead.y(), ahead.x());
  for (const bool halo : {true, false}) {
    const Color color = halo ? kPaper : kPath;
    const double width = halo ? 3.2 : 1.6;
    const Drawing::Point tip = from + 13.0 * ahead;
    drawing.line({from, tip}, color, width);
    drawing.line({tip - 4.0 * ahead + 3.0 * side, tip, tip - 4.0 * ahead - 3.0 * side}, color,
                 width);
  }
  drawing.circle(from, 2.6, kPath, kPaper, 1.0);
  drawing.text("start", from + Drawing::Point(4.0, 9.0), kSize, kInk);
  draw_scale_bar(drawing, at, first);
  draw_keys(drawing, keys, kKeyLeft, first);
  for (std::size_t n = 0; n < lines.size(); ++n) {
    drawing.text(lines[n], {kMargin + 1.0, after + kLine * static_cast<double>(n + 1)}, kSize,
                 kInk);
  }
  return drawing;
}

Drawing::PageColors figure_page_colors() {
  Drawing::PageColors colors = {{hex(kInk), "var(--ink)"},
                                {hex(kFreeGround), "var(--figure-free)"},
                                {hex(kOccupiedGround), "var(--map-occupied)"},
                                {hex(kPath), "var(--estimated)"},
                                {hex(kPaper), "var(--surface)"}};
  const auto add = [&](double t) {
    const std::string light = hex(color_on_white(t));
    colors[light] = "light-dark(" + light + ", " + hex(color_on_dark(t)) + ")";
  };
  for (int i = 0; i <= kShades; ++i) add(static_cast<double>(i) / kShades);
  for (int i = 0; i < kScaleSteps; ++i) add((i + 0.5) / kScaleSteps);
  return colors;
}

}  // namespace prospect
