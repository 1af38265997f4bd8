// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/odometry_page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "adapters/missions/recordings/odometry_assets.h"
#include "adapters/views/page/binary_text.h"
#include "adapters/views/page/html_page.h"
#include "adapters/views/page/page_assets.h"

namespace prospect {
namespace {

constexpr int kPictureWidth = 640;  // [px], at most

/// The two axes of W that a view from above shows, to the right and upwards: above is where the
/// images' upper edges are.
std::pair<int, int> map_axes(const std::vector<OdometryFrame>& frames) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const OdometryFrame& f : frames) up -= f.T_WC.linear().col(1);
  int axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  // The other two in the order that makes a right-handed system with up.
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  return up[axis] >= 0.0 ? std::pair(a, b) : std::pair(b, a);
}

class Columns {
 public:
  void add(const char* name, const std::vector<double>& values) {
    BinaryText text;
    for (const double v : values) text.add_float(v);
    json_[name] = text.base64();
  }
  const nlohmann::ordered_json& json() const { return json_; }

 private:
  nlohmann::ordered_json json_ = nlohmann::ordered_json::object();
};

/// The path by all loops, a column an axis and one of its errors, of all frames; not a number where
/// there is no pose, or no truth.
struct LoopedPath {
  std::vector<double> x, y, error;

  LoopedPath(const std::vector<OdometryFrame>& frames,
             const std::vector<std::optional<Eigen::Isometry3d>>& truths,
             const OdometryLoopsResult& loops, int right, int up) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::optional<Eigen::Isometry3d> alignment;
    auto next = loops.final.begin();
    for (std::size_t k = 0; k < frames.size(); ++k) {
      while (next != loops.final.end() && next->stamp < frames[k].stamp) ++next;
      const bool there = next != loops.final.end() && next->stamp == frames[k].stamp;
      x.push_back(there ? next->T.translation()[right] : nan);
      y.push_back(there ? next->T.translation()[up] : nan);
      error.push_back(nan);
      if (!there || !truths[k]) continue;
      if (!alignment) alignment = next->T * truths[k]->inverse();
      error.back() = (*alignment * truths[k]->translation() - next->T.translation()).norm();
    }
  }
};

/// Of each loop: the frames that show the same, and where they are.
nlohmann::ordered_json loops_json(const std::vector<OdometryFrame>& frames,
                                  const OdometryLoopsResult& loops, int right, int up) {
  const auto frame_at = [&](double stamp) {
    const auto at =
        std::lower_bound(frames.begin(), frames.end(), stamp,
                         [](const OdometryFrame& f, double value) { return f.stamp < value; });
    return at - frames.begin();
  };
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const OdometryLoopsResult::Loop& loop : loops.loops) {
    json.push_back({{"older", frame_at(loop.older_stamp)},
                    {"newer", frame_at(loop.newer_stamp)},
                    {"from", {loop.older[right], loop.older[up]}},
                    {"to", {loop.newer[right], loop.newer[up]}}});
  }
  return json;
}

}  // namespace

OdometryPage::OdometryPage(int frames, int max_images) : every_(1) {
  if (frames < 1 || max_images < 1) {
    throw std::invalid_argument("odometry page: " + std::to_string(frames) + " frames and " +
                                std::to_string(max_images) + " images; expected one at least");
  }
  every_ = (frames + max_images - 1) / max_images;
}

void OdometryPage::add(const OdometryStep& step) {
  const int number = static_cast<int>(frames_.size());
  frames_.push_back(step.frame);
  truths_.push_back(step.true_T_WC);
  if (number % every_ != 0) return;
  pictures_.push_back(
      landmark_picture(number, step.images.left, step.odometry.sightings(), kPictureWidth));
}

std::string OdometryPage::html(const nlohmann::ordered_json& summary,
                               const OdometryLoopsResult* loops) const {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto [right, up] = map_axes(frames_);
  std::vector<double> time, state, expected, tracked, confirmed, made, x, y, true_x, true_y, error,
      turned, sigma, sigma_turn;
  nlohmann::ordered_json reasons = nlohmann::ordered_json::object();
  // Errors with the first poses aligned, from the first frame whose true pose is known.
  std::optional<Eigen::Isometry3d> alignment;
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    const OdometryFrame& f = frames_[k];
    time.push_back(f.stamp - frames_[0].stamp);
    state.push_back(f.state == Localization::kOk ? 0 : f.state == Localization::kDegraded ? 1 : 2);
    if (!f.reason.empty()) reasons[std::to_string(k)] = f.reason;
    expected.push_back(f.expected);
    tracked.push_back(f.tracked);
    confirmed.push_back(f.confirmed);
    made.push_back(f.matched);
    x.push_back(f.T_WC.translation()[right]);
    y.push_back(f.T_WC.translation()[up]);
    sigma.push_back(std::sqrt(f.covariance.topLeftCorner<3, 3>().trace()));
    sigma_turn.push_back(std::sqrt(f.covariance.bottomRightCorner<3, 3>().trace()) * 180.0 / M_PI);
    if (truths_[k] && !alignment) alignment = f.T_WC * truths_[k]->inverse();
    if (truths_[k] && alignment) {
      const Eigen::Isometry3d truth = *alignment * *truths_[k];
      const Eigen::Isometry3d E = truth.inverse() * f.T_WC;
      true_x.push_back(truth.translation()[right]);
      true_y.push_back(truth.translation()[up]);
      error.push_back(E.translation().norm());
      turned.push_back(Eigen::AngleAxisd(E.linear()).angle() * 180.0 / M_PI);
    } else {
      for (auto* column : {&true_x, &true_y, &error, &turned}) column->push_back(nan);
    }
  }
  Columns columns;
  columns.add("time", time);
  columns.add("state", state);
  columns.add("expected", expected);
  columns.add("tracked", tracked);
  columns.add("confirmed", confirmed);
  columns.add("made", made);
  columns.add("x", x);
  columns.add("y", y);
  columns.add("true_x", true_x);
  columns.add("true_y", true_y);
  columns.add("error", error);
  columns.add("turned", turned);
  columns.add("sigma", sigma);
  columns.add("sigma_turn", sigma_turn);
  if (loops) {
    const LoopedPath path(frames_, truths_, *loops, right, up);
    columns.add("looped_x", path.x);
    columns.add("looped_y", path.y);
    columns.add("looped_error", path.error);
  }
  const char* const kAxes[3] = {"x", "y", "z"};
  nlohmann::ordered_json run = {{"frames", frames_.size()},
                                {"axes", {kAxes[right], kAxes[up]}},
                                {"columns", columns.json()},
                                {"reasons", reasons},
                                {"pictures", pictures_json(pictures_)},
                                {"summary", summary}};
  if (loops) run["loops"] = loops_json(frames_, *loops, right, up);
  // The recording's own folder, of a path that may end in a slash.
  std::filesystem::path folder = summary.value("dataset", std::string());
  if (!folder.has_filename()) folder = folder.parent_path();
  return fill_page(odometry_assets::odometry_html(),
                   {{"{{title}}", escape_html(folder.filename().string())},
                    {"{{library style}}", library_text(page_assets::dygraph_style())},
                    {"{{style}}", std::string(page_assets::style()) +
                                      std::string(odometry_assets::odometry_css())},
                    {"{{run}}", json_text(run)},
                    {"{{library}}", script_text(page_assets::dygraph_script())},
                    {"{{script}}", page_script(odometry_assets::odometry_js())}});
}

}  // namespace prospect
