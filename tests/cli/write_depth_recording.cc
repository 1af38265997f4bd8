// SPDX-License-Identifier: Apache-2.0
// Writes recordings for the command-line test: of a rendered room FOLDER/posed (7-Scenes layout)
// and FOLDER/robot (numbered images without poses), of a room's outline FOLDER/lidar.log (CARMEN).
#include <fstream>
#include <string>

#include "tests/adapters/lidar_recording.h"
#include "tests/perception/depth_recording.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  prospect::test::DepthRecording recording;
  recording.frames = 5;
  recording.write_seven_scenes(std::string(argv[1]) + "/posed");
  recording.write_numbered(std::string(argv[1]) + "/robot");
  prospect::test::LidarRecording lidar;
  lidar.T_BS = prospect::test::LidarRecording::at(0.1, 0.0, 0.0, 0.0);
  std::ofstream(std::string(argv[1]) + "/lidar.log") << lidar.carmen_log();
  return 0;
}
