// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/stereo_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect::stereo_calibration_test {
namespace {

using ::testing::HasSubstr;

/// K with 300 px, P with 280 px.
CameraInfo depth_info() {
  CameraInfo info;
  info.width = 640.0;
  info.height = 480.0;
  info.model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {300.0, 0.0, 320.0, 0.0, 300.0, 240.0, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {280.0, 0.0, 318.0, 0.0, 0.0, 281.0, 239.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

TEST(DepthCamera, RectifiedImagesAreReadByPOthersByK) {
  std::vector<std::string> notes;
  CameraInfo info = depth_info();
  EXPECT_EQ(depth_camera_of(info, true, "info", notes).fx, 280.0);
  EXPECT_EQ(depth_camera_of(info, true, "info", notes).fy, 281.0);
  EXPECT_EQ(depth_camera_of(info, false, "info", notes).fx, 300.0);
  info.P.assign(12, 0.0);  // a camera that knows of no rectification
  EXPECT_EQ(depth_camera_of(info, true, "info", notes).fx, 300.0);
  EXPECT_TRUE(notes.empty());
}

TEST(DepthCamera, ALensIsToldOrRefused) {
  std::vector<std::string> notes;
  CameraInfo info = depth_info();
  info.D[0] = 0.002;
  EXPECT_EQ(depth_camera_of(info, false, "info", notes).fx, 300.0);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], HasSubstr("info: states a lens that moves pixels by up to 1.4 px"));
  info.D[0] = 0.05;
  EXPECT_NO_THROW(depth_camera_of(info, true, "info", notes));
  try {
    depth_camera_of(info, false, "info", notes);
    ADD_FAILURE() << "a lens";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("px, and nothing says that its depth images are "
                                        "rectified; expected rectified ones"));
  }
}

TEST(DepthCamera, RTurnsTheRectifiedCamera) {
  CameraInfo info = depth_info();
  EXPECT_TRUE(rectified_axes(info).isApprox(Eigen::Isometry3d::Identity()));
  info.R = {0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0};
  // x of the rectified camera is R's first row.
  EXPECT_TRUE(rectified_axes(info).linear().col(0).isApprox(Eigen::Vector3d::UnitY()));
  info.R.assign(9, 0.0);
  EXPECT_TRUE(rectified_axes(info).isApprox(Eigen::Isometry3d::Identity()));
}

TEST(DepthCamera, NamesOfRectifiedTopics) {
  for (const char* yes : {"/left/image_rect", "/depth/image_rect_raw", "/rect/left"}) {
    EXPECT_TRUE(is_named_rectified(yes)) << yes;
  }
  for (const char* no : {"/left/image_raw", "/direct/left", "/correction/depth"}) {
    EXPECT_FALSE(is_named_rectified(no)) << no;
  }
}

}  // namespace
}  // namespace prospect::stereo_calibration_test
