#include "adapters/formats/datasets/depth_dataset.h"

#include <utility>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/stereo_calibration.h"
#include "adapters/formats/datasets/trajectory.h"

namespace prospect {

DepthDataset DepthDataset::open(const std::string& path, const DepthDatasetOptions& options) {
  return open(open_depth_source(path, options), options);
}

DepthDataset DepthDataset::open(DepthSource source, const DepthDatasetOptions& options) {
  if (!source.missing.empty()) throw InputError(source.missing[0]);
  DepthDataset dataset;
  dataset.layout_ = source.layout;
  dataset.stereo_ = source.stereo;
  dataset.range_ = source.stereo ? source.stereo->range : options.range;
  dataset.times_assumed_ = source.times_assumed;
  dataset.without_pose_ = source.without_pose;
  dataset.camera_ = *source.camera;
  dataset.images_ = source.images;
  PinholeCamera& camera = dataset.camera_;
  const RawImage first = first_readable(source.images);
  if (camera.width != 0.0 && (camera.width != first.width || camera.height != first.height)) {
    throw InputError(source.camera_from + ": is for images of " + number_text(camera.width) +
                     " x " + number_text(camera.height) + " pixels, these have " +
                     std::to_string(first.width) + " x " + std::to_string(first.height) +
                     "; expected the same");
  }
  camera.width = first.width;
  camera.height = first.height;
  check_principal_point(source.camera_from, camera);
  dataset.scale_ = choose_depth_scale(source, options, camera,
                                      [&](std::size_t i) { return dataset.read_raw(i); });
  if (dataset.scale_.w_first) {
    for (Eigen::Isometry3d& pose : source.poses) pose = with_w_first(pose);
  }
  dataset.poses_ = std::move(source.poses);
  dataset.notes_ = std::move(source.notes);
  dataset.notes_.push_back(dataset.scale_.note);
  return dataset;
}

RawImage DepthDataset::read_raw(std::size_t i) const {
  RawImage raw = images_.read(i);
  const std::string& name = images_.names[i];
  if (raw.kind == RawImage::Kind::k8 || raw.channels != 1) {
    throw InputError(name +
                     ": not of 16 bits a pixel; expected a depth image, 16-bit grey or floats");
  }
  if (raw.width != camera_.width || raw.height != camera_.height) {
    throw InputError(name + ": has " + std::to_string(raw.width) + " x " +
                     std::to_string(raw.height) + " pixels, the first image " +
                     number_text(camera_.width) + " x " + number_text(camera_.height) +
                     "; expected the same");
  }
  return raw;
}

DepthImage DepthDataset::read(int i) const {
  return scaled_depth(read_raw(static_cast<std::size_t>(i)), scale_.per_metre, range_);
}

}  // namespace prospect
