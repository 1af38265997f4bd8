// SPDX-License-Identifier: Apache-2.0
// The log of a mission, and the page that is made of it. By the first byte the rest is the file
// itself, or messages that are written to one: topic, time after the one before, length in two
// bytes, and the bytes, again and again. Bytes of a file that are changed do not get past its
// checksums.
#include <array>
#include <utility>

#include "adapters/formats/bags/mcap_writer.h"
#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/map_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/visualization_msgs.h"
#include "adapters/missions/log/logged_run.h"
#include "adapters/views/report/report.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

namespace {

// The corpus names them by their place.
constexpr std::array kTopics = {std::pair(topic::kStep, ros::DiagnosticArray::kType),
                                std::pair(topic::kPlan, ros::Path::kType),
                                std::pair(topic::kMarkers, ros::MarkerArray::kType),
                                std::pair(topic::kCostToGo, ros::PointCloud2::kType),
                                std::pair(topic::kMap, ros::OccupancyGrid::kType),
                                std::pair(topic::kMapUpdates, ros::OccupancyGridUpdate::kType),
                                std::pair(topic::kPictures, ros::CompressedImage::kType),
                                std::pair(topic::kPictureFeatures, ros::PointCloud2::kType)};

void write_messages(const std::string& path, std::string_view bytes) {
  McapWriter writer(path);
  std::array<std::uint16_t, kTopics.size()> channels{};
  for (std::size_t i = 0; i < kTopics.size(); ++i) {
    channels[i] = writer.add_channel(kTopics[i].first, kTopics[i].second, "");
  }
  std::uint64_t time = 0;
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); };
  while (bytes.size() >= 4) {
    time += byte(1);
    const std::size_t length = std::min<std::size_t>(byte(2) | byte(3) << 8, bytes.size() - 4);
    writer.message(channels[byte(0) % kTopics.size()], time, bytes.substr(4, length));
    bytes.remove_prefix(4 + length);
  }
  writer.close();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes = fuzz::text_of(data, size).substr(1);
  const std::string path = fuzz::folder().write("run.mcap", data[0] % 2 == 0 ? bytes : "");
  if (data[0] % 2 == 1) write_messages(path, bytes);
  fuzz::read_or_refuse([&] {
    const LoggedRun run = read_logged_run(path);
    for (const std::string& note : run.notes) {
      if (fuzz::is_clear(note)) continue;
      std::fprintf(stderr, "a note that is no clear line: '%s'\n", note.c_str());
      std::abort();
    }
    render_report(run.record);
  });
  return 0;
}
