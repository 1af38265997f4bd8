// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cv {
class Mat;
}  // namespace cv

namespace prospect {

/// Images as the bytes of their files, by OpenCV's codecs. These bring some eighty libraries, which
/// take longer to load than many a command takes to run: they are loaded at the first use, for all
/// of the process, and stay.
///
/// Thread-safety: any thread. Where the codecs cannot be loaded, load_image_codecs() and
/// decode_pixels() throw InputError in one line, `library: why; expected what`.

/// The first use, ahead of time: for who encodes or decodes where nothing may wait for a library,
/// or fail for want of it.
void load_image_codecs();

/// The same for who only writes PNG, which needs no codecs where there are none (plain_png.h).
void load_image_codecs_if_there() noexcept;

/// cv::imdecode(): the pixels of `bytes`, one row of CV_8UC1, as `flags` (cv::ImreadModes) ask for
/// them. Empty where they are no image. Throws cv::Exception as OpenCV does.
cv::Mat decode_pixels(const cv::Mat& bytes, int flags);

/// cv::imencode(): `pixels` in the format of `ending` (".png"), with `parameters`
/// (cv::ImwriteFlags and their values, in pairs). Empty where they cannot be written so. Throws
/// cv::Exception as OpenCV does, such as of an ending that it does not know. Where the
/// codecs cannot be loaded, PNG is written all the same, with other bytes of the same pixels, and
/// anything else is empty.
std::vector<std::uint8_t> encode_pixels(const std::string& ending, const cv::Mat& pixels,
                                        const std::vector<int>& parameters = {});

}  // namespace prospect
