// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/point_cloud_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "tests/adapters/mesh_files.h"
#include "tests/adapters/point_clouds.h"

namespace prospect::point_cloud_file_test {
namespace {

const std::vector<Eigen::Vector3d> kPoints = {{1, 2, 3}, {-0.5, 0.25, 8}, {4, 5, -6}};

void expect_points(const PointCloud& cloud, const std::string& what) {
  ASSERT_EQ(cloud.points.size(), kPoints.size()) << what;
  for (std::size_t n = 0; n < kPoints.size(); ++n) {
    EXPECT_EQ(cloud.points[n], kPoints[n]) << what;
  }
}

TEST(PointCloudFile, PcdInAllThreeForms) {
  const test::Folder folder("clouds pcd");
  for (const std::string data : {"ascii", "binary", "binary_compressed"}) {
    const std::string path = folder.write(data + ".pcd", test::pcd(kPoints, data));
    EXPECT_TRUE(is_point_cloud_file(path));
    const PointCloud cloud = read_point_cloud(path);
    expect_points(cloud, data);
    EXPECT_TRUE(cloud.left_out.empty()) << data << ": " << cloud.left_out.text();
  }
}

TEST(PointCloudFile, PcdWithOtherFieldsOrdersAndTypes) {
  const test::Folder folder("clouds fields");
  const std::string head =
      "VERSION .7\r\nFIELDS rgb z _ x normal y\nSIZE 4 8 1 2 4 8\nTYPE F F U I F F\n"
      "COUNT 1 1 3 1 3 1\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 1 0 0 1 0 0 0\nPOINTS 4\n";
  std::string body;
  const auto add = [&](double x, double y, double z) {
    body += test::bytes_of(0.0F) + test::bytes_of(z) + "___" +
            test::bytes_of(static_cast<std::int16_t>(x)) + std::string(12, 'n') + test::bytes_of(y);
  };
  add(1, 2, 3);
  add(-2, 0.25, 8);
  add(7, std::nan(""), 7);
  add(4, 5, -6);
  const PointCloud cloud =
      read_point_cloud(folder.write("a.pcd", head + "DATA binary\n" + body + "left over"));
  ASSERT_EQ(cloud.points.size(), 3u);
  EXPECT_EQ(cloud.points[1], Eigen::Vector3d(-2, 0.25, 8));
  const std::string told = cloud.left_out.text();
  for (const char* what : {"'rgb normal'", "its viewpoint", "1 points that are not finite"}) {
    EXPECT_NE(told.find(what), std::string::npos) << told;
  }
  const PointCloud text = read_point_cloud(
      folder.write("b.pcd",
                   "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 4\nHEIGHT 1\nDATA ascii\n"
                   "1 2 3 4.2e6\r\n-0.5 +.25 8 0\nnan nan NAN -nan(ind)\n4 5 -6 1.#QNAN"));
  expect_points(text, "text");
}

std::string ply(const std::string& format, const std::string& body) {
  return "ply\nformat " + format +
         " 1.0\ncomment of a scanner\nelement camera 1\nproperty float f\n"
         "element vertex 3\nproperty uchar red\nproperty float x\nproperty double y\n"
         "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
         "element edge 1\nproperty int a\nend_header\n" +
         body;
}

TEST(PointCloudFile, PlyInAllThreeForms) {
  const test::Folder folder("clouds ply");
  const auto packed = [](bool big_endian) {
    const auto number = [&](auto value) {
      std::string bytes = test::bytes_of(value);
      if (big_endian) std::reverse(bytes.begin(), bytes.end());
      return bytes;
    };
    std::string body = number(1.5F);
    for (const Eigen::Vector3d& p : kPoints) {
      body += 'r' + number(static_cast<float>(p.x())) + number(p.y()) +
              number(static_cast<float>(p.z()));
    }
    return body + number(7);
  };
  const std::string text = "1.5\n9 1 2 3\n9 -0.5 0.25 8\n9 4 5 -6\n7\n";
  for (const std::string& path : {folder.write("a.ply", ply("ascii", text)),
                                  folder.write("b.ply", ply("binary_little_endian", packed(false))),
                                  folder.write("c.PLY", ply("binary_big_endian", packed(true)))}) {
    EXPECT_TRUE(is_point_cloud_file(path));
    const PointCloud cloud = read_point_cloud(path);
    expect_points(cloud, path);
    const std::string told = cloud.left_out.text();
    for (const char* what : {"'camera'", "'red'", "'edge'"}) {
      EXPECT_NE(told.find(what), std::string::npos) << told;
    }
  }
}

TEST(PointCloudFile, WhatIsNoCloudIsRefusedInOneLine) {
  const test::Folder folder("clouds refused");
  const std::string good = test::pcd(kPoints, "binary");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = good;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  const std::string compressed = test::pcd(kPoints, "binary_compressed");
  const std::string text = test::pcd(kPoints, "ascii");
  const struct {
    std::string content, says;
  } kRows[] = {
      {"", "is empty"},
      {"just text", "no DATA"},
      {std::string(2000000, 'x'), "no DATA"},
      {good.substr(0, good.size() - 1), "end early"},
      {with("DATA binary", "DATA zipped"), "expected ascii, binary"},
      {with("WIDTH 3", "WIDTH 4"), "do not agree"},
      {with("WIDTH 3", "WIDTH 99999999999999999999"), "the line"},
      {with("WIDTH 3\nHEIGHT 1", "WIDTH 2147483648\nHEIGHT 2147483648"), "do not agree"},
      {with("POINTS 3", "POINTS -3"), "the line"},
      {with("FIELDS x y z", "FIELDS x y w"), "0 fields z"},
      {with("FIELDS x y z", "FIELDS x x z"), "2 fields x"},
      {with("SIZE 4 4 4", "SIZE 4 4"), "the line"},
      {with("SIZE 4 4 4", "SIZE 4 4 3"), "the line"},
      {with("TYPE F F F", "TYPE F F X"), "the line"},
      {with("SIZE 4 4 4", "# 4 4 4"), "no SIZE"},
      {with("COUNT 1 1 1", "COUNT 1 1 2"), "several numbers of z"},
      {with("COUNT 1 1 1", "COUNT 1 1 99999999999"), "the line"},
      {compressed.substr(0, compressed.size() - 1), "end early"},
      {text.substr(0, text.size() - 12), "expected 3"},
      {text + "and more", ""},
      {test::pcd({{1, 2, 3}}, "ascii")
           .replace(test::pcd({{1, 2, 3}}, "ascii").rfind("1.0"), 3, "one"),
       "'one"},
      {test::pcd({Eigen::Vector3d::Constant(std::nan(""))}, "binary"), "no point that is finite"},
      {"\x1b[31m\n" + good, "the line"}};
  for (const auto& row : kRows) {
    const std::string path = folder.write("a.pcd", row.content);
    std::string said;
    try {
      read_point_cloud(path);
    } catch (const InputError& error) {
      said = error.what();
      EXPECT_EQ(error.lines().size(), 1u);
      EXPECT_EQ(said.find('\x1b'), std::string::npos);
      EXPECT_NE(said.find("expected"), std::string::npos) << said;
    }
    EXPECT_EQ(said.empty(), row.says.empty()) << row.says << said;
    EXPECT_NE(said.find(row.says), std::string::npos) << row.says << " in " << said;
  }
  for (const std::string& content :
       {ply("ascii", "1.5\n9 1 2 3\n9 -0.5 0.25\n"), ply("binary_little_endian", "short"),
        ply("ascii_", ""), std::string("ply\nformat ascii 1.0\nelement point 1\nend_header\n")}) {
    EXPECT_THROW(read_point_cloud(folder.write("b.ply", content)), InputError) << content;
  }
}

}  // namespace
}  // namespace prospect::point_cloud_file_test
