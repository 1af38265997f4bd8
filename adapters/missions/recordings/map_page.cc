// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/map_page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "adapters/formats/datasets/degrees.h"
#include "adapters/missions/recordings/map_assets.h"
#include "adapters/missions/recordings/voxel_faces.h"
#include "adapters/views/page/binary_text.h"
#include "adapters/views/page/html_page.h"
#include "adapters/views/page/page_assets.h"

namespace prospect {
namespace {

using PageJson = nlohmann::ordered_json;

std::string float_column(const std::vector<double>& values) {
  BinaryText text;
  for (const double v : values) text.add_float(v);
  return text.base64();
}

PageJson voxels_of(const BeliefMaps& maps) {
  const VoxelGrid& voxels = *maps.voxels;
  const std::vector<FaceRectangle> faces = merged_faces(voxels, *maps.octree);
  return {
      {"resolution", voxels.resolution()},
      {"low", {voxels.frame().i0, voxels.frame().j0, voxels.k0()}},
      {"size", {voxels.frame().width, voxels.frame().height, voxels.depth()}},
      {"occupied", std::count(voxels.data().begin(), voxels.data().end(), CellState::kOccupied)},
      {"rectangles", faces.size()},
      {"levels", kOccupancyLevels},
      {"faces", faces_text(faces, voxels)}};
}

/// The ground map cut to what is known and to the path: runs of equal cells, row by row from y's
/// lowest; each 3 (length - 1) + state, 0 unknown, 1 free, 2 occupied.
PageJson ground_of(const MapRun& run) {
  const GroundMap& ground = *run.maps.ground;
  const GridFrame& frame = ground.frame();
  int low_i = frame.i0 + frame.width, low_j = frame.j0 + frame.height;
  int high_i = frame.i0 - 1, high_j = frame.j0 - 1;
  const auto hold = [&](const Cell& c) {
    low_i = std::min(low_i, c.i), high_i = std::max(high_i, c.i);
    low_j = std::min(low_j, c.j), high_j = std::max(high_j, c.j);
  };
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    if (ground.explored(c)) hold(c);
  }
  if (high_i < low_i) return {};
  for (const MapRunFrame& f : run.frames) {
    if (f.mapped.state == Mapping::kRejected) continue;
    hold(frame.cell(f.mapped.T_WC.translation().x(), f.mapped.T_WC.translation().y()));
  }
  BinaryText text;
  std::uint64_t length = 0, state = 0;
  const auto end_run = [&] {
    if (length > 0) text.add_varint(3 * (length - 1) + state);
    length = 0;
  };
  for (int j = low_j; j <= high_j; ++j) {
    for (int i = low_i; i <= high_i; ++i) {
      const CellState cell = ground.state({i, j});
      const std::uint64_t now = cell == CellState::kOccupied ? 2 : cell == CellState::kFree ? 1 : 0;
      if (now != state) end_run();
      state = now;
      ++length;
    }
  }
  end_run();
  return {{"resolution", frame.resolution},
          {"low", {low_i, low_j}},
          {"width", high_i - low_i + 1},
          {"height", high_j - low_j + 1},
          {"cells", text.base64()}};
}

/// Frame by frame; NaN where there is nothing.
PageJson columns_of(const MapRun& run) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const bool posed = run.maps.ground != nullptr;
  std::vector<double> time, state, x, y, z, height, sigma_height, tilt, sigma_tilt, hits, floor,
      misses;
  for (const MapRunFrame& f : run.frames) {
    const MappedFrame& m = f.mapped;
    const bool entered = posed && m.state != Mapping::kRejected;
    Eigen::Vector3d t = Eigen::Vector3d::Constant(nan);
    if (entered) t = m.T_WC.translation();
    time.push_back(m.stamp - run.frames[0].mapped.stamp);
    state.push_back(static_cast<int>(m.state));
    x.push_back(t.x());
    y.push_back(t.y());
    z.push_back(t.z());
    const GroundPlane& g = m.ground;
    height.push_back(g.found ? g.height : nan);
    sigma_height.push_back(g.found ? g.sigma_height() : nan);
    // With poses how far the ground is from level; without, how far the camera looks down.
    const double angle = posed ? std::atan2(f.up.head<2>().norm(), f.up.z()) : g.pitch();
    tilt.push_back(g.found ? kDegrees * angle : nan);
    sigma_tilt.push_back(g.found ? kDegrees * g.sigma_tilt() : nan);
    hits.push_back(m.hits);
    floor.push_back(m.floor);
    misses.push_back(m.misses);
  }
  PageJson columns;
  for (const auto& [name, values] :
       std::initializer_list<std::pair<const char*, const std::vector<double>*>>{
           {"time", &time},
           {"state", &state},
           {"x", &x},
           {"y", &y},
           {"z", &z},
           {"height", &height},
           {"sigma_height", &sigma_height},
           {"tilt", &tilt},
           {"sigma_tilt", &sigma_tilt},
           {"hits", &hits},
           {"floor", &floor},
           {"misses", &misses}}) {
    columns[name] = float_column(*values);
  }
  return columns;
}

/// The hypotheses of the floor, each with its course.
PageJson hypotheses_of(const MapRun& run) {
  PageJson all = PageJson::array();
  for (const GroundRecord& r : run.ground) {
    while (static_cast<int>(all.size()) <= r.hypothesis) {
      all.push_back({{"frames", PageJson::array()},
                     {"height", PageJson::array()},
                     {"sigma", PageJson::array()},
                     {"taken", PageJson::array()}});
    }
    PageJson& one = all[static_cast<std::size_t>(r.hypothesis)];
    one["frames"].push_back(r.frame);
    one["height"].push_back(r.height);
    one["sigma"].push_back(r.sigma_height);
    one["taken"].push_back(r.taken);
    one["support"] = r.support;
    one["pitch_deg"] = kDegrees * r.pitch;
    one["roll_deg"] = kDegrees * r.roll;
    one["sigma_tilt_deg"] = kDegrees * r.sigma_tilt;
    one["why"] = r.why;
  }
  return all;
}

PageJson data_of(const MapRun& run, const PageJson& summary) {
  PageJson reasons = PageJson::object();
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const std::string& reason = run.frames[k].mapped.reason;
    if (!reason.empty()) reasons[std::to_string(k)] = reason;
  }
  const bool mapped = run.maps.ground != nullptr;
  return {{"frames", run.frames.size()},
          {"columns", columns_of(run)},
          {"reasons", reasons},
          {"hypotheses", hypotheses_of(run)},
          {"voxels", mapped ? voxels_of(run.maps) : PageJson()},
          {"ground", mapped ? ground_of(run) : PageJson()},
          {"summary", summary}};
}

std::string page_of(const PageJson& data, const PageJson& summary, bool mapped) {
  // The recording's own folder, of a path that may end in a slash.
  std::filesystem::path path = summary.value("dataset", std::string());
  if (!path.has_filename()) path = path.parent_path();
  return fill_page(
      map_assets::map_html(),
      {{"{{title}}", escape_html(path.filename().string())},
       {"{{library style}}", library_text(page_assets::dygraph_style())},
       {"{{style}}", std::string(page_assets::style()) + std::string(map_assets::map_css())},
       {"{{run}}", json_text(data)},
       {"{{library}}", script_text(page_assets::dygraph_script())},
       {"{{three}}", mapped ? script_text(map_assets::three_script()) : std::string()},
       {"{{controls}}", mapped ? script_text(map_assets::orbit_script()) : std::string()},
       {"{{script}}", page_script(map_assets::map_js())}});
}

}  // namespace

std::string map_page(const MapRun& run, const PageJson& summary) {
  return page_of(data_of(run, summary), summary, run.maps.ground != nullptr);
}

std::string map_page(const MapRun& run, const PageJson& summary, const MapRun& drawn,
                     const PageJson& drawn_summary) {
  PageJson data = data_of(run, summary);
  data["drawn"] = data_of(drawn, drawn_summary);
  return page_of(data, summary, run.maps.ground != nullptr);
}

}  // namespace prospect
