#include "runtime/watched_stream.h"

namespace prospect {

WatchedStream watched(const SensorInbox& inbox, SensorStream stream, const std::string& source,
                      double limit) {
  return {source, limit, [&inbox, stream](const Belief*) { return inbox.count(stream).newest; },
          [&inbox, stream] { return inbox.count(stream); }};
}

}  // namespace prospect
