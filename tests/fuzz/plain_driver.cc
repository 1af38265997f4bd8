// SPDX-License-Identifier: Apache-2.0
// Drives a fuzzing target where there is no libFuzzer: mutations of a corpus by a seeded generator,
// without regard to coverage. Takes those of libFuzzer's options that the README names.
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

struct Options {
  double max_total_time = 0.0;  ///< [s] of processor time; 0: only what the corpus holds
  std::uint64_t seed = 1;
  unsigned timeout = 5;             ///< [s] of processor time, an input
  std::size_t rss_limit_mb = 2048;  ///< of the process
  std::size_t max_len = 1 << 20;    ///< [bytes] of an input
  std::vector<std::string> corpus;  ///< files and folders
};

// What a signal handler may look at.
const Bytes* current = nullptr;
char crash_path[64];

/// Leaves the input that is running behind, and ends.
void leave_behind(int signal) {
  if (current != nullptr) {
    if (std::FILE* file = std::fopen(crash_path, "wb")) {
      std::fwrite(current->data(), 1, current->size(), file);
      std::fclose(file);
    }
    std::fprintf(stderr, "signal %d (%s); the input is in %s\n", signal,
                 signal == SIGALRM || signal == SIGPROF ? "too slow" : strsignal(signal),
                 crash_path);
  }
  std::_Exit(77);
}

bool option(const std::string& argument, const std::string& name, std::string& value) {
  if (!argument.starts_with("-" + name + "=")) return false;
  value = argument.substr(name.size() + 2);
  return true;
}

Options options_of(int argc, char** argv) {
  Options options;
  for (int n = 1; n < argc; ++n) {
    const std::string argument = argv[n];
    std::string value;
    if (option(argument, "max_total_time", value)) {
      options.max_total_time = std::stod(value);
    } else if (option(argument, "seed", value)) {
      options.seed = std::stoull(value);
    } else if (option(argument, "timeout", value)) {
      options.timeout = static_cast<unsigned>(std::stoul(value));
    } else if (option(argument, "rss_limit_mb", value)) {
      options.rss_limit_mb = std::stoull(value);
    } else if (option(argument, "max_len", value)) {
      options.max_len = std::stoull(value);
    } else if (argument.starts_with("-")) {
      std::fprintf(stderr,
                   "unknown option %s; expected -max_total_time=S, -seed=N, -timeout=S, "
                   "-rss_limit_mb=N, -max_len=N and files or folders\n",
                   argument.c_str());
      std::exit(2);
    } else {
      options.corpus.push_back(argument);
    }
  }
  return options;
}

std::vector<Bytes> read_corpus(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  std::vector<Bytes> corpus;
  for (const std::string& file : files) {
    std::ifstream in(file, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return corpus;
}

class Mutator {
 public:
  Mutator(std::vector<Bytes> corpus, std::uint64_t seed, std::size_t longest)
      : corpus_(std::move(corpus)), random_(seed), longest_(longest) {}

  Bytes next() {
    Bytes bytes = corpus_[below(corpus_.size())];
    const std::size_t changes = 1 + below(6);
    for (std::size_t n = 0; n < changes; ++n) change(bytes);
    if (bytes.size() > longest_) bytes.resize(longest_);
    return bytes;
  }

 private:
  std::size_t below(std::size_t bound) { return bound < 2 ? 0 : random_() % bound; }

  void change(Bytes& bytes) {
    static const char* const kTexts[] = {
        "-1",         "0",       "nan",        "inf",
        "1e308",      "-1e-308", "4294967295", "18446744073709551615",
        "2147483648", "1e999",   "",           "\n",
        "{",          "[",       "]",          "}",
        "<",          ">",       "\"",         ":",
        ",",          "- ",      "0x",         "\t",
        "&a",         "*a",      "../",        "%s",
        "\x1b[2J"};
    static const std::uint8_t kBytes[] = {0, 1, 0x7f, 0x80, 0xff, ' ', '\n', '9', '-', '.'};
    const std::size_t at = below(bytes.size() + 1);
    const auto place = [&](std::size_t n) {
      return bytes.begin() + static_cast<std::ptrdiff_t>(std::min(n, bytes.size()));
    };
    const std::size_t length = 1 + below(below(8) == 0 ? 256 : 8);
    switch (below(9)) {
      case 0:
        if (at < bytes.size()) bytes[at] ^= static_cast<std::uint8_t>(1U << below(8));
        break;
      case 1:
        if (at < bytes.size()) bytes[at] = kBytes[below(std::size(kBytes))];
        break;
      case 2:
        bytes.erase(place(at), place(at + length));
        break;
      case 3: {
        const Bytes block(place(at), place(at + length));
        bytes.insert(place(below(bytes.size() + 1)), block.begin(), block.end());
        break;
      }
      case 4: {
        const char* text = kTexts[below(std::size(kTexts))];
        bytes.insert(place(at), text, text + std::strlen(text));
        break;
      }
      case 5: {  // another number
        std::size_t begin = at;
        while (begin < bytes.size() && (bytes[begin] < '0' || bytes[begin] > '9')) ++begin;
        std::size_t end = begin;
        while (end < bytes.size() && std::strchr("0123456789.e+-", bytes[end]) != nullptr &&
               bytes[end] != 0) {
          ++end;
        }
        const char* text = kTexts[below(10)];
        bytes.erase(place(begin), place(end));
        bytes.insert(place(begin), text, text + std::strlen(text));
        break;
      }
      case 6:  // four or eight bytes, as of a length
        for (std::size_t n = 0, size = below(2) == 0 ? 4 : 8; n < size && at + n < bytes.size();
             ++n) {
          bytes[at + n] = below(2) == 0 ? 0xff : 0;
        }
        break;
      case 7:
        bytes.resize(at);
        break;
      default: {
        const Bytes& other = corpus_[below(corpus_.size())];
        const std::size_t from = below(other.size() + 1);
        const std::size_t to = std::min(other.size(), from + below(512));
        bytes.insert(place(at), other.begin() + static_cast<std::ptrdiff_t>(from),
                     other.begin() + static_cast<std::ptrdiff_t>(to));
      }
    }
  }

  std::vector<Bytes> corpus_;
  std::mt19937_64 random_;
  std::size_t longest_;
};

double processor_time() {
  double seconds = 0.0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage used{};
    ::getrusage(static_cast<__rusage_who>(who), &used);
    for (const timeval& time : {used.ru_utime, used.ru_stime}) {
      seconds += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
  }
  return seconds;
}

/// [s] of processor time from now on, after which an input is too slow; and what a busy machine
/// may make of that, for one that waits. 0: no end.
void limit(unsigned seconds) {
  constexpr unsigned kBusy = 30;
  itimerval timer{};
  timer.it_value.tv_sec = seconds;
  ::setitimer(ITIMER_PROF, &timer, nullptr);
  ::alarm(kBusy * seconds);
}

void run(const Bytes& bytes, const Options& options) {
  current = &bytes;
  limit(options.timeout);
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  limit(0);
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  if (static_cast<std::size_t>(used.ru_maxrss) > options.rss_limit_mb << 10) {
    std::fprintf(stderr, "%ld MB of memory\n", used.ru_maxrss >> 10);
    leave_behind(0);
  }
  current = nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = options_of(argc, argv);
  std::snprintf(crash_path, sizeof crash_path, "crash-%llu-%d",
                static_cast<unsigned long long>(options.seed), static_cast<int>(::getpid()));
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGALRM, SIGPROF}) {
    std::signal(signal, leave_behind);
  }
  const std::vector<Bytes> corpus = read_corpus(options.corpus);
  if (corpus.empty()) {
    std::fprintf(stderr, "no corpus; expected files or folders with inputs\n");
    return 2;
  }
  for (const Bytes& bytes : corpus) run(bytes, options);
  Mutator mutator(corpus, options.seed, options.max_len);
  std::uint64_t inputs = corpus.size();
  for (; processor_time() < options.max_total_time; ++inputs) run(mutator.next(), options);
  std::printf("%llu inputs, %.0f s of processor time, seed %llu: nothing found\n",
              static_cast<unsigned long long>(inputs), processor_time(),
              static_cast<unsigned long long>(options.seed));
  return 0;
}
