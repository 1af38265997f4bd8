// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

/// Exit codes of the program.
enum ExitCode {
  kDone = 0,        ///< done
  kFailed = 1,      ///< the mission or comparison failed; it says why
  kBadInput = 2,    ///< a file, configuration or argument is wrong; one line each says what
  kNotBuiltIn = 3,  ///< a back end or component is not built in
  kCancelled = 4    ///< a signal ended it before all was done; what it has written is whole
};

}  // namespace prospect
