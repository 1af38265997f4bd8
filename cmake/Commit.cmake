# SPDX-License-Identifier: Apache-2.0
# At every build: writes OUTPUT, which defines the functions of adapters/program/cli/commit.h, for the git work tree
# SOURCE; only if it changes, so nothing is compiled for a commit that is the same. A source tree
# without git has no commit.
set(commit "")
set(changed false)
find_program(GIT git)
if(GIT AND EXISTS "${SOURCE}/.git")  # not the repository of a folder above
  execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse HEAD OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE
    ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    set(commit "")
  else()
    execute_process(COMMAND ${GIT} --no-optional-locks -C ${SOURCE} status --porcelain --untracked-files=no
      OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      set(changed true)
    endif()
  endif()
endif()
set(text "#include \"adapters/program/cli/commit.h\"

namespace prospect {

std::string_view commit() { return \"${commit}\"; }
bool commit_changed() { return ${changed}; }

}  // namespace prospect
")
set(before "")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" before)
endif()
if(NOT text STREQUAL before)
  file(WRITE "${OUTPUT}" "${text}")
endif()
