// SPDX-License-Identifier: Apache-2.0
#include "runtime/stream_watch.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace prospect {

StreamWatch::StreamWatch(std::vector<PreflightFacts::Stream> streams, double now)
    : streams_(std::move(streams)), since_(streams_.size(), now) {
  for (PreflightFacts::Stream& stream : streams_) {
    stream.age = std::numeric_limits<double>::infinity();
    stream.live_for = 0.0;
  }
}

void StreamWatch::look(std::size_t k, std::optional<double> newest, double now) {
  PreflightFacts::Stream& stream = streams_[k];
  stream.age = newest ? now - *newest : std::numeric_limits<double>::infinity();
  if (!(stream.age <= stream.limit)) since_[k] = now;
  stream.live_for = now - since_[k];
}

bool StreamWatch::live_for(double seconds) const {
  return std::all_of(streams_.begin(), streams_.end(),
                     [&](const PreflightFacts::Stream& s) { return s.live_for > seconds; });
}

}  // namespace prospect
