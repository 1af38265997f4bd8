// SPDX-License-Identifier: Apache-2.0
// Files that were cut, in which bits have flipped, or in which a value is another one: refused in
// one line, or read as what they say.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/problem_file/problem_file.h"
#include "tests/engine/problem_specifications.h"

namespace prospect::test::problem_file_damage_test {
namespace {

namespace fs = std::filesystem;

class ProblemFileDamageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = ::testing::TempDir() + "problem_file_damage_" + std::to_string(getpid());
    fs::remove_all(root_);
    fs::create_directories(root_);
    PlannerParameters p;
    p.N = 6;
    p.M = 3;
    p.committed = 0.5;
    p.visibility.r_max = 1.5;
    p.max_targets = 20;
    const NamedSpecification named = specification_of("damaged", "unicycle", p, 60);
    write_problem(path("whole.h5"), {{}, *named.specification, named.seeds, std::nullopt});
    whole_ = content(path("whole.h5"));
  }
  void TearDown() override { fs::remove_all(root_); }
  std::string path(const std::string& name) const { return root_ + "/" + name; }
  static std::string content(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }

  /// What reading says, which must be one line; empty if it makes a problem, which must be usable.
  static std::string refusal(const std::string& file, SavedProblem* saved = nullptr) {
    try {
      const ReadProblem read = read_problem(file);
      const Problem& problem = *read.problem;
      Workspace workspace = problem.make_workspace();
      Evaluation e;
      const Eigen::VectorXd z = 0.5 * (problem.lower() + problem.upper());
      problem.evaluate(z, Evaluate::kGradient, workspace, e);
      if (e.valid[0] != 0) {
        EXPECT_TRUE(std::isfinite(e.cost[0]));
        EXPECT_TRUE(e.gradient.allFinite() && e.constraints.allFinite() && e.jacobian.allFinite());
      }
      if (saved != nullptr) *saved = read.saved;
      return "";
    } catch (const std::invalid_argument& error) {
      std::string message = error.what();
      EXPECT_EQ(message.rfind(file + ": ", 0), 0u) << message;
      EXPECT_NE(message.find("; expected "), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_LT(message.size(), file.size() + 300) << message;
      return message;
    }
  }

  /// True if the bytes are refused, as they should be; false if they are the whole problem.
  bool refused(const std::string& bytes) const {
    const std::string file = path("damaged.h5");
    fs::remove(file);  // a file system may wait for the disk where one is written over
    std::ofstream(file, std::ios::binary) << bytes;
    SavedProblem saved;
    if (!refusal(file, &saved).empty()) return true;
    // Same bits, whatever was damaged: written again it is the undamaged file.
    write_problem(path("again.h5"), saved);
    EXPECT_EQ(content(path("again.h5")), whole_);
    return false;
  }

  std::string root_;
  std::string whole_;
};

TEST_F(ProblemFileDamageTest, TruncatedAnywhere) {
  ASSERT_FALSE(refused(whole_));
  std::vector<std::size_t> lengths;
  for (std::size_t n = 0; n < 200; ++n) lengths.push_back(n);
  for (std::size_t n = 1; n < 60; ++n) lengths.push_back(whole_.size() - n);
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::size_t> anywhere(0, whole_.size() - 1);
  for (int n = 0; n < 500; ++n) lengths.push_back(anywhere(random));
  for (const std::size_t n : lengths) {
    SCOPED_TRACE(n);
    EXPECT_TRUE(refused(whole_.substr(0, n)));
  }
}

TEST_F(ProblemFileDamageTest, WithBytesAppendedOrRemovedOrZeroed) {
  std::mt19937_64 random(2);
  std::uniform_int_distribution<std::size_t> anywhere(0, whole_.size() - 1);
  refused(whole_ + "appended");
  refused(whole_ + whole_);
  for (int n = 0; n < 200; ++n) {
    const std::size_t at = anywhere(random), length = anywhere(random) % 600 + 1;
    SCOPED_TRACE(std::to_string(at) + " + " + std::to_string(length));
    std::string bytes = whole_;
    bytes.erase(at, length);
    refused(bytes);
    bytes = whole_;
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                std::min(length, bytes.size() - at), '\0');
    refused(bytes);
    bytes = whole_;
    for (std::size_t i = at; i < std::min(bytes.size(), at + length); ++i) {
      bytes[i] = static_cast<char>(random());
    }
    refused(bytes);
  }
}

// PROSPECT_EVERY_BYTE=1 flips a bit of every byte of the file.
TEST_F(ProblemFileDamageTest, WithBitsFlippedAnywhere) {
  std::vector<std::size_t> places;
  std::mt19937_64 random(3);
  if (std::getenv("PROSPECT_EVERY_BYTE") != nullptr) {
    for (std::size_t n = 0; n < whole_.size(); ++n) places.push_back(n);
  } else {
    for (std::size_t n = 0; n < 300; ++n) places.push_back(n);
    std::uniform_int_distribution<std::size_t> anywhere(0, whole_.size() - 1);
    for (int n = 0; n < 900; ++n) places.push_back(anywhere(random));
  }
  std::size_t noticed = 0;
  for (const std::size_t at : places) {
    std::string bytes = whole_;
    const auto bit = static_cast<unsigned>(random() % 8);
    bytes[at] = static_cast<char>(bytes[at] ^ (1u << bit));
    SCOPED_TRACE("byte " + std::to_string(at) + ", bit " + std::to_string(bit));
    noticed += refused(bytes);
  }
  RecordProperty("bytes", static_cast<int>(whole_.size()));
  RecordProperty("noticed", static_cast<int>(noticed));
  EXPECT_GT(noticed, places.size() * 9 / 10);
}

/// An attribute, or a dataset if it has no name.
struct Entry {
  std::string object, attribute;
};

std::vector<Entry> entries(const std::string& file) {
  std::vector<Entry> found;
  const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto visit = [](hid_t root, const char* name, const H5O_info_t* info,
                        void* data) -> herr_t {
    auto& all = *static_cast<std::vector<Entry>*>(data);
    if (info->type == H5O_TYPE_DATASET) all.push_back({name, ""});
    for (hsize_t i = 0; i < info->num_attrs; ++i) {
      const hid_t a =
          H5Aopen_by_idx(root, name, H5_INDEX_NAME, H5_ITER_INC, i, H5P_DEFAULT, H5P_DEFAULT);
      char attribute[256];
      H5Aget_name(a, sizeof attribute, attribute);
      all.push_back({name, attribute});
      H5Aclose(a);
    }
    return 0;
  };
  H5Ovisit2(f, H5_INDEX_NAME, H5_ITER_INC, visit, &found, H5O_INFO_ALL);
  H5Fclose(f);
  return found;
}

/// Puts another value into an entry, at a place drawn from `random`, and says which.
/// `choice` counts through the values; "" once there is no other.
std::string put(const std::string& file, const Entry& entry, std::size_t choice,
                std::mt19937_64& random) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double numbers[] = {0.0, -1.0, 1e-300, 1e6, 1e12, kInfinity, std::nan("")};
  const std::int64_t integers[] = {0, -1, 1000, std::numeric_limits<int>::max(),
                                   std::numeric_limits<std::int64_t>::min()};
  const std::uint8_t bytes[] = {0, 1, 2, 3, 255};
  const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t object = H5Oopen(f, entry.object.c_str(), H5P_DEFAULT);
  const bool is_dataset = entry.attribute.empty();
  const hid_t a = is_dataset ? object : H5Aopen(object, entry.attribute.c_str(), H5P_DEFAULT);
  const hid_t type = is_dataset ? H5Dget_type(a) : H5Aget_type(a);
  const hid_t space = is_dataset ? H5Dget_space(a) : H5Aget_space(a);
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  const std::size_t size = H5Tget_size(type);
  std::vector<char> data(size * count);
  std::string what;
  if (count > 0) {
    if (is_dataset) {
      H5Dread(a, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data());
    } else {
      H5Aread(a, type, data.data());
    }
    char* place = data.data() + size * (random() % count);
    const auto put_in = [&](const auto& values) {
      if (choice >= std::size(values)) return;
      std::memcpy(place, &values[choice], size);
      what = std::to_string(values[choice]);
    };
    switch (H5Tget_class(type)) {
      case H5T_FLOAT:
        put_in(numbers);
        break;
      case H5T_INTEGER:
        if (size == 1) {
          put_in(bytes);
        } else {
          put_in(integers);
        }
        break;
      default:
        if (choice >= 4) break;
        std::fill_n(place, size, choice == 0 ? '\0' : choice == 1 ? '\xff' : 'x');
        if (choice == 3) place[size / 2] = '\n';
        what = "text " + std::to_string(choice);
    }
    if (is_dataset) {
      H5Dwrite(a, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data());
    } else {
      H5Awrite(a, type, data.data());
    }
  }
  H5Sclose(space);
  H5Tclose(type);
  if (!is_dataset) H5Aclose(a);
  H5Oclose(object);
  H5Fclose(f);
  return what;
}

// Every entry holds values that it should not, one at a time, in a file that is sound otherwise.
TEST_F(ProblemFileDamageTest, WithAnotherValueInAnyEntry) {
  const std::string file = path("value.h5");
  std::mt19937_64 random(4);
  int refusals = 0, problems = 0;
  for (const Entry& entry : entries(path("whole.h5"))) {
    for (std::size_t choice = 0;; ++choice) {
      fs::remove(file);
      fs::copy_file(path("whole.h5"), file);
      const std::string value = put(file, entry, choice, random);
      if (value.empty()) break;
      SCOPED_TRACE(entry.object + " " + entry.attribute + " = " + value);
      if (refusal(file).empty()) {
        ++problems;
      } else {
        ++refusals;
      }
    }
  }
  EXPECT_GT(refusals, 200);
  EXPECT_GT(problems, 200);
}

}  // namespace
}  // namespace prospect::test::problem_file_damage_test
