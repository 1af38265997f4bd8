// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/image_stream.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

constexpr std::array<StampUnit, 4> kStampUnits = {StampUnit{1.0, "s"}, StampUnit{1e-3, "ms"},
                                                  StampUnit{1e-6, "us"}, StampUnit{1e-9, "ns"}};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

struct NameNumber {
  std::string prefix, suffix;
  std::int64_t number = 0;
  bool decimal = false;
};

/// The last number in a name without its extension; none if there is none, or one too long.
std::optional<NameNumber> number_of(const std::string& name) {
  const std::string stem = name.substr(0, name.find_last_of("0123456789") + 1);
  std::size_t begin = stem.size();
  while (begin > 0 && is_digit(stem[begin - 1])) --begin;
  std::string digits = stem.substr(begin);
  std::string fraction;
  NameNumber out;
  out.suffix = name.substr(stem.size());
  if (begin > 1 && stem[begin - 1] == '.' && is_digit(stem[begin - 2])) {
    out.decimal = true;
    fraction = digits;
    std::size_t whole = begin - 1;
    while (whole > 0 && is_digit(stem[whole - 1])) --whole;
    digits = stem.substr(whole, begin - 1 - whole);
    begin = whole;
    fraction.resize(9, '0');
  }
  digits += fraction;
  if (digits.empty() || digits.size() > 19) return std::nullopt;
  out.prefix = stem.substr(0, begin);
  for (const char c : digits) {
    if (out.number > (std::numeric_limits<std::int64_t>::max() - (c - '0')) / 10) {
      return std::nullopt;
    }
    out.number = 10 * out.number + (c - '0');
  }
  return out;
}

std::int64_t median_of_steps(const std::vector<std::int64_t>& numbers) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < numbers.size(); ++i) steps.push_back(numbers[i] - numbers[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

RawImage first_readable(const ImageStream& images) {
  RawImage image;
  Elements all("images");
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (all.read([&] { image = images.read(i); })) return image;
  }
  std::vector<std::string> notes;
  all.finish(notes);
  throw InputError(images.name + ": holds no image; expected those of a camera");
}

NumberedImages numbered_images(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw InputError(folder + ": no such folder; expected one with numbered images");
  }
  NumberedImages out;
  std::string prefix, suffix;
  bool first = true;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (is_image_name(name) && entry.is_regular_file(error)) names.push_back(name);
  }
  if (names.empty()) {
    throw InputError(folder + ": holds no image; expected NUMBER.png, .jpg or the like");
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    const std::string path = folder + "/" + name;
    const auto number = number_of(name.substr(0, name.rfind('.')));
    if (!number) throw InputError(path + ": the name is no number; expected NUMBER or a stamp");
    if (first) {
      prefix = number->prefix;
      suffix = number->suffix;
      out.decimal = number->decimal;
    } else if (number->prefix != prefix || number->suffix != suffix ||
               number->decimal != out.decimal) {
      throw InputError(path + ": is named otherwise than " + names[0] +
                       "; expected names that differ in their number only");
    }
    first = false;
    out.images.push_back({number->number, path});
  }
  std::sort(out.images.begin(), out.images.end(),
            [](const NumberedImage& a, const NumberedImage& b) { return a.number < b.number; });
  for (std::size_t i = 1; i < out.images.size(); ++i) {
    if (out.images[i].number == out.images[i - 1].number) {
      throw InputError(out.images[i].path + ": has the number of " + out.images[i - 1].path +
                       "; expected each once");
    }
  }
  return out;
}

std::vector<std::size_t> lines_of_images(const std::vector<std::int64_t>& numbers,
                                         std::size_t lines, const std::string& file,
                                         std::vector<std::string>& notes) {
  std::vector<std::size_t> out;
  const std::size_t images = numbers.size();
  if (images == 0) return out;
  const auto count = static_cast<std::int64_t>(lines);
  const std::int64_t first = numbers.front(), last = numbers.back();
  const bool in_order = lines == images, from_zero = last < count;
  if (!in_order && !from_zero && last - first >= count) {
    throw InputError(file + ": holds " + std::to_string(lines) + " lines for " +
                     std::to_string(images) + " images, numbered " + std::to_string(first) +
                     " to " + std::to_string(last) +
                     "; expected a line for each of them, or for each number from 0 or " +
                     std::to_string(first) + " on");
  }
  for (std::size_t i = 0; i < images; ++i) {
    out.push_back(in_order ? i
                           : static_cast<std::size_t>(from_zero ? numbers[i] : numbers[i] - first));
  }
  if (out.back() != static_cast<std::size_t>(last)) {
    const std::string note = file + ": its first line is of image " + std::to_string(first) +
                             (in_order ? ", a line for each image in order" : "");
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }
  return out;
}

ImageStream image_files(const std::string& name, std::vector<double> stamps,
                        std::vector<std::string> paths) {
  ImageStream stream;
  stream.name = name;
  stream.stamps = std::move(stamps);
  stream.names = std::move(paths);
  stream.read = [files = stream.names](std::size_t i) { return read_image_file(files.at(i)); };
  return stream;
}

bool counts_frames(const std::vector<std::int64_t>& numbers) {
  constexpr std::int64_t kLargest = 100'000'000, kStep = 10;
  if (numbers.empty() || numbers[0] >= kLargest) return false;
  return numbers.size() == 1 || median_of_steps(numbers) <= kStep;
}

std::optional<StampUnit> stamp_unit(const std::vector<std::int64_t>& stamps, double rate) {
  constexpr double kLeast = 0.2, kMost = 200.0;        // [Hz]
  constexpr double kFirstDate = 1e9, kLastDate = 3e9;  // [s]
  if (stamps.size() > 1) {
    const auto step = static_cast<double>(median_of_steps(stamps));
    if (step > 0.0) {
      std::optional<StampUnit> best;
      double best_off = std::log(10.0);
      for (const StampUnit& unit : kStampUnits) {
        const double hz = 1.0 / (step * unit.seconds);
        if (rate > 0.0) {
          const double off = std::abs(std::log(hz / rate));
          if (off < best_off) {
            best_off = off;
            best = unit;
          }
        } else if (hz >= kLeast && hz < kMost) {
          return unit;
        }
      }
      if (best) return best;
    }
  }
  for (const StampUnit& unit : kStampUnits) {
    if (stamps.empty()) break;
    const double date = static_cast<double>(stamps[0]) * unit.seconds;
    if (date >= kFirstDate && date <= kLastDate) return unit;
  }
  return std::nullopt;
}

std::optional<StampUnit> unit_instead_of_seconds(const std::vector<double>& stamps) {
  if (!(median_step(stamps) > 5.0)) return std::nullopt;  // as in stamp_unit()
  std::vector<std::int64_t> whole;
  for (const double stamp : stamps) {
    if (!(std::abs(stamp) < 9e18)) return std::nullopt;
    whole.push_back(static_cast<std::int64_t>(std::llround(stamp)));
  }
  const auto unit = stamp_unit(whole);
  return unit && unit->seconds != 1.0 ? unit : std::nullopt;
}

double median_step(const std::vector<double>& stamps) {
  if (stamps.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace prospect
