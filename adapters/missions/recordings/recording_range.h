// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace prospect {

/// How many of a recording's `size` frames are run: from frame `first` on, at most `max_frames` (0:
/// all).
int frames_from(int first, int max_frames, int size);

/// "cancelled after 3 of 12 frames".
std::string cancelled_note(std::size_t frames, int of);

/// Throws InputError, one line, if --from is not one of the `size` frames of the recording `name`.
void check_first_frame(int first, int size, const std::string& name);

}  // namespace prospect
