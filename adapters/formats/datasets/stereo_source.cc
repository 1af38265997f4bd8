// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/stereo_source.h"

#include <filesystem>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/rgbd_folder.h"

namespace prospect {

const std::vector<StereoLayout>& stereo_layouts() {
  static const std::vector<StereoLayout> layouts = {
      {"ROS 2 bag", "a .mcap or .db3 file (ROS 2 bag)", is_bag, open_stereo_bag},
      {"KITTI raw",
       "image_00/data and calib_cam_to_cam.txt (KITTI raw), image_00/data_rect (KITTI-360)",
       is_kitti_raw, open_kitti_raw},
      {"EuRoC", "mav0/cam0 and mav0/cam1 with sensor.yaml and data (EuRoC)", is_euroc, open_euroc},
      {"videos",
       "videos left.mp4 and right.mp4, or the like, with a calibration; a video of both side by "
       "side",
       is_video_pair, open_video_pair},
      {"folders",
       "calib.txt with image_0 and image_1, or image_2 and image_3 (KITTI odometry); "
       "left and right, or the like, with a calibration",
       is_folder_pair, open_folder_pair},
  };
  return layouts;
}

const StereoLayout* find_stereo_layout(const std::string& path) {
  return find_layout(stereo_layouts(), path);
}

StereoSource open_stereo_source(const std::string& path, const StereoDatasetOptions& options) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (const StereoLayout* layout = find_stereo_layout(path)) {
    StereoSource source = layout->open(path, options);
    if (source.calibration && !source.calibration->others.empty() && source.left.size() > 0) {
      source.attempt([&] {
        const RawImage image = first_readable(source.left);
        source.calibration = of_size(*source.calibration, image.width, image.height);
      });
    }
    return source;
  }
  const std::string known = looked_for(stereo_layouts(), "; ");
  if (!fs::exists(path, error)) {
    throw InputError(path + ": no such folder; expected a recording of a stereo pair");
  }
  if (!fs::is_directory(path, error)) {
    if (path.ends_with(".bag")) {
      throw InputError(
          path +
          ": a bag of ROS 1, which is not read; expected one of ROS 2: rosbags-convert "
          "makes one of it");
    }
    throw InputError(path + ": a file that is no recording; expected a folder with " + known);
  }
  if (is_rgbd_folder(path)) {
    throw InputError(path +
                     ": a recording of one camera and depth, for `prospect map`; expected a stereo "
                     "pair: " +
                     known);
  }
  throw InputError(path + ": no recording of a stereo pair is there; looked for " + known +
                   "; expected one of these");
}

}  // namespace prospect
