// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "models/camera.h"
#include "models/image.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

struct StereoDepthOptions {
  double nearest = 0.4;        ///< depth to be measured, if most_disparities allow it [m]
  int most_disparities = 128;  ///< that are searched; rounded up to a multiple of 16
  int window = 7;              ///< side of the blocks whose grey levels are compared [px], odd
  /// The best disparity must cost less than any other one, but for its neighbours, by this share.
  double distinctness = 0.1;
  int max_inconsistency = 1;       ///< left to right and back [px]
  int least_surface = 100;         ///< pixels of a surface; fewer are none
  int block = 9;                   ///< side of the blocks whose slopes are compared [px], odd
  double least_correlation = 0.5;  ///< of these slopes
  /// Error of a disparity that is kept, one standard deviation [px].
  double sigma_disparity = 0.4;
  double most_error = 0.1;  ///< standard deviation of a depth that is kept, as a share of it
};

/// Dense depth of the left camera from a rectified pair: semi-global matching (Hirschmueller 2008)
/// as OpenCV has it (cv::StereoSGBM, three directions), then z = f b / d of each disparity d.
///
/// Such a matching gives nearly every pixel a disparity: where nothing is seen, that of the pixels
/// beside it. So a pixel has a depth only if its disparity is
///   distinct    no other one fits nearly as well; else the texture repeats itself;
///   consistent  the search from right to left comes back; else one camera does not see the point;
///   coherent    at least `least_surface` pixels hang together by steps of at most 1 px;
///   measured    the slopes of the grey levels along the row, in the block around the pixel and in
///               the block that it matches, have a correlation of at least `least_correlation`: so
///               much of them is the scene's texture, the rest is noise, which both images have of
///               their own. On a plain wall the correlation is about 0, and so it is along an edge
///               that lies in the row. Slopes that vary by no more than the rounding of grey levels
///               are none;
///   in range    the depth is within range(), and its match within the right image.
/// All others are NaN. Nothing is filled in. A surface reaches up to half a block beyond its edge.
///
/// The standard deviation of a depth is noise() z^2, noise() = sigma_disparity / (f b).
///
/// Thread-safety: one thread at a time; it keeps its buffers. Errors: the constructor throws
/// std::invalid_argument on a wrong camera or options; depth() gives an empty image for images of
/// another size than the camera's. Determinism: same images, same bits.
class StereoDepth {
 public:
  explicit StereoDepth(const StereoCamera& camera, const StereoDepthOptions& options = {});
  ~StereoDepth();
  StereoDepth(StereoDepth&&) noexcept;
  StereoDepth& operator=(StereoDepth&&) noexcept;

  DepthImage depth(const ImageView& left, const ImageView& right);

  /// From the largest disparity that is searched to where the error is most_error [m].
  const DepthRange& range() const { return range_; }
  double noise() const { return noise_; }  ///< [1/m]

 private:
  struct Matcher;
  StereoCamera camera_;
  StereoDepthOptions options_;
  DepthRange range_;
  double noise_ = 0.0;
  std::unique_ptr<Matcher> matcher_;
};

}  // namespace prospect
