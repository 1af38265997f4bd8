// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/video_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/files/child_process.h"
#include "adapters/formats/files/input_error.h"
#include "models/lower_case.h"

namespace prospect {
namespace {

constexpr std::array kEndings = {"mp4", "avi", "mkv",  "mov", "webm", "m4v",
                                 "mpg", "ts",  "m2ts", "wmv", "flv",  "ogv"};
constexpr std::size_t kMemory = std::size_t{4} << 30;  // [bytes] of addresses, most never used

/// A descriptor that is closed with this object.
class Descriptor {
 public:
  explicit Descriptor(int descriptor = -1) : descriptor_(descriptor) {}
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

/// Path of ffmpeg. Throws InputError, of the video `path`, if it is not in PATH.
std::string find_ffmpeg(const std::string& path) {
  const char* folders = std::getenv("PATH");
  std::istringstream in(folders ? folders : "");
  for (std::string folder; std::getline(in, folder, ':');) {
    const std::string program = (folder.empty() ? "." : folder) + "/ffmpeg";
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  fail(path,
       "a video, which the program ffmpeg decodes, and there is none in PATH; expected it "
       "(Debian: apt-get install ffmpeg), or the images: ffmpeg -i VIDEO left/%06d.png");
}

/// ffmpeg, writing the frames of a video to a pipe.
struct Decoder {
  /// `format`: what is written of each frame; `errors`: file for what it says.
  Decoder(const std::string& path, const std::string& format,
          const std::string& errors = "/dev/null") {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw std::runtime_error(std::string("no pipe to ffmpeg: ") + std::strerror(errno));
    }
    output = Descriptor(ends[0]);
    const Descriptor input(ends[1]);
    process = ChildProcess(
        {find_ffmpeg(path), "-nostdin", "-hide_banner", "-v", "warning",
         // With more threads, what is read of a damaged video depends on their order.
         "-threads", "1",
         // What is damaged is left out, not made up; nothing but this file is opened.
         "-err_detect", "explode", "-fflags", "+discardcorrupt", "-max_pixels", "100000000",
         "-protocol_whitelist", "file", "-noautorotate",
         // Times as they are in the file, and each frame once, at its time.
         "-copyts", "-i", "file:" + path, "-an", "-sn", "-dn", "-fps_mode", "passthrough",
         "-enc_time_base", "-1", "-autoscale", "0", "-pix_fmt", "gray", "-f", format, "-"},
        {.errors = errors, .output = input.get(), .memory = kMemory});
  }

  /// The next bytes, at most `size`; fewer at the end.
  std::size_t read(std::uint8_t* bytes, std::size_t size) const {
    std::size_t done = 0;
    while (done < size) {
      const ssize_t n = ::read(output.get(), bytes + done, size - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) break;
      done += static_cast<std::size_t>(n);
    }
    return done;
  }

  ChildProcess process;
  Descriptor output;
};

/// Lines of what ffmpeg says, without the parts and addresses of the program that they begin with.
std::vector<std::string> said_lines(const std::string& text, const std::string& path) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    // Of any JPEG with the full range of grey levels, and it is set right.
    if (line.find("deprecated pixel format") != std::string::npos) continue;
    while (line.starts_with('[') && line.find("] ") != std::string::npos) {
      line.erase(0, line.find("] ") + 2);
    }
    const std::string file = "file:" + path + ": ";
    if (line.starts_with(file)) line.erase(0, file.size());
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

/// What a video holds, before its pixels are read.
struct Contents {
  int width = 0, height = 0;
  std::vector<double> stamps;
  std::vector<std::string> said;
};

/// Reads the form framecrc of ffmpeg: lines `#key stream: value`, then one a frame, `stream, dts,
/// pts, duration, bytes, checksum`.
Contents read_frame_list(const std::string& path, const std::string& text) {
  Contents contents;
  long long numerator = 0, denominator = 1;  // of the unit of times [s]
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::sscanf(line.c_str(), "#tb 0: %lld/%lld", &numerator, &denominator);
    std::sscanf(line.c_str(), "#dimensions 0: %dx%d", &contents.width, &contents.height);
    long long pts = 0, bytes = 0;
    if (std::sscanf(line.c_str(), "0, %*d, %lld, %*d, %lld,", &pts, &bytes) != 2) continue;
    const std::string frame = "frame " + std::to_string(contents.stamps.size());
    if (bytes != static_cast<long long>(contents.width) * contents.height) {
      fail(path, frame + " has another size than " + std::to_string(contents.width) + " x " +
                     std::to_string(contents.height) + " pixels; expected the same of all");
    }
    const double stamp = static_cast<double>(pts) * static_cast<double>(numerator) /
                         static_cast<double>(denominator);
    if (!contents.stamps.empty() && !(stamp > contents.stamps.back())) {
      fail(path, frame + " is at " + number_text(stamp) + " s, the one before at " +
                     number_text(contents.stamps.back()) + " s; expected times that increase");
    }
    contents.stamps.push_back(stamp);
  }
  return contents;
}

Contents look_into(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    fail(path, "no regular file; expected a video");
  }
  const Descriptor errors(::memfd_create("ffmpeg", MFD_CLOEXEC));
  Decoder decoder(path, "framecrc", "/dev/fd/" + std::to_string(errors.get()));
  std::string text, said;
  std::vector<std::uint8_t> buffer(std::size_t{1} << 16);
  for (std::size_t n = 0; (n = decoder.read(buffer.data(), buffer.size())) > 0;) {
    text.append(reinterpret_cast<const char*>(buffer.data()), n);
  }
  const ChildProcess::End end = decoder.process.wait();
  for (ssize_t n = 0; (n = ::pread(errors.get(), buffer.data(), buffer.size(),
                                   static_cast<off_t>(said.size()))) > 0;) {
    said.append(reinterpret_cast<const char*>(buffer.data()), static_cast<std::size_t>(n));
  }
  Contents contents = read_frame_list(path, text);
  contents.said = said_lines(said, path);
  if (end.signal != 0) {
    contents.said.push_back("ended by signal " + std::to_string(end.signal));
  } else if (end.code != 0 && contents.said.empty()) {
    contents.said.push_back("ended with exit code " + std::to_string(end.code));
  }
  if (contents.stamps.empty()) {
    std::string why = contents.said.empty() ? "no frame" : contents.said.front();
    if (contents.said.size() > 1) why += "; " + contents.said.back();
    fail(path, "ffmpeg decodes no frame of it (" + why + "); expected a video");
  }
  return contents;
}

/// The frames of a video, one after the other.
class Frames {
 public:
  Frames(std::string path, const Contents& contents) : path_(std::move(path)) {
    image_.width = contents.width;
    image_.height = contents.height;
    image_.bytes.resize(static_cast<std::size_t>(contents.width) *
                        static_cast<std::size_t>(contents.height));
  }

  const RawImage& read(std::size_t i) {
    if (!decoder_ || i + 1 < next_) {
      decoder_.reset();
      decoder_ = std::make_unique<Decoder>(path_, "rawvideo");
      next_ = 0;
    }
    for (; next_ <= i; ++next_) {
      if (decoder_->read(image_.bytes.data(), image_.bytes.size()) != image_.bytes.size()) {
        decoder_.reset();
        fail(path_, "frame " + std::to_string(next_) +
                        " cannot be decoded again; expected a file that does not change");
      }
    }
    return image_;
  }

 private:
  std::string path_;
  std::unique_ptr<Decoder> decoder_;
  std::size_t next_ = 0;  // frame that the decoder hands over next; the one before is image_
  RawImage image_;
};

ImageStream stream_of(const std::string& path, const Contents& contents) {
  ImageStream stream;
  stream.name = path;
  stream.stamps = contents.stamps;
  for (std::size_t i = 0; i < contents.stamps.size(); ++i) {
    stream.names.push_back(path + " frame " + std::to_string(i));
  }
  return stream;
}

void add_note(const std::string& path, const Contents& contents, std::vector<std::string>& notes) {
  if (contents.said.empty()) return;
  std::string note = path + ": " + std::to_string(contents.stamps.size()) +
                     " frames are read, to " + number_text(contents.stamps.back()) +
                     " s; ffmpeg says: " + contents.said.front();
  if (contents.said.size() > 1) {
    note += " (and " + std::to_string(contents.said.size() - 1) + " more)";
  }
  notes.push_back(note);
}

/// Columns of an image of one byte a pixel.
RawImage columns(const RawImage& image, int first, int width) {
  RawImage part;
  part.width = width;
  part.height = image.height;
  part.bytes.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(image.height));
  for (int row = 0; row < image.height; ++row) {
    const auto begin = image.bytes.begin() + static_cast<std::ptrdiff_t>(row) * image.width + first;
    part.bytes.insert(part.bytes.end(), begin, begin + width);
  }
  return part;
}

}  // namespace

bool is_video_name(const std::string& name) {
  const auto dot = name.rfind('.');
  if (dot == std::string::npos) return false;
  return std::find(kEndings.begin(), kEndings.end(), lower_case(name.substr(dot + 1))) !=
         kEndings.end();
}

std::string find_video(const std::string& stem) {
  std::error_code error;
  for (std::string ending : kEndings) {
    for (int upper = 0; upper < 2; ++upper) {
      const std::string path = stem + "." + ending;
      if (std::filesystem::exists(path, error)) return path;
      for (char& c : ending) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
  }
  return {};
}

ImageStream video_images(const std::string& path, std::vector<std::string>& notes) {
  const Contents contents = look_into(path);
  add_note(path, contents, notes);
  ImageStream stream = stream_of(path, contents);
  stream.read = [frames = std::make_shared<Frames>(path, contents)](std::size_t i) {
    return frames->read(i);
  };
  return stream;
}

std::pair<ImageStream, ImageStream> side_by_side_images(const std::string& path,
                                                        std::vector<std::string>& notes) {
  const Contents contents = look_into(path);
  if (contents.width % 2 != 0) {
    fail(path, "frames are " + std::to_string(contents.width) +
                   " pixels wide; expected two images of the same width, left and right");
  }
  add_note(path, contents, notes);
  std::pair<ImageStream, ImageStream> halves(stream_of(path, contents), stream_of(path, contents));
  const auto frames = std::make_shared<Frames>(path, contents);
  const int width = contents.width / 2;
  halves.first.read = [frames, width](std::size_t i) { return columns(frames->read(i), 0, width); };
  halves.second.read = [frames, width](std::size_t i) {
    return columns(frames->read(i), width, width);
  };
  return halves;
}

}  // namespace prospect
