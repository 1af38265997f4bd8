#pragma once

#include <span>

namespace prospect {

/// What becomes of a field of a message.
enum class FieldUse {
  kUsed,      ///< what it says is taken into account
  kRefused,   ///< a message in which it says anything but the usual is refused
  kNotNeeded  ///< it says nothing that matters here, and `why`
};

struct MessageField {
  const char* name;  ///< "roi.x_offset"; of a sequence of messages, "fields.name"
  FieldUse use;
  const char* why = "";
};

/// Every field of a type of sensor_msgs that ros_messages.h or ros_scan_messages.h reads, once:
/// of CameraInfo, Image, LaserScan or PointCloud2; empty of others. A test holds the tables against
/// the messages' definitions, and against what reading makes of each field.
std::span<const MessageField> fields_of(const char* type);

}  // namespace prospect
