// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/datasets/image_stream.h"
#include "adapters/formats/datasets/imu_recording.h"
#include "adapters/formats/datasets/recording_source.h"
#include "adapters/formats/datasets/stereo_calibration.h"
#include "adapters/formats/datasets/trajectory.h"

namespace prospect {

struct StereoDatasetOptions {
  /// File or files of the calibration (stereo_calibration.h), instead of the recording's own;
  /// empty: its own.
  std::string calibration;
  bool rectified = false;      ///< the images are rectified already, by a camera_info
  std::optional<double> sync;  ///< how far stamps of a pair may differ [s]
  std::optional<double> rate;  ///< [Hz], where images are only numbered
  /// Of a bag: "left", "right", "left_info", "right_info", "truth", "imu" to topics; all but truth
  /// are found by type and name where they are not given.
  std::map<std::string, std::string> topics;
  /// Of a bag: where no "truth" is given, what BagPoseChoice finds with this frame stands for it;
  /// none: it is not looked for.
  std::optional<std::string> fixed_frame;
};

/// What a layout finds in a recording of a stereo pair, before images are paired and rectified.
struct StereoSource : RecordingSource {
  ImageStream left, right;
  std::optional<StereoCalibration> calibration;
  Trajectory truth;            ///< of the left camera as it is, or of the body
  bool truth_of_body = false;  ///< of the body of the calibration's T_BC
  /// Its quaternions have no names in the file: w, which is last by rule, may be first.
  bool truth_of_quaternions = false;
  /// Its axes in the left camera as it is, or in the body.
  ImuRecording imu;
  bool imu_in_body = false;  ///< in the body of the calibration's T_BC
};

using StereoLayout = RecordingLayout<StereoSource, StereoDatasetOptions>;

/// All layouts, in the order in which they are asked.
const std::vector<StereoLayout>& stereo_layouts();

/// The first layout that recognises the path; null: none does.
const StereoLayout* find_stereo_layout(const std::string& path);

/// Opens with the layout that fits. Throws InputError if the path is absent or none does: what was
/// looked for.
StereoSource open_stereo_source(const std::string& path, const StereoDatasetOptions& options = {});

// The layouts, one a file.
/// Topics of a bag of ROS 2 (bag_file.h).
StereoSource open_stereo_bag(const std::string& path, const StereoDatasetOptions& options);
bool is_kitti_raw(const std::string& path);
StereoSource open_kitti_raw(const std::string& path, const StereoDatasetOptions& options);
bool is_euroc(const std::string& path);
StereoSource open_euroc(const std::string& path, const StereoDatasetOptions& options);
/// KITTI odometry, and any pair of folders: with calib.txt or with another calibration.
bool is_folder_pair(const std::string& path);
StereoSource open_folder_pair(const std::string& path, const StereoDatasetOptions& options);
/// Two videos in a folder, or one file with both images side by side (video_file.h).
bool is_video_pair(const std::string& path);
StereoSource open_video_pair(const std::string& path, const StereoDatasetOptions& options);

}  // namespace prospect
