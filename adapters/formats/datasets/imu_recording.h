// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/bag_topics.h"
#include "models/imu_sample.h"

namespace prospect {

/// What an IMU beside a pair of cameras has measured. It is of use where its axes are known against
/// the cameras: else it is left out, and a note says why; the recording is used all the same.
struct ImuRecording {
  std::vector<ImuSample> samples;  ///< stamps increasing; R_BS: to the frame that the reader names
  std::string from;                ///< file or topic; empty: there is none
};

/// imu0/data.csv of EuRoC beside its sensor.yaml, in `root`: stamps in `unit` [s], angular
/// velocity, specific force a line; R_BS by T_BS, to the body of the cameras' T_BS.
ImuRecording read_euroc_imu(const std::string& root, double unit, std::vector<std::string>& notes);

/// A topic of sensor_msgs/msg/Imu: "imu" of `topics`, else the one with most samples. R_BS: to the
/// frame `camera`, by TF. Throws InputError where the topic that was given is none.
ImuRecording read_bag_imu(const BagFile& bag, const std::string& path, const TopicChoice& topics,
                          const std::string& camera, std::vector<std::string>& notes);

}  // namespace prospect
