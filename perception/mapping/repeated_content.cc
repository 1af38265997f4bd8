// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/repeated_content.h"

namespace prospect {
namespace {

constexpr double kMoved = 0.02, kTurned = 0.02;  // [m], [rad]

}  // namespace

bool RepeatedContent::hangs(bool same, const std::optional<Eigen::Isometry3d>& T) {
  if (!same) *this = {};
  if (!T) {
    since_.reset();
    return hangs_;
  }
  if (!since_) since_ = *T;
  hangs_ = hangs_ || (T->translation() - since_->translation()).norm() > kMoved ||
           Eigen::AngleAxisd(since_->linear().transpose() * T->linear()).angle() > kTurned;
  return hangs_;
}

}  // namespace prospect
