// SPDX-License-Identifier: Apache-2.0
// depth.txt ('stamp path' a line) or associations.txt ('stamp path stamp path'), groundtruth.txt.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/numbered_files.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/files/parse_number.h"

namespace prospect {
namespace {

constexpr double kTumScale = 5000.0;    // [1/m]
constexpr double kSamePoseTime = 0.02;  // [s]

struct TumFrame {
  double stamp = 0.0;
  std::string path;
};

std::vector<TumFrame> read_tum_list(const std::string& folder, const std::string& list) {
  std::istringstream text(read_whole_file(list));
  std::vector<TumFrame> frames;
  std::string line;
  for (int n = 1; std::getline(text, line); ++n) {
    if (!line.empty() && line[0] == '#') continue;
    std::istringstream words(line);
    std::vector<std::string> word;
    for (std::string w; words >> w;) word.push_back(w);
    if (word.empty()) continue;
    const std::string where = list + ":" + std::to_string(n);
    // Of two images a line, that whose path speaks of depth.
    std::size_t at = 0;
    if (word.size() == 4 && word[1].find("depth") == std::string::npos) at = 2;
    TumFrame frame;
    if ((word.size() != 2 && word.size() != 4) || !parse_number(word[at], frame.stamp) ||
        !std::isfinite(frame.stamp)) {
      throw InputError(where + ": not a frame; expected 'stamp path'");
    }
    if (!frames.empty() && !(frame.stamp > frames.back().stamp)) {
      throw InputError(where + ": the stamp does not increase; expected increasing stamps");
    }
    frame.path = folder + "/" + word[at + 1];
    if (!std::filesystem::exists(frame.path)) {
      throw InputError(where + ": " + frame.path + " is absent; expected an image");
    }
    frames.push_back(frame);
  }
  if (frames.empty()) throw InputError(list + ": holds no frame; expected 'stamp path' lines");
  return frames;
}

/// Seconds of the stamps' unit, which is said if it is another one.
double tum_unit(const std::vector<TumFrame>& frames, DepthSource& source) {
  std::vector<double> stamps;
  for (const TumFrame& frame : frames) stamps.push_back(frame.stamp);
  const auto unit = unit_instead_of_seconds(stamps);
  if (!unit) return 1.0;
  source.notes.push_back("stamps in " + std::string(unit->name) +
                         ", by their rate; TUM's are in s");
  return unit->seconds;
}

}  // namespace

bool is_tum_rgbd(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path + "/depth.txt", error) ||
         std::filesystem::is_regular_file(path + "/associations.txt", error);
}

DepthSource open_tum_rgbd(const std::string& path, const DepthDatasetOptions&) {
  DepthSource source;
  source.layout = "TUM RGB-D";
  source.depth_scale = kTumScale;
  source.attempt([&] {
    const std::string depth = path + "/depth.txt";
    const std::string list = std::filesystem::exists(depth) ? depth : path + "/associations.txt";
    const std::vector<TumFrame> frames = read_tum_list(path, list);
    const double unit = tum_unit(frames, source);
    std::vector<double> stamps;
    std::vector<std::string> images;
    const std::string truth_path = path + "/groundtruth.txt";
    Trajectory truth;
    if (std::filesystem::exists(truth_path)) {
      truth = read_tum_trajectory(truth_path, source.notes);
      source.poses_of_quaternions = true;
      // In the unit of the images, if they are of the same time then.
      if (unit != 1.0 && truth.back().stamp > frames.front().stamp * unit * 10.0) {
        for (TimedPose& pose : truth) pose.stamp *= unit;
      }
    }
    for (const TumFrame& frame : frames) {
      const double stamp = unit == 1.0 ? frame.stamp : frame.stamp * unit;
      if (!truth.empty()) {
        auto next = std::lower_bound(truth.begin(), truth.end(), stamp,
                                     [](const TimedPose& p, double t) { return p.stamp < t; });
        if (next == truth.end() ||
            (next != truth.begin() && stamp - (next - 1)->stamp < next->stamp - stamp)) {
          --next;
        }
        if (std::abs(next->stamp - stamp) > kSamePoseTime) {
          ++source.without_pose;
          continue;
        }
        source.poses.push_back(next->T);
      }
      stamps.push_back(stamp);
      images.push_back(frame.path);
    }
    if (images.empty()) {
      throw InputError(truth_path +
                       ": has no pose within 0.02 s of a frame; expected the times of " + list);
    }
    if (source.without_pose > 0) {
      source.notes.push_back(std::to_string(source.without_pose) +
                             " frames without a pose within 0.02 s left out");
    }
    source.images = image_files(path, std::move(stamps), std::move(images));
  });
  return source;
}

}  // namespace prospect
