// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "runtime/preflight.h"

namespace prospect {

/// For how long each of a robot's streams has been within its limit: what pre-flight asks.
/// A value; one thread at a time.
class StreamWatch {
 public:
  /// Of the streams, names and limits count. now [s].
  StreamWatch(std::vector<PreflightFacts::Stream> streams, double now);

  /// Of one of them, the capture of its newest measurement [s]; none: nothing has come.
  void look(std::size_t stream, std::optional<double> newest, double now);

  /// All have been within their limits for more than that [s].
  bool live_for(double seconds) const;
  /// As of the last look at each.
  const std::vector<PreflightFacts::Stream>& streams() const { return streams_; }

 private:
  std::vector<PreflightFacts::Stream> streams_;
  std::vector<double> since_;  // [s] that each has been within its limit
};

}  // namespace prospect
