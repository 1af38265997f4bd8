#include "adapters/worlds/ros_map.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>

#include "adapters/config/input_error.h"
#include "adapters/config/strict_yaml.h"
#include "adapters/worlds/checked_png.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

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

/// Binary PGM with one byte a pixel, read here so that missing or surplus pixels are noticed.
MapImage read_pgm(const std::string& path, std::string_view bytes) {
  std::size_t at = 2;
  const auto next_number = [&]() -> std::int64_t {
    while (at < bytes.size()) {
      if (bytes[at] == '#') {
        while (at < bytes.size() && bytes[at] != '\n') ++at;
      } else if (std::isspace(static_cast<unsigned char>(bytes[at]))) {
        ++at;
      } else {
        break;
      }
    }
    std::int64_t value = 0;
    const auto result = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), value);
    if (result.ec != std::errc() || value < 0) {
      fail(path, "corrupt PGM header; expected width, height and largest value");
    }
    at = static_cast<std::size_t>(result.ptr - bytes.data());
    return value;
  };
  const std::int64_t width = next_number();
  const std::int64_t height = next_number();
  const std::int64_t largest = next_number();
  check_size(path, width, height);
  if (largest < 1 || largest > 255) {
    fail(path, "PGM with largest value " + std::to_string(largest) + "; expected 1 to 255");
  }
  ++at;  // one white-space character ends the header
  const std::size_t expected = static_cast<std::size_t>(width * height);
  const std::size_t found = at < bytes.size() ? bytes.size() - at : 0;
  if (found != expected) {
    fail(path, std::to_string(found) + " bytes of pixels; expected " + std::to_string(expected) +
                   " for " + std::to_string(width) + " x " + std::to_string(height));
  }
  MapImage image{static_cast<int>(width), static_cast<int>(height), {}};
  image.pixels.resize(expected);
  for (std::size_t n = 0; n < expected; ++n) {
    const int v = static_cast<unsigned char>(bytes[at + n]);
    image.pixels[n] =
        static_cast<std::int16_t>(std::min<std::int64_t>(255, (v * 255 + largest / 2) / largest));
  }
  return image;
}

MapImage read_image(const std::string& path) {
  const std::string bytes = read_bytes(path, "a .pgm or .png image");
  if (bytes.starts_with("P5")) return read_pgm(path, bytes);
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) {
    fail(path, "not a binary PGM (P5) or PNG image; expected one of them");
  }
  std::string png = checked_png(path, bytes, kMostMapPixels);
  cv::Mat mat;
  try {
    const cv::Mat raw(1, static_cast<int>(png.size()), CV_8UC1, png.data());
    mat = cv::imdecode(raw, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    mat.release();
  }
  if (mat.empty() || (mat.depth() != CV_8U && mat.depth() != CV_16U)) {
    fail(path, "corrupt PNG; expected an image that decodes");
  }
  const int channels = mat.channels();
  const int colours = channels == 2 || channels == 4 ? channels - 1 : channels;
  MapImage image{mat.cols, mat.rows, {}};
  image.pixels.reserve(static_cast<std::size_t>(mat.cols) * static_cast<std::size_t>(mat.rows));
  const auto value = [&](int y, int index) {
    return mat.depth() == CV_8U ? static_cast<int>(mat.ptr<std::uint8_t>(y)[index])
                                : static_cast<int>(mat.ptr<std::uint16_t>(y)[index]) / 257;
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
  constexpr int kUnknownOfMapSaver = 205;
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

World extrude(const Plan& fine, double resolution, const Eigen::Vector2d& origin,
              const std::string& path, const WorldOptions& options) {
  const bool sound = std::isfinite(options.resolution) && options.resolution >= 0.0 &&
                     std::isfinite(options.wall_height) && options.wall_height > 0.0;
  if (!sound) fail(path, "image resolution or wall height; expected finite positive lengths");
  // Written so that a ratio of thousands cannot overflow.
  const double ratio = std::min(options.resolution / resolution, 1e4);
  const int factor = std::max(1, static_cast<int>(std::lround(ratio)));
  const Plan plan = merge(fine, factor);
  const double r = resolution * factor;
  const double layers_wanted = std::ceil(options.wall_height / r - 1e-9);
  const double voxels =
      static_cast<double>(plan.cells.size()) * (std::max(1.0, layers_wanted) + 1.0);
  if (voxels > static_cast<double>(kMostMapVoxels)) {
    fail(path, "a world of " + std::to_string(plan.width) + " x " + std::to_string(plan.height) +
                   " cells at this wall height; expected at most " +
                   std::to_string(kMostMapVoxels) + " voxels");
  }
  const int layers = std::max(1, static_cast<int>(layers_wanted));
  const Eigen::Vector2d corner = origin / r;
  if (!(corner.cwiseAbs().maxCoeff() < 1e8)) {
    fail(path, "an origin far outside; expected it within 1e8 cells");
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

std::string extension(const fs::path& path) {
  std::string text = path.extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_image(const fs::path& path) {
  const std::string e = extension(path);
  return e == ".pgm" || e == ".png";
}

/// The image a map's yaml means: the one it names, or what the folder offers in its place.
std::string find_image(const std::string& yaml, const std::string& name, const std::string& where) {
  std::error_code error;
  const fs::path folder = fs::path(yaml).parent_path();
  const fs::path named = fs::path(name).is_absolute() ? fs::path(name) : folder / name;
  if (fs::exists(named, error)) return named.string();
  for (const char* e : {".pgm", ".png"}) {
    const fs::path same_stem = fs::path(yaml).replace_extension(e);
    if (fs::is_regular_file(same_stem, error)) return same_stem.string();
  }
  std::vector<fs::path> images;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, error)) {
    if (is_image(entry.path())) images.push_back(entry.path());
  }
  if (images.size() == 1) return images.front().string();
  fail(where, "image '" + name + "' is absent; expected it at " + named.string() +
                  ", or one image beside the .yaml");
}

double checked_pixel_size(const std::string& path, const WorldOptions& options) {
  if (!(options.pixel_size >= 1e-3 && options.pixel_size <= 10.0)) {
    fail(path, "pixel size out of range; expected 0.001 to 10 m");
  }
  return options.pixel_size;
}

}  // namespace

World world_from_ros_map(const std::string& path, const WorldOptions& options) {
  StrictYaml yaml = StrictYaml::from_file(path);
  YamlMap root = yaml.root();
  const std::string name = root.required_text("image", "file with the cells");
  const std::string where = root.where("image");
  const double resolution = root.required_number("resolution", 1e-3, 10.0, "m", "size of a pixel");
  const std::vector<double> origin =
      root.required_numbers("origin", 3, -1e6, 1e6, "", "x, y [m], yaw [rad] of the lower left");
  const std::int64_t negate = root.integer("negate", 0, 0, 1, "", "1: white is occupied");
  const double occupied = root.number("occupied_thresh", 0.65, 0.0, 1.0, "1", "occupied above");
  const double free = root.number("free_thresh", 0.196, 0.0, 1.0, "1", "free below");
  root.choice("mode", "trinary", {"trinary", "scale"}, "meaning of values between the thresholds");
  if (origin[2] != 0.0) {
    root.problem("origin", "a rotated map (yaw not 0); expected yaw 0");
  }
  if (free > occupied) {
    root.problem("free_thresh", "above occupied_thresh; expected free_thresh <= occupied_thresh");
  }
  yaml.finish();
  const std::string image_path = find_image(path, name, where);
  const MapImage image = read_image(image_path);
  return extrude(classify(image, ros_classes(image, occupied, free, negate != 0)), resolution,
                 {origin[0], origin[1]}, path, options);
}

World world_from_image(const std::string& path, const WorldOptions& options) {
  const double pixel = checked_pixel_size(path, options);
  const MapImage image = read_image(path);
  const Classes classes =
      extension(path) == ".pgm" ? ros_classes(image, 0.65, 0.196, false) : drawn_classes(image);
  return extrude(classify(image, classes), pixel, Eigen::Vector2d::Zero(), path, options);
}

World world_from_movingai(const std::string& path, const WorldOptions& options) {
  const double pixel = checked_pixel_size(path, options);
  const std::string bytes = read_bytes(path, "a MovingAI .map grid");
  std::vector<std::string_view> lines;
  for (std::size_t at = 0; at < bytes.size();) {
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
  return extrude(plan, pixel, Eigen::Vector2d::Zero(), path, options);
}

}  // namespace prospect
