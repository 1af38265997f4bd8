// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace cv {
class Mat;
}  // namespace cv

namespace prospect {

/// A PNG of `pixels`, 8 or 16 bit grey, 8 bit BGR or BGRA, each row as it is (no filter), packed by
/// zlib. For builds without OpenCV's codecs (PROSPECT_COPYLEFT=OFF), whose pages and figures have
/// pictures, too. Empty for another type of pixels and for none. The same pixels give the same
/// bytes. Thread-safety: any thread.
std::vector<std::uint8_t> plain_png(const cv::Mat& pixels);

}  // namespace prospect
