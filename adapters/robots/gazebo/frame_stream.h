// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace prospect {

/// A TCP connection of Gazebo's transport: frames, each eight hexadecimal digits of length (padded
/// with blanks) and so many bytes. It owns the descriptor, which does not block.
///
/// A connection that the other side closes, a length that is none or beyond the limit, and a
/// subscriber who does not read close it; closed() says why. Nothing that was cut off is handed on.
///
/// Thread-safety: one thread at a time. Nothing here throws but connect() and memory that is used
/// up.
class FrameStream {
 public:
  static constexpr std::size_t kMostQueued = std::size_t{1}
                                             << 20;  ///< [bytes] that wait to be sent

  /// Takes over a connected descriptor; frames are of at most `limit` bytes.
  FrameStream(int descriptor, std::size_t limit);
  /// Waits at most `timeout` [s]. Throws InputError: no such host, or nobody listens there.
  static FrameStream connect(const std::string& host, int port, double timeout, std::size_t limit);
  ~FrameStream();
  FrameStream(FrameStream&& other) noexcept;
  FrameStream& operator=(FrameStream&& other) noexcept;

  int descriptor() const { return descriptor_; }  ///< -1: closed
  bool waits_to_send() const { return !out_.empty(); }
  /// Why it is closed; empty: it is open.
  const std::string& closed() const { return closed_; }

  /// Queues a frame and sends what can be sent at once.
  void send(std::string_view frame);
  void flush();
  /// Reads what has come; calls `take` for each whole frame, which is valid for that call.
  void receive(const std::function<void(std::string_view)>& take);

 private:
  void close(const std::string& why);

  int descriptor_ = -1;
  std::size_t limit_ = 0;
  std::string in_, out_;
  std::string closed_;
};

}  // namespace prospect
