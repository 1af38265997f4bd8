// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/datasets/raw_image.h"

namespace prospect {

/// The images of one camera in a recording, in the order of their stamps; read one by one.
struct ImageStream {
  std::string name;                ///< folder or topic, for messages
  std::vector<double> stamps;      ///< [s]
  std::vector<std::string> names;  ///< of each image, for messages: its path, or topic and time
  /// Image i. Throws InputError where it cannot be read. One thread at a time; of a video quick in
  /// order only (video_file.h).
  std::function<RawImage(std::size_t i)> read;

  std::size_t size() const { return stamps.size(); }
};

/// The first image that can be read. Throws InputError, the first image's line, if none can.
RawImage first_readable(const ImageStream& images);

/// A file whose name ends in a number.
struct NumberedImage {
  /// The number, or if it has a decimal point, a time in seconds, its nanoseconds.
  std::int64_t number = 0;
  std::string path;
};

/// The images of a folder (raw_image.h), by the last number in their names; what is before and
/// behind it is the same for all ("left_000012.png", "12_rect.png", "1700000000.25.png"). Hidden
/// files and what is no image are passed over.
struct NumberedImages {
  std::vector<NumberedImage> images;
  bool decimal = false;  ///< the numbers are nanoseconds: names state seconds
};
/// Throws InputError, one line: no such folder, no image in it, a name without a number or named
/// otherwise than the others, the same number twice.
NumberedImages numbered_images(const std::string& folder);

/// Which line of a file with a line a frame, such as times.txt or poses.txt, belongs to each image,
/// from 0 on: the images' order, if there are as many lines as images, wherever their numbers begin
/// and whatever their step; else their numbers counted from 0, as KITTI's are; else, if that is too
/// few lines, from the first image's number on. `notes` say if it is not by numbers from 0. Throws
/// InputError, of `file`, if there are too few lines for all of these.
std::vector<std::size_t> lines_of_images(const std::vector<std::int64_t>& numbers,
                                         std::size_t lines, const std::string& file,
                                         std::vector<std::string>& notes);

/// A stream of files: the stamps are given, one for each.
ImageStream image_files(const std::string& name, std::vector<double> stamps,
                        std::vector<std::string> paths);

/// A unit that stamps may be in.
struct StampUnit {
  double seconds = 1.0;
  const char* name = "s";
};
/// Whether numbers merely count frames: small ones, mostly ten apart at most.
bool counts_frames(const std::vector<std::int64_t>& numbers);
/// The unit, of s, ms, us and ns, in which increasing stamps come 0.2 to 200 times a second in the
/// median (exactly one does), or, if a rate is given [Hz], nearest to that. Of a single stamp, and
/// where no unit gives such a rate, the one in which they are dates between 2001 and 2065. None if
/// that fails, too.
std::optional<StampUnit> stamp_unit(const std::vector<std::int64_t>& stamps, double rate = 0.0);
/// The unit of increasing stamps that are s by rule, but come too rarely for it. None: they are s.
std::optional<StampUnit> unit_instead_of_seconds(const std::vector<double>& stamps);

/// The median of the steps between neighbours [s]; NaN for less than two.
double median_step(const std::vector<double>& stamps);

}  // namespace prospect
