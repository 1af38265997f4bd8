// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace prospect {

/// A serial line: 8 data bits, no parity, one stop bit, no flow control, nothing translated. Nobody
/// else may open it meanwhile. Reading and writing return at once. One thread.
class SerialPort {
 public:
  /// Throws std::invalid_argument: "/dev/ttyUSB0: no such device; expected ...", and for a rate
  /// [baud] that there is not.
  SerialPort(const std::string& device, int rate);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// What has come; closed() tells an empty line from one that is gone.
  std::vector<std::uint8_t> read();
  /// Whole, or not at all while the line still holds what was written before: false.
  bool write(std::span<const std::uint8_t> bytes);
  bool closed() const { return closed_; }  ///< unplugged
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
  bool closed_ = false;
};

}  // namespace prospect
