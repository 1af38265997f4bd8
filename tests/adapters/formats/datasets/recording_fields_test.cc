// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/recording_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/files/input_error.h"
#include "tests/adapters/formats/field_outcomes.h"

namespace prospect::recording_fields_test {
namespace {

namespace fs = std::filesystem;

class RecordingFields : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("prospect recording " + std::to_string(::getpid()));
    for (const char* camera : {"cam0", "cam1"}) {
      fs::create_directories(folder_ / "mav0" / camera / "data");
      write(std::string("mav0/") + camera + "/sensor.yaml", sensor("", ""));
      for (int k = 0; k < 5; ++k) {  // numbered: their times come from the rate
        std::ofstream(folder_ / "mav0" / camera / "data" / (std::to_string(k) + ".png"));
      }
    }
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }

  static std::string sensor(const std::string& key, const std::string& value) {
    const std::vector<std::pair<std::string, std::string>> keys = {
        {"sensor_type", "camera"},
        {"comment", "a test"},
        {"camera_id", "left"},
        {"rate_hz", "10"},
        {"resolution", "[400, 300]"},
        {"camera_model", "pinhole"},
        {"intrinsics", "[300, 300, 200, 150]"},
        {"distortion_model", "radial-tangential"},
        {"distortion_coefficients", "[0.01, 0, 0, 0]"},
        {"T_BS.cols", "4"},
        {"T_BS.rows", "4"},
        {"T_BS.data", "[0, 0, 1, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1]"}};
    std::string text = "%YAML:1.0\n";
    bool known = key.empty();
    for (const auto& [name, usual] : keys) {
      const bool inner = name.starts_with("T_BS.");
      if (name == "T_BS.cols") text += "T_BS:\n";
      text += (inner ? "  " + name.substr(5) : name) + ": " + (name == key ? value : usual) + "\n";
      known = known || name == key;
    }
    return known ? text : text + key + ": " + value + "\n";
  }

  static bool is_quaternion_x(const std::string& column) {
    return column.starts_with("q") && column.ends_with("x");
  }

  /// What is read of the folder.
  std::string outcome() const {
    const StereoSource source = open_stereo_source(folder_.string());
    notes_.clear();
    for (const std::string& note : source.notes) notes_ += note + "\n";
    std::ostringstream out;
    out.precision(15);
    for (const std::string& line : source.missing) out << line;
    if (!source.missing.empty()) return "refused: " + out.str();
    const CalibratedCamera& c = source.calibration->left;
    const PinholeCamera& p = c.pinhole;
    out << p.fx << ' ' << p.fy << ' ' << p.cx << ' ' << p.cy << ' ' << p.width << ' ' << p.height
        << ' ' << static_cast<int>(c.lens) << ' ';
    for (const double k : c.distortion) out << k << ' ';
    out << c.T_BC.matrix() << '\n';
    for (const double stamp : source.left.stamps) out << stamp << ' ';
    for (const TimedPose& pose : source.truth) out << pose.stamp << '\n' << pose.T.matrix() << '\n';
    return out.str();
  }
  /// Likewise with a table of two poses, the second with another value in a column.
  std::string with_column(RecordingFile file, const std::string& column, const std::string& value,
                          const std::string& apart) const {
    std::string second;
    for (const FieldRule& rule : fields_of(file)) {
      const std::string name = rule.name;
      const std::string usual = name == "timestamp"     ? "300000000"
                                : name.ends_with("w")   ? "0.8"
                                : is_quaternion_x(name) ? "0.6"
                                                        : "0";
      second += (second.empty() ? "" : apart) + (name == column ? value : usual);
    }
    const std::string first = "2" + second.substr(1);
    write(file == RecordingFile::kTumTrajectory ? "groundtruth_tum.txt"
                                                : "mav0/state_groundtruth_estimate0/data.csv",
          (second.starts_with("3") ? first : "200000000" + second.substr(second.find(apart))) +
              "\n" + second + "\n");
    return outcome();
  }
  /// For each column values that are not the usual ones.
  static std::map<std::string, std::vector<std::string>> other_values(RecordingFile file) {
    std::map<std::string, std::vector<std::string>> others;
    for (const FieldRule& rule : fields_of(file)) {
      const std::string name = rule.name;
      others[name] = {name == "timestamp"     ? "400000000"
                      : name.ends_with("w")   ? "-0.8"
                      : is_quaternion_x(name) ? "-0.6"
                      : name.starts_with("q") ? "0.1"
                                              : "1.5"};
    }
    return others;
  }

  fs::path folder_;
  mutable std::string notes_;
};

TEST_F(RecordingFields, EachKeyOfASensorIsWhatTheTableSays) {
  test::expect_fields(fields_of(RecordingFile::kEurocSensor),
                      {{"sensor_type", {"imu"}},
                       {"comment", {"another"}},
                       {"camera_id", {"right"}},
                       {"rate_hz", {"20"}},
                       {"camera_model", {"omni"}},
                       {"distortion_model", {"equidistant"}},
                       {"resolution", {"[401, 300]", "[400, 301]"}},
                       {"intrinsics", {"[301, 300, 200, 150]", "[300, 300, 200, 151]"}},
                       {"distortion_coefficients", {"[0.02, 0, 0, 0]", "[0.01, 0, 0, 0.001]"}},
                       {"T_BS.cols", {"3"}},
                       {"T_BS.rows", {"3"}},
                       {"T_BS.data", {"[0, 0, 1, 0.5, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1]"}}},
                      [this](const auto& key, const auto& value) {
                        write("mav0/cam0/sensor.yaml", sensor(key, value));
                        return outcome();
                      });
}

TEST_F(RecordingFields, NamesAllThatIsReadOfASensorAndWhatIsNotIsTold) {
  std::set<std::string> listed, asked;
  for (const FieldRule& rule : fields_of(RecordingFile::kEurocSensor)) listed.insert(rule.name);
  const char* const reader = "adapters/formats/datasets/layout_euroc.cc";
  for (const std::string& key : test::keys_asked_for(reader, R"(root\.\w+\(\s*"(\w+)\")")) {
    if (key != "T_BS") asked.insert(key);
  }
  for (const std::string& key : test::keys_asked_for(reader, R"(\bT\.\w+\(\s*"(\w+)\")")) {
    asked.insert("T_BS." + key);
  }
  EXPECT_EQ(asked, listed);
  const std::string before = outcome();
  write("mav0/cam0/sensor.yaml", sensor("gain", "3"));
  EXPECT_EQ(outcome(), before);
  EXPECT_THAT(notes_, ::testing::HasSubstr("passed over: gain"));
}

TEST_F(RecordingFields, EachColumnOfAGroundTruthIsWhatTheTableSays) {
  for (const auto& [file, apart] : {std::pair{RecordingFile::kEurocTruth, ","},
                                    std::pair{RecordingFile::kTumTrajectory, " "}}) {
    SCOPED_TRACE(apart);
    test::expect_fields(fields_of(file), other_values(file),
                        [&, kind = file, comma = apart](const auto& column, const auto& value) {
                          return with_column(kind, column, value, comma);
                        });
  }
}

}  // namespace
}  // namespace prospect::recording_fields_test
