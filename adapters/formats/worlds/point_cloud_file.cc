// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/point_cloud_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

#include "adapters/formats/files/extension.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/formats/worlds/lzf.h"
#include "adapters/formats/worlds/ply_header.h"
#include "models/lower_case.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

/// A number as a file stores it.
struct StoredNumber {
  std::size_t size = 0;  ///< [bytes]: 1, 2, 4, 8
  bool is_float = false, is_signed = false;
};

/// Where the coordinates of points are among the bytes or words of each.
struct PointLayout {
  std::uint64_t points = 0;
  std::size_t stride = 0;                ///< of a point, in bytes, or in words if it is text
  std::array<std::size_t, 3> offset{};   ///< of x, y, z, likewise
  std::array<StoredNumber, 3> number{};  ///< of x, y, z
  bool by_field = false;                 ///< all x come first, then all y, ...
  bool big_endian = false;
};

template <typename T>
double as_number(const char* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double number_at(const char* bytes, const StoredNumber& type, bool big_endian) {
  static_assert(std::endian::native == std::endian::little);
  std::array<char, 8> turned{};
  if (big_endian) {
    std::reverse_copy(bytes, bytes + type.size, turned.begin());
    bytes = turned.data();
  }
  switch (type.size) {
    case 8:
      return type.is_float    ? as_number<double>(bytes)
             : type.is_signed ? as_number<std::int64_t>(bytes)
                              : as_number<std::uint64_t>(bytes);
    case 4:
      return type.is_float    ? as_number<float>(bytes)
             : type.is_signed ? as_number<std::int32_t>(bytes)
                              : as_number<std::uint32_t>(bytes);
    case 2:
      return type.is_signed ? as_number<std::int16_t>(bytes) : as_number<std::uint16_t>(bytes);
    default:
      return type.is_signed ? as_number<std::int8_t>(bytes) : as_number<std::uint8_t>(bytes);
  }
}

void add_point(const Eigen::Vector3d& point, PointCloud& cloud, std::size_t& without_place) {
  if (point.allFinite()) {
    cloud.points.push_back(point);
  } else {
    ++without_place;
  }
}

void tell_without_place(std::size_t count, PointCloud& cloud) {
  if (count > 0) cloud.left_out.name(std::to_string(count) + " points that are not finite");
}

/// Of data that hold all points.
void take_binary(std::string_view data, const PointLayout& layout, PointCloud& cloud) {
  std::size_t without_place = 0;
  cloud.points.reserve(static_cast<std::size_t>(layout.points));
  for (std::size_t n = 0; n < layout.points; ++n) {
    Eigen::Vector3d point;
    for (std::size_t k = 0; k < 3; ++k) {
      const StoredNumber& type = layout.number[k];
      const std::size_t at =
          layout.by_field
              ? layout.offset[k] * static_cast<std::size_t>(layout.points) + n * type.size
              : n * layout.stride + layout.offset[k];
      point[static_cast<Eigen::Index>(k)] = number_at(data.data() + at, type, layout.big_endian);
    }
    add_point(point, cloud, without_place);
  }
  tell_without_place(without_place, cloud);
}

/// A number of a text, also "nan" and "inf" in any spelling; none if it is no number.
std::optional<double> number_in(std::string_view word) {
  double value = 0.0;
  if (word.starts_with('+')) word.remove_prefix(1);
  if (parse_number(word, value)) return value;
  // "-nan(ind)", "1.#QNAN", "1e999"
  const std::string small = lower_case(std::string(word));
  const bool none = small.find("nan") != std::string::npos ||
                    small.find("inf") != std::string::npos || small.find('#') != std::string::npos;
  return none ? std::optional(std::numeric_limits<double>::quiet_NaN()) : std::nullopt;
}

/// The text of `data`, word by word.
class Words {
 public:
  explicit Words(std::string_view data) : data_(data) {}
  /// Empty at the end.
  std::string_view next() {
    constexpr const char* kBlanks = " \t\r\n\v\f";
    const std::size_t begin = std::min(data_.find_first_not_of(kBlanks), data_.size());
    data_.remove_prefix(begin);
    const std::string_view word = data_.substr(0, data_.find_first_of(kBlanks));
    data_.remove_prefix(word.size());
    return word;
  }
  std::string_view rest() const { return data_; }

 private:
  std::string_view data_;
};

/// A line of text a point, each with as many words as fields.
void take_text(std::string_view data, const PointLayout& layout, const std::string& path,
               PointCloud& cloud) {
  std::size_t without_place = 0;
  Words words(data);
  for (std::uint64_t n = 0; n < layout.points; ++n) {
    Eigen::Vector3d point;
    for (std::size_t k = 0; k < layout.stride; ++k) {
      const std::string_view word = words.next();
      if (word.empty()) {
        fail(path, std::to_string(n) + " points; expected " + std::to_string(layout.points) +
                       " as its header says (truncated)");
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (layout.offset[axis] != k) continue;
        const std::optional<double> value = number_in(word);
        if (!value) {
          fail(path, "point " + std::to_string(n) + " has " + in_quotes(std::string(word)) +
                         "; expected a number");
        }
        point[static_cast<Eigen::Index>(axis)] = *value;
      }
    }
    add_point(point, cloud, without_place);
  }
  tell_without_place(without_place, cloud);
}

/// Of a file's fields; the layout's offsets and numbers of x, y, z are filled in. count: numbers of
/// a field.
struct Field {
  std::string name;
  StoredNumber number;
  std::size_t count = 1;
};

void lay_out(const std::vector<Field>& fields, bool text, const std::string& path,
             PointLayout& layout, LeftOut& left_out) {
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  std::array<int, 3> found{};
  std::string others;
  for (const Field& field : fields) {
    bool used = false;
    for (std::size_t k = 0; k < 3; ++k) {
      if (lower_case(field.name) != kNames[k]) continue;
      used = true;
      ++found[k];
      if (field.count != 1) fail(path, "several numbers of " + field.name + "; expected one");
      layout.offset[k] = layout.stride;
      layout.number[k] = field.number;
    }
    // "_" is room that is left between fields.
    if (!used && field.name != "_") others += (others.empty() ? "" : " ") + field.name;
    layout.stride += (text ? 1 : field.number.size) * field.count;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (found[k] == 1) continue;
    fail(path, std::to_string(found[k]) + " fields " + kNames[k] +
                   "; expected a cloud of points with one each of x, y and z");
  }
  if (!others.empty()) left_out.name("the points' fields " + in_quotes(others));
}

struct PcdHeader {
  std::vector<Field> fields;
  std::optional<std::uint64_t> width, height, points;
  std::string data;
  std::size_t end = 0;  ///< where the data begin
  bool viewpoint = false;
};

/// Sets what a line of a header says of each field.
void set_of_fields(const std::vector<std::string>& words, PcdHeader& header,
                   const std::function<void()>& wrong) {
  if (words.size() != header.fields.size() + 1) wrong();
  for (std::size_t n = 0; n < header.fields.size(); ++n) {
    Field& field = header.fields[n];
    const std::string& word = words[n + 1];
    if (words[0] == "TYPE") {
      if (word != "F" && word != "I" && word != "U") wrong();
      field.number.is_float = word == "F";
      field.number.is_signed = word == "I";
      continue;
    }
    constexpr std::size_t kMost = 1 << 20;  // numbers of a field
    std::size_t& value = words[0] == "SIZE" ? field.number.size : field.count;
    if (!parse_number(word, value) || value < 1 || value > kMost) wrong();
    const std::size_t size = field.number.size;
    if (size != 0 && size != 1 && size != 2 && size != 4 && size != 8) wrong();
  }
}

PcdHeader pcd_header(std::string_view bytes, const std::string& path) {
  constexpr std::size_t kLongest = 1 << 20;
  PcdHeader header;
  for (int number = 1; header.data.empty(); ++number) {
    const std::size_t end = bytes.substr(0, kLongest).find('\n', header.end);
    if (end == std::string_view::npos) {
      fail(path, "no DATA in its header; expected a PCD: FIELDS, SIZE, TYPE, WIDTH, HEIGHT, DATA");
    }
    const std::string line(bytes.substr(header.end, end - header.end));
    header.end = end + 1;
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    if (words.empty() || words[0].starts_with('#')) continue;
    const std::function<void()> wrong = [&] {
      fail(path + ":" + std::to_string(number),
           "the line " + in_quotes(line) + "; expected a header of PCD");
    };
    const std::string& key = words[0];
    const auto whole = [&](std::optional<std::uint64_t>& value) {
      std::uint64_t said = 0;
      if (words.size() != 2 || !parse_number(words[1], said)) wrong();
      value = said;
    };
    if (key == "VERSION") {
      continue;
    } else if (key == "FIELDS" || key == "COLUMNS") {
      header.fields.clear();
      for (std::size_t n = 1; n < words.size(); ++n) header.fields.push_back({words[n], {}, 1});
    } else if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
      set_of_fields(words, header, wrong);
    } else if (key == "WIDTH") {
      whole(header.width);
    } else if (key == "HEIGHT") {
      whole(header.height);
    } else if (key == "POINTS") {
      whole(header.points);
    } else if (key == "VIEWPOINT") {
      constexpr std::array kOrigin = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};
      if (words.size() != kOrigin.size() + 1) wrong();
      for (std::size_t n = 0; n < kOrigin.size(); ++n) {
        const std::optional<double> value = number_in(words[n + 1]);
        if (!value) wrong();
        header.viewpoint = header.viewpoint || *value != kOrigin[n];
      }
    } else if (key == "DATA") {
      if (words.size() != 2) wrong();
      header.data = words[1];
    } else {
      wrong();
    }
  }
  return header;
}

/// How many points a header says that there are.
std::uint64_t points_of(const PcdHeader& header, const std::string& path) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 31;
  const std::uint64_t width = header.width.value_or(0), height = header.height.value_or(1);
  const bool sound = width <= kMost && height <= kMost;
  const std::uint64_t points =
      header.width && sound ? width * height : header.points.value_or(kMost + 1);
  if (!sound || points > kMost || header.points.value_or(points) != points) {
    fail(path, "WIDTH, HEIGHT and POINTS do not agree; expected WIDTH times HEIGHT points");
  }
  return points;
}

PointCloud read_pcd(const std::string& bytes, const std::string& path) {
  const PcdHeader header = pcd_header(bytes, path);
  const bool text = header.data == "ascii", compressed = header.data == "binary_compressed";
  if (!text && !compressed && header.data != "binary") {
    fail(path, "DATA " + in_quotes(header.data) + "; expected ascii, binary or binary_compressed");
  }
  PointCloud cloud;
  PointLayout layout;
  layout.points = points_of(header, path);
  for (const Field& field : header.fields) {
    const StoredNumber& number = field.number;
    if (number.size == 0 || (number.is_float && number.size < 4)) {
      fail(path, "no SIZE and TYPE of " + in_quotes(field.name) +
                     "; expected 1, 2, 4 or 8 bytes of F (4 or 8), I or U");
    }
  }
  lay_out(header.fields, text, path, layout, cloud.left_out);
  layout.by_field = compressed;
  if (header.viewpoint) cloud.left_out.name("its viewpoint");
  std::string_view data = std::string_view(bytes).substr(header.end);
  if (text) {
    take_text(data, layout, path, cloud);
    return cloud;
  }
  const std::uint64_t wanted = layout.points * layout.stride;
  std::string decompressed;
  if (compressed) {
    constexpr std::size_t kSizes = 8;
    std::array<std::uint32_t, 2> sizes{};
    if (data.size() >= kSizes) std::memcpy(sizes.data(), data.data(), kSizes);
    data.remove_prefix(std::min(kSizes, data.size()));
    if (sizes[0] <= data.size() && sizes[1] == wanted) {
      decompressed = lzf_decompressed(data.substr(0, sizes[0]), sizes[1]);
    }
    data = decompressed;
  }
  if (data.size() < wanted || (wanted == 0 && layout.points > 0)) {
    fail(path, "its data end early; expected " + std::to_string(layout.points) + " points of " +
                   std::to_string(layout.stride) +
                   " bytes as its header says (truncated or corrupt)");
  }
  take_binary(data, layout, cloud);
  return cloud;
}

/// A PLY's properties as fields; lists are no numbers of a point.
std::vector<Field> fields_of(const PlyElement& element, const std::string& path) {
  std::vector<Field> fields;
  for (const PlyProperty& property : element.properties) {
    if (property.length_size > 0) {
      fail(path, "a list " + in_quotes(property.name) + " of each " + in_quotes(element.name) +
                     "; expected numbers there in a cloud of points");
    }
    fields.push_back({property.name, {property.size, property.is_float, property.is_signed}, 1});
  }
  return fields;
}

PointCloud read_ply(const std::string& bytes, const std::string& path) {
  const PlyHeader header = ply_header(bytes, path);
  PointCloud cloud;
  const bool text = header.format == "ascii";
  std::string_view data = std::string_view(bytes).substr(header.end);
  bool found = false;
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex" || found) {
      if (element.count == 0) continue;
      cloud.left_out.name(std::to_string(element.count) + " elements " + in_quotes(element.name));
      if (found) continue;
      std::size_t stride = 0;
      for (const Field& field : fields_of(element, path)) stride += text ? 1 : field.number.size;
      if (stride > 0 && element.count > data.size() / stride) {
        fail(path, "ends within its elements " + in_quotes(element.name) +
                       "; expected as many as its header says (truncated)");
      }
      const std::size_t passed = stride * static_cast<std::size_t>(element.count);
      if (text) {
        Words words(data);
        for (std::size_t n = 0; n < passed; ++n) words.next();
        data = words.rest();
      } else {
        data.remove_prefix(passed);
      }
      continue;
    }
    found = true;
    PointLayout layout;
    layout.points = element.count;
    layout.big_endian = header.format == "binary_big_endian";
    lay_out(fields_of(element, path), text, path, layout, cloud.left_out);
    if (text) {
      take_text(data, layout, path, cloud);
      continue;
    }
    if (layout.points > data.size() / layout.stride) {
      fail(path, "ends within its points; expected " + std::to_string(layout.points) + " of " +
                     std::to_string(layout.stride) + " bytes as its header says (truncated)");
    }
    take_binary(data, layout, cloud);
  }
  if (!found) fail(path, "no element vertex; expected a cloud of points");
  return cloud;
}

}  // namespace

bool is_point_cloud_file(const std::string& path) {
  const std::string extension = lower_case_extension(path);
  if (extension != ".ply") return extension == ".pcd";
  try {
    return !read_ply_header(path).has_surfaces();
  } catch (const InputError&) {
    return false;
  }
}

PointCloud read_point_cloud(const std::string& path, const LoadProgress& progress) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{512} << 20;
  std::error_code error;
  if (!fs::exists(path, error)) fail(path, "no such file; expected a cloud of points");
  if (!fs::is_regular_file(path, error)) fail(path, "is not a file; expected a cloud of points");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size == 0) fail(path, "is empty; expected a cloud of points");
  if (size > kLargest) fail(path, "is larger than 512 MB; expected a smaller cloud");
  if (progress) progress("reading " + path);
  std::ifstream in(path, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!in) fail(path, "cannot be read; expected a readable file");
  return parse_point_cloud(bytes, path);
}

PointCloud parse_point_cloud(const std::string& bytes, const std::string& source) {
  PointCloud cloud =
      lower_case_extension(source) == ".ply" ? read_ply(bytes, source) : read_pcd(bytes, source);
  if (cloud.points.empty()) fail(source, "has no point that is finite; expected a cloud of points");
  return cloud;
}

}  // namespace prospect
