// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/image_stream.h"

namespace prospect {

/// Videos, decoded by the program ffmpeg, which is looked for in PATH: a process of its own, of
/// limited memory, as decoders of foreign files crash on some. It reads nothing but the file, and
/// hands over one frame after the other.
///
/// Frames are grey, 8 bits: of colour their luminance, of more bits the upper 8; as they are
/// stored, not turned by what a phone says of how it was held. Stamps are the container's times of
/// presentation [s], at whatever rate and from whatever start. Frames that are damaged are left
/// out, and so is what is cut off at the end.
///
/// A file is decoded once for the stamps when it is opened, and again for the pixels, as they are
/// read: in order. Reading an earlier frame begins at the first one again. No other frame is kept
/// than the last that was read. Thread-safety of the streams: one thread at a time.

/// Whether a name ends as videos do, in any case.
bool is_video_name(const std::string& name);
/// A video whose name is `stem` and an ending of videos, in lower or upper case; "" if there is
/// none.
std::string find_video(const std::string& stem);

/// The frames of a video. What ffmpeg says of it, such as damage, is added to `notes`, one line.
/// Throws InputError, one line: not a regular file, no ffmpeg, no frame that it can decode, frames
/// of several sizes or of more than 100 million pixels, times that do not increase.
ImageStream video_images(const std::string& path, std::vector<std::string>& notes);

/// The left and the right half of each frame of a video, likewise. Throws also if the width is odd.
std::pair<ImageStream, ImageStream> side_by_side_images(const std::string& path,
                                                        std::vector<std::string>& notes);

}  // namespace prospect
