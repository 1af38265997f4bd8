// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "models/image.h"
#include "runtime/frame_sink.h"

namespace prospect {

struct Belief;

/// What one camera delivers, shared, not copied: an image; or, of a camera that is a model, the
/// estimate that perception would have made with it. Neither: it is empty.
struct CameraContent {
  CameraContent() = default;
  CameraContent(Image picture) : image(std::make_shared<const Image>(std::move(picture))) {}
  CameraContent(std::shared_ptr<const Image> picture) : image(std::move(picture)) {}
  CameraContent(std::shared_ptr<const Belief> made) : estimate(std::move(made)) {}

  std::shared_ptr<const Image> image;
  std::shared_ptr<const Belief> estimate;
};

/// A FrameSink that takes the images of a stereo camera also one by one.
class ImageSink : public FrameSink {
 public:
  virtual void left(double stamp, CameraContent content) = 0;
  virtual void right(double stamp, CameraContent content) = 0;
};

}  // namespace prospect
