// SPDX-License-Identifier: Apache-2.0
// depth/NNN.png, or other images that hold depths.

#include <filesystem>

#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/trajectory.h"

namespace prospect {

bool is_numbered_depth(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_directory(path + "/depth", error);
}

DepthSource open_numbered_depth(const std::string& path, const DepthDatasetOptions&) {
  DepthSource source;
  source.layout = "numbered";
  source.attempt([&] {
    const NumberedImages images = numbered_images(path + "/depth");
    std::vector<std::int64_t> numbers;
    std::vector<double> stamps;
    std::vector<std::string> paths;
    for (const NumberedImage& image : images.images) {
      numbers.push_back(image.number);
      paths.push_back(image.path);
    }
    double unit = 1e-9;
    if (!images.decimal) {
      const auto stamped = counts_frames(numbers) ? std::nullopt : stamp_unit(numbers);
      source.times_assumed = !stamped;
      source.notes.push_back(stamped ? "names are stamps, in " + std::string(stamped->name) +
                                           ", by their rate"
                                     : "no times: 30 a second assumed");
      unit = stamped ? stamped->seconds : 1.0 / 30.0;
    }
    for (const std::int64_t n : numbers) stamps.push_back(static_cast<double>(n) * unit);
    source.images = image_files(path + "/depth", std::move(stamps), std::move(paths));
  });
  return source;
}

}  // namespace prospect
