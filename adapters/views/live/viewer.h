// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace prospect {

/// A message to a viewer; its text is shared by all who get the same.
struct LiveMessage {
  std::shared_ptr<const std::string> bytes;
  bool binary = false;
};

/// Somebody who watches, apart from how bytes get there: is asked for the next message when the one
/// before has gone out, so one that reads slowly is asked seldom, and nothing piles up.
/// Thread-safety: one thread.
class Viewer {
 public:
  virtual ~Viewer() = default;
  /// None: there is nothing to say by now.
  virtual std::optional<LiveMessage> next() = 0;
  /// What it says. False: it does not keep the protocol and is to be turned away.
  virtual bool message(std::string_view bytes, bool text) = 0;
  /// Messages that it was too slow for, so far.
  virtual std::uint64_t dropped() const = 0;
};

}  // namespace prospect
