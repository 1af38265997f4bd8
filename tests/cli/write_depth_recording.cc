// Writes recordings of a rendered room for the command-line test: FOLDER/posed (7-Scenes layout)
// and FOLDER/robot (numbered images without poses).
#include <string>

#include "tests/perception/depth_recording.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  prospect::test::DepthRecording recording;
  recording.frames = 5;
  recording.write_seven_scenes(std::string(argv[1]) + "/posed");
  recording.write_numbered(std::string(argv[1]) + "/robot");
  return 0;
}
