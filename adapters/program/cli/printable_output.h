// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <memory>

namespace prospect {

/// While it lives, all that this program writes to standard output and standard error, by streams
/// or by printf, goes through PrintableText: no name of a file and no text from one reaches a
/// terminal raw, wherever it is printed. ProgressLine, which draws, writes past it. One at a time,
/// made and destroyed in the main thread.
class PrintableOutput {
 public:
  PrintableOutput();
  ~PrintableOutput();
  PrintableOutput(const PrintableOutput&) = delete;
  PrintableOutput& operator=(const PrintableOutput&) = delete;

 private:
  struct Stream;
  std::unique_ptr<Stream> output_, errors_;
};

}  // namespace prospect
