// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/ros_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "adapters/formats/files/extension.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/strict_yaml.h"
#include "adapters/formats/images/checked_png.h"
#include "adapters/formats/images/image_codec.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

constexpr int kUnknownOfMapSaver = 205;
constexpr std::int64_t kMostMapPixels = 100'000'000;
constexpr std::size_t kMostMapVoxels = 400'000'000;
constexpr std::uintmax_t kLargestMap = std::uintmax_t{512} << 20;

/// Pixels, row 0 at the top; a transparent pixel has the value kTransparent.
struct MapImage {
  static constexpr std::int16_t kTransparent = -1;
  int width = 0, height = 0;
  std::vector<std::int16_t> pixels;  ///< 0..255
};

/// Cell states, row 0 at the bottom.
struct Plan {
  int width = 0, height = 0;
  std::vector<CellState> cells;
};

std::string text_of(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::string read_bytes(const std::string& path, const std::string& kind) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status)) fail(path, "no such file; expected " + kind);
  if (!fs::is_regular_file(status)) {
    fail(path, std::string(fs::is_directory(status) ? "is a directory" : "is not a regular file") +
                   "; expected " + kind);
  }
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) fail(path, "cannot be read; expected " + kind);
  if (size == 0) fail(path, "empty file; expected " + kind);
  if (size > kLargestMap) {
    fail(path, std::to_string(size) + " bytes; expected at most " + std::to_string(kLargestMap));
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in) fail(path, "cannot be read; expected " + kind);
  return bytes;
}

void check_size(const std::string& path, std::int64_t width, std::int64_t height) {
  if (width < 1 || height < 1 || width > kMostMapPixels || height > kMostMapPixels / width) {
    fail(path, "an image of " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels; expected at least 1 x 1 and at most " +
                   std::to_string(kMostMapPixels) + " pixels");
  }
}

/// A PGM, PBM or PPM (P1 to P6), read here so that missing or surplus pixels are noticed.
MapImage read_pnm(const std::string& path, std::string_view bytes) {
  const int kind = bytes[1] - '0';
  const bool bits = kind == 1 || kind == 4, ascii = kind <= 3;
  const int channels = kind == 3 || kind == 6 ? 3 : 1;
  std::size_t at = 2;
  const auto skip_space = [&] {
    while (at < bytes.size()) {
      if (bytes[at] == '#') {
        while (at < bytes.size() && bytes[at] != '\n') ++at;
      } else if (std::isspace(static_cast<unsigned char>(bytes[at]))) {
        ++at;
      } else {
        break;
      }
    }
  };
  const auto next_number = [&](const char* expected) -> std::int64_t {
    skip_space();
    std::int64_t value = 0;
    const auto result = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), value);
    if (result.ec != std::errc() || value < 0) {
      fail(path, "corrupt PGM at byte " + std::to_string(at) + "; expected " + expected);
    }
    at = static_cast<std::size_t>(result.ptr - bytes.data());
    return value;
  };
  constexpr const char* kHeader = "width, height and largest value";
  const std::int64_t width = next_number(kHeader);
  const std::int64_t height = next_number(kHeader);
  const std::int64_t largest = bits ? 1 : next_number(kHeader);
  check_size(path, width, height);
  if (largest < 1 || largest > 65535) {
    fail(path, "PGM with largest value " + std::to_string(largest) + "; expected 1 to 65535");
  }
  const auto pixels = static_cast<std::size_t>(width * height);
  MapImage image{static_cast<int>(width), static_cast<int>(height), {}};
  const auto shade = [&](std::int64_t sum) {  // of all channels
    const std::int64_t full = largest * channels;
    const std::int64_t v = std::min<std::int64_t>(255, (sum * 255 + full / 2) / full);
    return static_cast<std::int16_t>(bits ? 255 - v : v);  // a set bit is black
  };
  if (ascii) {
    // A value takes a byte at least, and all but bits a space.
    const std::size_t values = pixels * static_cast<std::size_t>(channels);
    if ((bits ? values : 2 * values - 1) > bytes.size()) {
      fail(path, "truncated PGM; expected " + std::to_string(values) + " values");
    }
    image.pixels.reserve(pixels);
    for (std::size_t n = 0; n < pixels; ++n) {
      std::int64_t sum = 0;
      for (int c = 0; c < channels; ++c) {
        if (bits) {
          skip_space();
          if (at >= bytes.size() || (bytes[at] != '0' && bytes[at] != '1')) {
            fail(path, "corrupt PBM at byte " + std::to_string(at) + "; expected 0 or 1");
          }
          sum += bytes[at++] - '0';
        } else {
          const std::int64_t value = next_number("a value a pixel");
          if (value > largest) {
            fail(path, "the value " + std::to_string(value) + "; expected at most " +
                           std::to_string(largest));
          }
          sum += value;
        }
      }
      image.pixels.push_back(shade(sum));
    }
    skip_space();
    if (at < bytes.size()) {
      fail(path, std::to_string(bytes.size() - at) + " bytes follow the last pixel; expected none");
    }
    return image;
  }
  ++at;  // one white-space character ends the header, or two where an editor wrote lines
  if (at < bytes.size() && bytes[at - 1] == '\r' && bytes[at] == '\n') ++at;
  const std::size_t value_bytes = largest > 255 ? 2 : 1;
  const std::size_t row = bits ? static_cast<std::size_t>((width + 7) / 8)
                               : static_cast<std::size_t>(width * channels) * value_bytes;
  const std::size_t expected = row * static_cast<std::size_t>(height);
  std::size_t found = at < bytes.size() ? bytes.size() - at : 0;
  // Some programs end the file as a line of text.
  if (found == expected + 1 && bytes.back() == '\n') --found;
  if (found != expected) {
    fail(path, std::to_string(found) + " bytes of pixels; expected " + std::to_string(expected) +
                   " for " + std::to_string(width) + " x " + std::to_string(height));
  }
  const auto byte = [&](std::size_t n) {
    return static_cast<std::int64_t>(static_cast<unsigned char>(bytes[at + n]));
  };
  image.pixels.reserve(pixels);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
      std::int64_t sum = 0;
      if (bits) {
        sum = byte(y * row + x / 8) >> (7 - x % 8) & 1;
      } else {
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
          const std::size_t n =
              y * row + (x * static_cast<std::size_t>(channels) + c) * value_bytes;
          sum += value_bytes == 2 ? byte(n) << 8 | byte(n + 1) : byte(n);
        }
      }
      image.pixels.push_back(shade(sum));
    }
  }
  return image;
}

/// Throws unless a BMP has all the pixels that its header speaks of: the decoder would make up what
/// is missing.
void check_bmp(const std::string& path, std::string_view bytes) {
  constexpr std::size_t kHeader = 54;
  const auto number = [&](std::size_t at, int size) {
    std::uint32_t value = 0;
    for (int n = size; n-- > 0;) {
      value = value << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(n)]);
    }
    return value;
  };
  if (bytes.size() < kHeader) fail(path, "truncated BMP; expected its header");
  const std::uint32_t header = number(14, 4);
  if (header < 40 || header > 124) {
    fail(path, "a BMP with a header of " + std::to_string(header) + " bytes; expected 40 to 124");
  }
  const std::int64_t width = static_cast<std::int32_t>(number(18, 4));
  const std::int64_t height =
      std::abs(static_cast<std::int64_t>(static_cast<std::int32_t>(number(22, 4))));
  const std::uint32_t bits = number(28, 2), compression = number(30, 4);
  check_size(path, width, height);
  if (compression != 0 && compression != 3) {
    fail(path, "a compressed BMP; expected one without compression");
  }
  const std::uint64_t row = (static_cast<std::uint64_t>(width) * bits + 31) / 32 * 4;
  const std::uint64_t expected = number(10, 4) + row * static_cast<std::uint64_t>(height);
  if (bits == 0 || bits > 32 || bytes.size() < expected) {
    fail(path, std::to_string(bytes.size()) + " bytes; expected " + std::to_string(expected) +
                   " for " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels of " + std::to_string(bits) + " bits (truncated or corrupt BMP)");
  }
}

MapImage read_image(const std::string& path) {
  constexpr const char* kExpected = "; expected a PGM (or PBM, PPM), PNG or BMP image";
  std::string bytes = read_bytes(path, "a .pgm, .png or .bmp image");
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6') {
    return read_pnm(path, bytes);
  }
  const bool png = bytes.starts_with("\x89PNG\r\n\x1a\n"), bmp = bytes.starts_with("BM");
  if (png) {
    bytes = checked_png(path, bytes, kMostMapPixels);
    check_png_pixels(path, bytes);
  } else if (bmp) {
    check_bmp(path, bytes);
  } else {
    const std::pair<const char*, const char*> known[] = {
        {"\xff\xd8\xff", "a JPEG image, whose greys are not exact"},
        {"II*", "a TIFF image"},
        {"MM", "a TIFF image"},
        {"GIF8", "a GIF image"},
        {"RIFF", "a WebP image"},
        {"<", "an SVG, XML or HTML file"},
        {"version https://git-lfs", "a pointer of Git LFS, not the image itself"}};
    std::string kind = "no image that is read";
    for (const auto& [begin, name] : known) {
      if (bytes.starts_with(begin)) kind = name;
    }
    fail(path, kind + kExpected);
  }
  cv::Mat mat;
  try {
    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
    // The fourth channel of a BMP is mostly padding.
    mat = decode_pixels(raw, png ? cv::IMREAD_UNCHANGED : cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
    mat.release();
  }
  if (mat.empty() || (mat.depth() != CV_8U && mat.depth() != CV_16U)) {
    fail(path,
         std::string("corrupt ") + (png ? "PNG" : "BMP") + "; expected an image that decodes");
  }
  const int channels = mat.channels();
  const int colours = channels == 2 || channels == 4 ? channels - 1 : channels;
  MapImage image{mat.cols, mat.rows, {}};
  image.pixels.reserve(static_cast<std::size_t>(mat.cols) * static_cast<std::size_t>(mat.rows));
  const auto value = [&](int y, int index) {
    return mat.depth() == CV_8U ? static_cast<int>(mat.ptr<std::uint8_t>(y)[index])
                                : (static_cast<int>(mat.ptr<std::uint16_t>(y)[index]) + 128) / 257;
  };
  for (int y = 0; y < mat.rows; ++y) {
    for (int x = 0; x < mat.cols; ++x) {
      int sum = 0;
      for (int c = 0; c < colours; ++c) sum += value(y, x * channels + c);
      const bool transparent = colours < channels && value(y, x * channels + colours) < 128;
      image.pixels.push_back(transparent ? MapImage::kTransparent
                                         : static_cast<std::int16_t>(sum / colours));
    }
  }
  return image;
}

/// How pixel values become states.
struct Classes {
  std::array<CellState, 256> state;
};

Classes ros_classes(const MapImage& image, double occupied, double free, bool negate) {
  Classes classes;
  for (int v = 0; v < 256; ++v) {
    const double p = (negate ? v : 255 - v) / 255.0;
    classes.state[static_cast<std::size_t>(v)] = p > occupied ? CellState::kOccupied
                                                 : p < free   ? CellState::kFree
                                                              : CellState::kUnknown;
  }
  const bool white = std::any_of(image.pixels.begin(), image.pixels.end(),
                                 [](std::int16_t v) { return v >= 250; });
  if (white && !negate) classes.state[kUnknownOfMapSaver] = CellState::kUnknown;
  return classes;
}

/// Mode raw: the value is the probability in percent, above 100 unknown.
Classes raw_classes(double occupied, double free) {
  Classes classes;
  for (int v = 0; v < 256; ++v) {
    const double p = v / 100.0;
    classes.state[static_cast<std::size_t>(v)] = v > 100        ? CellState::kUnknown
                                                 : p > occupied ? CellState::kOccupied
                                                 : p < free     ? CellState::kFree
                                                                : CellState::kUnknown;
  }
  return classes;
}

Classes drawn_classes(const MapImage& image) {
  constexpr int kWhite = 240;
  constexpr int kBlack = 100;  // darker greys are lines, however many
  constexpr int kNear = 8;     // of a grey, from smoothed edges
  std::array<std::size_t, 256> count{};
  for (const std::int16_t v : image.pixels) {
    if (v != MapImage::kTransparent) ++count[static_cast<std::size_t>(v)];
  }
  Classes classes;
  for (int v = 0; v < 256; ++v) {
    classes.state[static_cast<std::size_t>(v)] =
        v >= kWhite ? CellState::kFree : CellState::kOccupied;
  }
  for (int grey = kBlack; grey < kWhite; ++grey) {
    if (25 * count[static_cast<std::size_t>(grey)] < image.pixels.size()) continue;
    for (int v = std::max(kBlack, grey - kNear); v <= std::min(kWhite - 1, grey + kNear); ++v) {
      classes.state[static_cast<std::size_t>(v)] = CellState::kUnknown;
    }
  }
  return classes;
}

Plan classify(const MapImage& image, const Classes& classes) {
  Plan plan{image.width, image.height, {}};
  plan.cells.reserve(image.pixels.size());
  for (int j = 0; j < image.height; ++j) {
    const std::size_t row =
        static_cast<std::size_t>(image.height - 1 - j) * static_cast<std::size_t>(image.width);
    for (int i = 0; i < image.width; ++i) {
      const std::int16_t v = image.pixels[row + static_cast<std::size_t>(i)];
      plan.cells.push_back(v == MapImage::kTransparent
                               ? CellState::kUnknown
                               : classes.state[static_cast<std::size_t>(v)]);
    }
  }
  return plan;
}

/// A plan turned by `yaw` about its lower left corner, which lies at `origin` [m], in cells along
/// the axes of W; `origin` becomes the lower left corner of what comes out. A cell is occupied if
/// it meets an occupied one, at any of 3 x 3 points in it, free if all of them are.
Plan turned(const Plan& plan, double resolution, double yaw, Eigen::Vector2d& origin,
            const std::string& path) {
  const Eigen::Rotation2Dd R(yaw);
  Eigen::AlignedBox2d box;
  for (const double x : {0.0, plan.width * resolution}) {
    for (const double y : {0.0, plan.height * resolution}) box.extend(R * Eigen::Vector2d(x, y));
  }
  constexpr double kRounding = 1e-6;
  const Eigen::Vector2d cells = (box.sizes() / resolution).array() - kRounding;
  check_size(path, static_cast<std::int64_t>(std::ceil(cells.x())),
             static_cast<std::int64_t>(std::ceil(cells.y())));
  Plan out{static_cast<int>(std::ceil(cells.x())), static_cast<int>(std::ceil(cells.y())), {}};
  out.cells.reserve(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
  for (int j = 0; j < out.height; ++j) {
    for (int i = 0; i < out.width; ++i) {
      int occupied = 0, free = 0;
      for (const double dy : {0.1, 0.5, 0.9}) {
        for (const double dx : {0.1, 0.5, 0.9}) {
          const Eigen::Vector2d p =
              R.inverse() * (box.min() + resolution * Eigen::Vector2d(i + dx, j + dy)) / resolution;
          const int x = static_cast<int>(std::floor(p.x())),
                    y = static_cast<int>(std::floor(p.y()));
          if (x < 0 || y < 0 || x >= plan.width || y >= plan.height) continue;
          const CellState state =
              plan.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(plan.width) +
                         static_cast<std::size_t>(x)];
          occupied += state == CellState::kOccupied;
          free += state == CellState::kFree;
        }
      }
      out.cells.push_back(occupied > 0 ? CellState::kOccupied
                          : free == 9  ? CellState::kFree
                                       : CellState::kUnknown);
    }
  }
  origin += box.min();
  return out;
}

/// Merges blocks of factor x factor cells from the lower left corner.
Plan merge(const Plan& fine, int factor) {
  if (factor <= 1) return fine;
  Plan coarse{(fine.width + factor - 1) / factor, (fine.height + factor - 1) / factor, {}};
  coarse.cells.assign(
      static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height),
      CellState::kFree);
  for (int j = 0; j < fine.height; ++j) {
    for (int i = 0; i < fine.width; ++i) {
      const CellState from =
          fine.cells[static_cast<std::size_t>(j) * static_cast<std::size_t>(fine.width) +
                     static_cast<std::size_t>(i)];
      CellState& to =
          coarse
              .cells[static_cast<std::size_t>(j / factor) * static_cast<std::size_t>(coarse.width) +
                     static_cast<std::size_t>(i / factor)];
      if (from == CellState::kOccupied) {
        to = CellState::kOccupied;
      } else if (from == CellState::kUnknown && to == CellState::kFree) {
        to = CellState::kUnknown;
      }
    }
  }
  return coarse;
}

World extrude(Plan fine, double resolution, const Eigen::Vector2d& origin, const std::string& path,
              const WorldOptions& options) {
  const bool sound = std::isfinite(options.resolution) && options.resolution >= 0.0 &&
                     std::isfinite(options.wall_height) && options.wall_height > 0.0;
  if (!sound) fail(path, "image resolution or wall height; expected finite positive lengths");
  if (options.unknown_is_free) {
    std::replace(fine.cells.begin(), fine.cells.end(), CellState::kUnknown, CellState::kFree);
  }
  if (options.voxel_size > 0.0 && options.voxel_size < 0.99 * resolution) {
    fail(path, "cells of " + text_of(resolution) + " m; expected --resolution " +
                   text_of(resolution) + " or more");
  }
  const double wanted = options.voxel_size > 0.0 ? options.voxel_size : options.resolution;
  // Written so that a ratio of thousands cannot overflow.
  const double ratio = std::min(wanted / resolution, 1e4);
  const int factor = std::max(1, static_cast<int>(std::lround(ratio)));
  const Plan plan = merge(fine, factor);
  const double r = resolution * factor;
  const double layers_wanted = std::ceil(options.wall_height / r - 1e-9);
  const double voxels =
      static_cast<double>(plan.cells.size()) * (std::max(1.0, layers_wanted) + 1.0);
  if (voxels > static_cast<double>(kMostMapVoxels)) {
    const double coarser = std::ceil(std::cbrt(voxels / static_cast<double>(kMostMapVoxels)));
    fail(path, "a world of " + std::to_string(plan.width) + " x " + std::to_string(plan.height) +
                   " cells of " + text_of(r) + " m at this wall height; expected at most " +
                   std::to_string(kMostMapVoxels) + " voxels: --resolution " +
                   text_of(std::max(2.0, coarser) * r) + " makes fewer");
  }
  const int layers = std::max(1, static_cast<int>(layers_wanted));
  const Eigen::Vector2d corner = origin / r;
  if (!(corner.cwiseAbs().maxCoeff() < 1e9)) {
    fail(path, "an origin " + text_of(origin.cwiseAbs().maxCoeff()) +
                   " m away is more than 1e9 "
                   "cells of " +
                   text_of(r) + " m; expected a coarser --resolution");
  }
  const GridFrame frame{r, static_cast<int>(std::lround(corner.x())),
                        static_cast<int>(std::lround(corner.y())), plan.width, plan.height};
  World world{fs::path(path).stem().string(),
              VoxelGrid(frame, -0.5 * r, (layers - 0.5) * r),
              {},
              {},
              {},
              0.0};
  bool any_free = false;
  for (int n = 0; n < frame.size(); ++n) {
    const CellState state = plan.cells[static_cast<std::size_t>(n)];
    if (state == CellState::kUnknown) continue;
    any_free = any_free || state == CellState::kFree;
    const Cell c = frame.at(n);
    world.voxels.set(c.i, c.j, -1, CellState::kOccupied);
    for (int k = 0; k < layers; ++k) world.voxels.set(c.i, c.j, k, state);
  }
  if (!any_free) fail(path, "no free cell; expected a map with free space (white pixels)");
  return world;
}

/// The image that a map's .yaml means: the one it names, beside the .yaml or where the name says;
/// or, since folders move, the one of the same name beside the .yaml, which is told. Another image
/// is another building.
std::string find_image(const std::string& yaml, const std::string& name, const std::string& where,
                       LeftOut& left_out) {
  std::error_code error;
  const fs::path folder = fs::path(yaml).parent_path();
  const fs::path named = fs::path(name).is_absolute() ? fs::path(name) : folder / name;
  if (fs::exists(named, error)) return named.string();
  // As Windows writes it.
  std::string slashed = name;
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  if (slashed != name && fs::is_regular_file(folder / slashed, error)) {
    return (folder / slashed).string();
  }
  const fs::path moved = folder / fs::path(slashed).filename();
  if (fs::path(slashed).has_filename() && fs::is_regular_file(moved, error)) {
    left_out.name("the folder of image " + in_quotes(name) + " (absent; read beside the .yaml)");
    return moved.string();
  }
  std::string beside;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, error)) {
    const std::string e = lower_case_extension(entry.path());
    const bool hidden = entry.path().filename().string().starts_with(".");
    const bool image = e == ".pgm" || e == ".png" || e == ".bmp";
    if (hidden || !image || beside.size() > 200) continue;
    beside += (beside.empty() ? "" : ", ") + in_quotes(entry.path().filename().string());
  }
  fail(where, "image " + in_quotes(name) + " is absent; expected it at " + named.string() +
                  (beside.empty() ? "" : ", or one of these named here: " + beside));
}

/// What is said of a scale that nobody stated.
std::string assumed_scale(double pixel, const WorldOptions& given) {
  return given.voxel_size > 0.0 ? "" : text_of(pixel) + " m a pixel (--resolution says otherwise)";
}

/// [m] of a pixel of an image that states none; --resolution is taken for it.
double checked_pixel_size(const std::string& path, WorldOptions& options) {
  const double size = options.voxel_size > 0.0 ? options.voxel_size : options.pixel_size;
  if (!(size >= 1e-3 && size <= 10.0)) {
    fail(path, "pixel size out of range; expected 0.001 to 10 m");
  }
  options.voxel_size = 0.0;
  return size;
}

constexpr double kMostYaw = 8.0;  // [rad]: more is an angle in degrees
// A northing of UTM reaches 1e7, a coordinate of Web Mercator 2.004e7 [m].
constexpr double kFarthestOrigin = 2.1e7;
// Farther away cameras, whose numbers have single precision, do not see millimetres [m].
constexpr double kFarOrigin = 1e4;

/// Pixels between the thresholds, as Cartographer's map of probabilities has them within free
/// space; not those that say by their value that nothing is known there. Empty if they are few.
std::string between_thresholds(const MapImage& image, const Classes& classes) {
  std::size_t between = 0, free = 0;
  for (const std::int16_t v : image.pixels) {
    if (v == MapImage::kTransparent || v == kUnknownOfMapSaver) continue;
    const CellState state = classes.state[static_cast<std::size_t>(v)];
    between += state == CellState::kUnknown;
    free += state == CellState::kFree;
  }
  if (20 * between < free) return {};
  return std::to_string(between) + " cells, beside " + std::to_string(free) +
         " free ones, lie between free_thresh and occupied_thresh and are unknown: a higher "
         "free_thresh in the .yaml, or --unknown free, makes them free";
}

}  // namespace

World world_from_ros_map(const std::string& path, const WorldOptions& options) {
  StrictYaml yaml = StrictYaml::from_file(path);
  yaml.accept_quoted_numbers();
  YamlMap root = yaml.root();
  const std::string name = root.required_text("image", "file with the cells");
  const std::string where = root.where("image");
  const double resolution = root.required_number("resolution", 1e-3, 10.0, "m", "size of a pixel");
  const std::vector<double> origin = root.required_numbers(
      "origin", 3, -kFarthestOrigin, kFarthestOrigin, "", "x, y [m], yaw [rad] of the lower left");
  const bool negate = root.loose_boolean("negate", false, "white is occupied");
  const double occupied = root.number("occupied_thresh", 0.65, 0.0, 1.0, "1", "occupied above");
  const double free = root.number("free_thresh", 0.196, 0.0, 1.0, "1", "free below");
  const std::string mode = root.loose_choice("mode", "trinary", {"trinary", "scale", "raw"},
                                             "meaning of values between the thresholds");
  if (std::abs(origin[2]) > kMostYaw) {
    root.problem("origin", "has a yaw of more than 8 rad; expected radians, not degrees");
  }
  if (free > occupied) {
    root.problem("free_thresh", "above occupied_thresh; expected free_thresh <= occupied_thresh");
  }
  if (mode == "raw" && negate) {
    root.problem("negate",
                 "is set with mode raw, where programs differ in what it means; expected 0");
  }
  LeftOut left_out;
  for (const std::string& key : root.leave_rest()) left_out.name("key " + in_quotes(key));
  yaml.finish();
  const std::string image_path = find_image(path, name, where, left_out);
  const MapImage image = read_image(image_path);
  const Classes classes =
      mode == "raw" ? raw_classes(occupied, free) : ros_classes(image, occupied, free, negate);
  Plan plan = classify(image, classes);
  Eigen::Vector2d corner(origin[0], origin[1]);
  // Less than a hundredth of a cell at the far end is rounding.
  const double yaw = std::remainder(origin[2], 2.0 * std::numbers::pi);
  if (std::abs(yaw) * std::max(plan.width, plan.height) > 0.01) {
    plan = turned(plan, resolution, yaw, corner, path);
  }
  if (corner.cwiseAbs().maxCoeff() > kFarOrigin) {
    char words[160];
    std::snprintf(words, sizeof words,
                  "the origin (%.2f, %.2f) m: positions count from the map's lower left corner",
                  corner.x(), corner.y());
    left_out.name(words);
    corner.setZero();
  }
  World world = extrude(std::move(plan), resolution, corner, path, options);
  world.left_out = std::move(left_out);
  if (mode != "raw" && !options.unknown_is_free) {
    world.if_no_room = between_thresholds(image, classes);
  }
  return world;
}

World world_from_image(const std::string& path, const WorldOptions& given) {
  WorldOptions options = given;
  const double pixel = checked_pixel_size(path, options);
  const MapImage image = read_image(path);
  const Classes classes = lower_case_extension(path) == ".pgm"
                              ? ros_classes(image, 0.65, 0.196, false)
                              : drawn_classes(image);
  World world = extrude(classify(image, classes), pixel, Eigen::Vector2d::Zero(), path, options);
  world.assumed = assumed_scale(pixel, given);
  return world;
}

World world_from_movingai(const std::string& path, const WorldOptions& given) {
  WorldOptions options = given;
  const double pixel = checked_pixel_size(path, options);
  const std::string bytes = read_bytes(path, "a MovingAI .map grid");
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  std::vector<std::string_view> lines;
  for (std::size_t at = bytes.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
       at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string_view line = std::string_view(bytes).substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    lines.push_back(line);
    at = end + 1;
  }
  while (!lines.empty() && lines.back().empty()) lines.pop_back();
  const auto sized = [&](std::size_t line, std::string_view key) {
    std::int64_t value = 0;
    const bool there = line < lines.size() && lines[line].starts_with(key);
    const std::string_view text = there ? lines[line].substr(key.size()) : std::string_view{};
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (!there || result.ec != std::errc() || result.ptr != text.data() + text.size()) {
      fail(path + ":" + std::to_string(line + 1),
           "not a MovingAI grid; expected '" + std::string(key) + "N'");
    }
    return value;
  };
  if (lines.empty() || !lines[0].starts_with("type ")) {
    fail(path + ":1", "not a MovingAI grid; expected 'type octile'");
  }
  const std::int64_t height = sized(1, "height ");
  const std::int64_t width = sized(2, "width ");
  check_size(path, width, height);
  if (lines.size() < 4 || lines[3] != "map") {
    fail(path + ":4", "not a MovingAI grid; expected 'map'");
  }
  if (static_cast<std::int64_t>(lines.size()) != height + 4) {
    fail(path, std::to_string(lines.size() - 4) + " rows; expected " + std::to_string(height));
  }
  Plan plan{static_cast<int>(width), static_cast<int>(height), {}};
  plan.cells.reserve(static_cast<std::size_t>(width * height));
  for (std::size_t line = lines.size(); line-- > 4;) {
    if (static_cast<std::int64_t>(lines[line].size()) != width) {
      fail(path + ":" + std::to_string(line + 1), std::to_string(lines[line].size()) +
                                                      " cells in the row; expected " +
                                                      std::to_string(width));
    }
    for (const char c : lines[line]) {
      const bool free = c == '.' || c == 'G' || c == 'S';
      if (!free && std::string_view("@OTW").find(c) == std::string_view::npos) {
        fail(path + ":" + std::to_string(line + 1),
             "a cell of unknown kind; expected one of . G S @ O T W");
      }
      plan.cells.push_back(free ? CellState::kFree : CellState::kOccupied);
    }
  }
  World world = extrude(std::move(plan), pixel, Eigen::Vector2d::Zero(), path, options);
  world.assumed = assumed_scale(pixel, given);
  return world;
}

}  // namespace prospect
