// SPDX-License-Identifier: Apache-2.0
// Bags of ROS 2, MCAP or SQLite by the first byte, with all their messages.
#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  if (size == 0) return 0;
  const std::string path =
      fuzz::folder().write(data[0] % 2 == 0 ? "a.mcap" : "a.db3", bytes.substr(1));
  fuzz::read_or_refuse([&] {
    const BagFile bag = BagFile::open(path);
    for (const BagTopic& topic : bag.topics()) {
      for (const BagTopic::Message& message : topic.messages) {
        const std::string content = bag.read(message);
        fuzz::read_or_refuse([&] { read_ros_image(content, false, topic.name); });
      }
    }
  });
  return 0;
}
