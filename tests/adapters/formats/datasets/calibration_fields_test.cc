// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/calibration_fields.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/datasets/stereo_calibration.h"
#include "adapters/formats/files/input_error.h"

namespace prospect::calibration_fields_test {
namespace {

namespace fs = std::filesystem;

/// Files of one calibration, as their programs write them with all that they know.
struct Specimen {
  CalibrationForm form;
  std::vector<std::string> names, texts;
};

std::string matrix(const std::string& key, int rows, int cols, const std::string& data) {
  return key + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(cols) +
         "\n  data: [" + data + "]\n";
}
/// Without a window its size is that of the sensor.
std::string camera_info(const std::string& name, const std::string& tx, bool window) {
  return "image_width: 640\nimage_height: 480\ncamera_name: " + name + "\n" +
         matrix("camera_matrix", 3, 3, "400, 0, 320, 0, 400, 240, 0, 0, 1") +
         "distortion_model: plumb_bob\n" +
         matrix("distortion_coefficients", 1, 5, "0.01, 0, 0, 0, 0") +
         matrix("rectification_matrix", 3, 3, "1, 0, 0, 0, 1, 0, 0, 0, 1") +
         matrix("projection_matrix", 3, 4, "400, 0, 320, " + tx + ", 0, 400, 240, 0, 0, 0, 1, 0") +
         (window ? "binning_x: 1\nbinning_y: 1\nroi:\n  x_offset: 10\n  y_offset: 10\n"
                   "  height: 440\n  width: 600\n  do_rectify: 0\n"
                 : "");
}
std::string opencv_matrix(const std::string& key, const std::string& data) {
  return key + ": [" + data + "]\n";
}
std::string zed_camera(const std::string& section) {
  return "[" + section + "]\nfx=700\nfy=700\ncx=640\ncy=360\nk1=0.1\nk2=0\np1=0\np2=0\nk3=0\n";
}
const char* const kEye = "1, 0, 0, 0, 1, 0, 0, 0, 1";

std::vector<Specimen> specimens() {
  std::vector<Specimen> all;
  all.push_back({CalibrationForm::kKitti,
                 {"calib.txt"},
                 {"P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP1: 700 0 600 -350 0 700 180 0 0 0 1 0\n"
                  "P2: 700 0 600 40 0 700 180 0 0 0 1 0\nP3: 700 0 600 -300 0 700 180 0 0 0 1 0\n"
                  "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n"}});
  std::string raw = "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.95e-02\n";
  for (const std::string n : {"_00", "_01"}) {
    const std::string tx = n == "_00" ? "0" : "-0.5";
    raw += "S" + n + ": 1392 512\nK" + n + ": 900 0 690 0 900 240 0 0 1\nD" + n +
           ": 0.1 0 0 0 0\nR" + n + ": 1 0 0 0 1 0 0 0 1\nT" + n + ": " + tx + " 0 0\nS_rect" + n +
           ": 1242 375\nR_rect" + n + ": 1 0 0 0 1 0 0 0 1\nP_rect" + n + ": 700 0 600 " +
           (n == "_00" ? "0" : "-350") + " 0 700 180 0 0 0 1 0\n";
  }
  all.push_back({CalibrationForm::kKittiRaw, {"calib_cam_to_cam.txt"}, {raw}});
  for (const bool window : {false, true}) {
    all.push_back({CalibrationForm::kCameraInfo,
                   {"left.yaml", "right.yaml"},
                   {camera_info("left", "0", window), camera_info("right", "-48", window)}});
  }
  std::string opencv =
      "%YAML:1.0\n---\ncalibration_time: now\nboard_width: 9\nboard_height: 6\n"
      "square_size: 0.03\nflags: 0\navg_reprojection_error: 0.2\nimage_width: 640\n"
      "image_height: 480\ndistortion_model: plumb_bob\n";
  for (const char* n : {"1", "2"}) {
    opencv += opencv_matrix(std::string("M") + n, "400, 0, 320, 0, 400, 240, 0, 0, 1") +
              opencv_matrix(std::string("D") + n, "0.01, 0, 0, 0");
  }
  opencv += opencv_matrix("R", kEye) + opencv_matrix("T", "-0.12, 0, 0");
  for (const char* key : {"E", "F", "R1", "R2"}) opencv += opencv_matrix(key, kEye);
  for (const char* key : {"P1", "P2"}) {
    opencv += opencv_matrix(key, "400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0");
  }
  opencv += opencv_matrix("Q", "1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0");
  all.push_back({CalibrationForm::kOpenCv, {"stereo.yaml"}, {opencv}});
  std::string kalibr;
  for (const char* n : {"cam0", "cam1"}) {
    kalibr += std::string(n) + ":\n";
    kalibr += "  T_cam_imu: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";
    if (std::string(n) == "cam1") {
      kalibr += "  T_cn_cnm1: [1, 0, 0, -0.12, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";
    }
    kalibr +=
        "  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: [0.01, 0, 0, 0]\n"
        "  distortion_model: radtan\n  intrinsics: [400, 400, 320, 240]\n"
        "  resolution: [640, 480]\n  rostopic: left\n  timeshift_cam_imu: 0.001\n";
  }
  all.push_back({CalibrationForm::kKalibr, {"camchain.yaml"}, {kalibr}});
  all.push_back({CalibrationForm::kZed,
                 {"SN1.conf"},
                 {zed_camera("LEFT_CAM_HD") + zed_camera("RIGHT_CAM_HD") +
                  "[STEREO]\nBaseline=120\nTY=0.1\nTZ=0.1\nCV_HD=0.001\nRX_HD=0.001\n"
                  "RZ_HD=0.001\n[MISC]\nSensor_ID=1\n"}});
  return all;
}

void add(std::ostream& out, const CalibratedCamera& c) {
  const PinholeCamera& p = c.pinhole;
  out << p.fx << ' ' << p.fy << ' ' << p.cx << ' ' << p.cy << ' ' << p.width << ' ' << p.height
      << ' ' << static_cast<int>(c.lens) << ' ';
  for (const double k : c.distortion) out << k << ' ';
  out << c.T_BC.matrix() << '\n';
}
void add(std::ostream& out, const StereoCalibration& c) {
  add(out, c.left);
  add(out, c.right);
  const PinholeCamera& p = c.camera.left;
  out << p.fx << ' ' << p.fy << ' ' << p.cx << ' ' << p.cy << ' ' << p.width << ' ' << p.height
      << ' ' << c.camera.baseline << '\n';
  for (const StereoCalibration& other : c.others) add(out, other);
}

/// "K_00: 1 2" of "K"; "T_cam_imu" stays. Empty: no key, or no value.
std::string key_of(const std::string& line) {
  static const std::regex entry(R"(^\s*([A-Za-z]\w*)\s*[:=]\s*\S.*$)");
  std::smatch match;
  if (!std::regex_match(line, match, entry)) return "";
  return match[1];
}
std::string without_number(const std::string& key) {
  static const std::regex number(R"((_HD|_0\d|\d)$)");
  return std::regex_replace(key, number, "");
}

constexpr int kWays = 4;
/// The line's value altered: one of its numbers, or its text.
std::string altered(const std::string& line, int way) {
  const std::size_t value = line.find_first_of(":=") + 1;
  static const std::regex number(R"(-?\d+(\.\d+)?)");
  const std::string rest = line.substr(value);
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (std::sregex_iterator it(rest.begin(), rest.end(), number), end; it != end; ++it) {
    places.emplace_back(it->position(), it->length());
  }
  if (places.empty()) return line + "_";
  const auto [at, size] = places[static_cast<std::size_t>(way) * places.size() / kWays];
  const double before = std::stod(rest.substr(at, size));
  std::ostringstream out;
  // A size by a pixel, an entry of a rotation so that it still is one.
  out << (before == 0.0 ? 0.0005 : std::abs(before) < 10.0 ? 1.0005 * before : before + 1.0);
  return line.substr(0, value) + rest.substr(0, at) + out.str() + rest.substr(at + size);
}

/// The row of a key: of itself, or of what stands before its number.
const FieldRule* rule_of(CalibrationForm form, const std::string& key) {
  for (const std::string& name : {key, without_number(key)}) {
    for (const FieldRule& rule : fields_of(form)) {
      if (name == rule.name) return &rule;
    }
  }
  return nullptr;
}

class CalibrationFields : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = (fs::temp_directory_path() / ("prospect calibration " + std::to_string(::getpid())))
                  .string();
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string outcome(const Specimen& specimen) const {
    std::string files;
    for (std::size_t i = 0; i < specimen.names.size(); ++i) {
      const std::string path = folder_ + "/" + specimen.names[i];
      std::ofstream(path) << specimen.texts[i];
      files += (i > 0 ? "," : "") + path;
    }
    std::ostringstream out;
    out.precision(12);
    try {
      add(out, read_stereo_calibration(files));
    } catch (const InputError& error) {
      return std::string("refused: ") + error.what();
    }
    return out.str();
  }

  std::string folder_;
};

TEST_F(CalibrationFields, EachKeyIsWhatTheTableSays) {
  // Of each form and key how often altering it made a difference, and was refused.
  std::map<CalibrationForm, std::map<std::string, std::pair<int, int>>> seen;
  for (const Specimen& specimen : specimens()) {
    const std::string before = outcome(specimen);
    ASSERT_FALSE(before.starts_with("refused")) << before;
    for (std::size_t i = 0; i < specimen.texts.size(); ++i) {
      std::vector<std::string> lines;
      std::istringstream text(specimen.texts[i]);
      for (std::string line; std::getline(text, line);) lines.push_back(line);
      for (std::size_t n = 0; n < lines.size(); ++n) {
        const std::string key = key_of(lines[n]);
        if (key.empty()) continue;
        const FieldRule* rule = rule_of(specimen.form, key);
        ASSERT_NE(rule, nullptr) << specimen.names[i] << ": " << key << " is in no table";
        for (int way = 0; way < kWays; ++way) {
          Specimen other = specimen;
          other.texts[i].clear();
          for (std::size_t k = 0; k < lines.size(); ++k) {
            other.texts[i] += (k == n ? altered(lines[k], way) : lines[k]) + "\n";
          }
          const std::string after = outcome(other);
          auto& [differed, refused] = seen[specimen.form][rule->name];
          refused += after.starts_with("refused");
          differed += !after.starts_with("refused") && after != before;
        }
      }
    }
  }
  for (const auto& [form, keys] : seen) {
    std::set<std::string> listed;
    for (const FieldRule& rule : fields_of(form)) {
      SCOPED_TRACE(rule.name);
      EXPECT_TRUE(listed.insert(rule.name).second) << "listed twice";
      EXPECT_EQ(std::strlen(rule.why) > 0, rule.use == FieldUse::kNotNeeded);
      ASSERT_TRUE(keys.contains(rule.name)) << "in no file";
      const auto [differed, refused] = keys.at(rule.name);
      if (rule.use == FieldUse::kNotNeeded) {
        EXPECT_EQ(differed + refused, 0);
      } else if (rule.use == FieldUse::kChecked) {
        EXPECT_EQ(differed, 0);
        EXPECT_GT(refused, 0);
      } else {
        EXPECT_GT(differed + refused, 0);
      }
    }
  }
  EXPECT_EQ(seen.size(), 6u);
}

}  // namespace
}  // namespace prospect::calibration_fields_test
