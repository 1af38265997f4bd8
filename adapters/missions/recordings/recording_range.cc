// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/recording_range.h"

#include <algorithm>

#include "adapters/formats/files/input_error.h"

namespace prospect {

int frames_from(int first, int max_frames, int size) {
  const int rest = std::max(0, size - first);
  return max_frames > 0 ? std::min(max_frames, rest) : rest;
}

void check_first_frame(int first, int size, const std::string& name) {
  if (first < size) return;
  throw InputError("--from is " + std::to_string(first) + "; expected less than the " +
                   std::to_string(size) + " frames of " + name);
}

std::string cancelled_note(std::size_t frames, int of) {
  return "cancelled after " + std::to_string(frames) + " of " + std::to_string(of) + " frames";
}

}  // namespace prospect
