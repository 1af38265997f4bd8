// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/printable_output.h"

#include <unistd.h>

#include <cerrno>
#include <ext/stdio_sync_filebuf.h>
#include <iostream>
#include <string>
#include <string_view>

#include "adapters/formats/files/printable_text.h"

namespace prospect {
namespace {

/// Where what is printable goes.
struct Sink {
  int file;
  PrintableText text;
};

/// As fopencookie(3) asks: the number of bytes that were taken, 0 for an error.
ssize_t write_printable(void* to, const char* data, std::size_t size) {
  auto& sink = *static_cast<Sink*>(to);
  const std::string text = sink.text.of(std::string_view(data, size));
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = ::write(sink.file, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return 0;
    at += static_cast<std::size_t>(n);
  }
  return static_cast<ssize_t>(size);
}

}  // namespace

struct PrintableOutput::Stream {
  Stream(std::FILE*& its_standard, std::ostream& its_stream, int file, int buffering)
      : standard(its_standard), stream(its_stream), before(its_standard), sink{file, {}} {
    stream.flush();
    std::fflush(before);
    through = ::fopencookie(&sink, "w", {nullptr, &write_printable, nullptr, nullptr});
    if (through == nullptr) return;  // no memory: as it was
    std::setvbuf(through, nullptr, buffering, BUFSIZ);
    standard = through;
    buffer = std::make_unique<__gnu_cxx::stdio_sync_filebuf<char>>(through);
    streamed_before = stream.rdbuf(buffer.get());
  }
  ~Stream() {
    if (through == nullptr) return;
    stream.flush();
    stream.rdbuf(streamed_before);
    standard = before;
    std::fclose(through);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  std::FILE*& standard;
  std::ostream& stream;
  std::FILE* before;
  Sink sink;
  std::FILE* through = nullptr;
  std::unique_ptr<__gnu_cxx::stdio_sync_filebuf<char>> buffer;
  std::streambuf* streamed_before = nullptr;
};

PrintableOutput::PrintableOutput()
    : output_(std::make_unique<Stream>(stdout, std::cout, STDOUT_FILENO,
                                       ::isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF)),
      errors_(std::make_unique<Stream>(stderr, std::cerr, STDERR_FILENO, _IONBF)) {}
PrintableOutput::~PrintableOutput() = default;

}  // namespace prospect
