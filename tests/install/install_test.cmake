# SPDX-License-Identifier: Apache-2.0
# Installs a built tree into a fresh prefix and builds against it: all headers, and what no page of the docs builds.
#   cmake -D BUILD=<build tree> -D EXAMPLES=<docs/examples> -D WORK=<scratch> -D GENERATOR=<generator>
#         -D COMPILER=<C++ compiler> -D FLAGS=<C++ flags> -P install_test.cmake
# The prefix has a space in its path, and is moved after installing: nothing may remember where it was.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nfailed (${code}):\n${out}")
  endif()
  set(output "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${WORK}")
run(${CMAKE_COMMAND} --install "${BUILD}" --prefix "${WORK}/installed here")
set(prefix "${WORK}/and moved there")
file(RENAME "${WORK}/installed here" "${prefix}")

file(GLOB_RECURSE packages "${prefix}/*.cmake")
foreach(file ${packages})
  file(READ "${file}" text)
  foreach(place "${BUILD}" "${WORK}")
    string(FIND "${text}" "${place}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${file} remembers ${place}")
    endif()
  endforeach()
endforeach()
if(NOT packages)
  message(FATAL_ERROR "no CMake package was installed into ${prefix}")
endif()

# For whoever types the program's name: share/ is the data root, unless CMAKE_INSTALL_DATAROOTDIR says otherwise.
foreach(file bash-completion/completions/prospect zsh/site-functions/_prospect fish/vendor_completions.d/prospect.fish
    man/man1/prospect.1 man/man1/prospect-explore.1)
  if(NOT EXISTS "${prefix}/share/${file}")
    message(FATAL_ERROR "share/${file} was not installed")
  endif()
endforeach()

# Parts of others travel with their licences.
foreach(file LICENSE NOTICE licences/compiled_in.txt licences/dygraphs.txt licences/parts.csv)
  if(NOT EXISTS "${prefix}/share/doc/prospect/${file}")
    message(FATAL_ERROR "share/doc/prospect/${file} was not installed")
  endif()
endforeach()

# The installed headers are complete: a program that includes all of them links every room.
file(GLOB_RECURSE headers RELATIVE "${prefix}/include/prospect" "${prefix}/include/prospect/*.h")
if(NOT "engine/planner/planner.h" IN_LIST headers)
  message(FATAL_ERROR "engine/planner/planner.h was not installed")
endif()
set(source "int main() {}\n")
foreach(header ${headers})
  string(PREPEND source "#include \"${header}\"\n")
endforeach()
file(WRITE "${WORK}/all headers/main.cc" "${source}")
file(WRITE "${WORK}/all headers/CMakeLists.txt" [[
cmake_minimum_required(VERSION 3.25)
project(all_headers CXX)
find_package(prospect CONFIG REQUIRED)
add_executable(all_headers main.cc)
target_link_libraries(all_headers PRIVATE prospect::models prospect::engine prospect::solvers prospect::perception prospect::runtime
  prospect::problem_file prospect::robot)
]])
set(consumer -G ${GENERATOR} "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${COMPILER}"
  "-DCMAKE_CXX_FLAGS=${FLAGS}" "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
run(${CMAKE_COMMAND} -S "${WORK}/all headers" -B "${WORK}/all headers built" ${consumer})
run(${CMAKE_COMMAND} --build "${WORK}/all headers built")

# refused(EXPECTED COMMAND...): bad input, one line that holds EXPECTED.
function(refused expected)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  string(FIND "${err}" "${expected}" at)
  if(NOT code EQUAL 2 OR at EQUAL -1 OR NOT out STREQUAL "" OR NOT err MATCHES "^[^\n]+\n$")
    message(FATAL_ERROR "${ARGN}\nexpected exit code 2 and '${expected}', got ${code}:\n${out}${err}")
  endif()
endfunction()

# Examples that no page of the docs builds as it is written; the others their pages' tests build and run.
foreach(example riccati)
  run(${CMAKE_COMMAND} -S "${EXAMPLES}/${example}" -B "${WORK}/${example} built" ${consumer})
  run(${CMAKE_COMMAND} --build "${WORK}/${example} built")
  run("${WORK}/${example} built/${example}")
  message(STATUS "${example}:\n${output}")
endforeach()

# A problem in C, compiled by the line that the program prints: it finds the library where that was moved to.
run("${prefix}/bin/prospect" explore office --until 5m2 --quiet --save-problems 1 --out "${WORK}/run")
run("${prefix}/bin/prospect" export "${WORK}/run/problems/step_000000.h5" --to c --out "${WORK}/in C")
string(REGEX MATCH "cc [^\n]*" line "${output}")
run(sh -c "${line}")
run(ldd "${WORK}/in C/step_000000.so")
string(FIND "${output}" "libprospect_external.so => ${prefix}/" at)
if(at EQUAL -1)
  message(FATAL_ERROR "'${line}' makes what does not find its library:\n${output}")
endif()

# A plug-in as no page builds it: not optimised.
set(slow "${WORK}/user_term not optimised")
run(${CMAKE_COMMAND} -S "${EXAMPLES}/user_term" -B "${slow}" ${consumer} -DCMAKE_BUILD_TYPE=Debug)
run(${CMAKE_COMMAND} --build "${slow}" --target keep_distance)
run("${prefix}/bin/prospect" list sets --plugin "${slow}/libkeep_distance.so")
if(NOT output MATCHES "was compiled without optimisation and is slow; expected a build of type Release\n")
  message(FATAL_ERROR "a plug-in that is not optimised is not told of:\n${output}")
endif()

# For wide registers, without what the package says of the layout: other alignment of what crosses the border.
cmake_host_system_information(RESULT platform QUERY OS_PLATFORM)
set(wide_flags "-D EIGEN_MAX_ALIGN_BYTES=32")
if(platform STREQUAL "x86_64")
  set(wide_flags -mavx)
endif()
set(wide "${WORK}/plugin for wide registers")
run(${CMAKE_COMMAND} -S "${EXAMPLES}/plugin" -B "${wide}" ${consumer}
  "-DCMAKE_CXX_FLAGS=${FLAGS} ${wide_flags} -D PROSPECT_ANY_LAYOUT")
run(${CMAKE_COMMAND} --build "${wide}")
# Without the frame of Prospect's own names the linker would mix them with the program's.
run(nm -D --defined-only -C "${wide}/libdifferential_evolution.so")
if(output MATCHES "prospect::" OR NOT output MATCHES " T prospect_plugin\n")
  message(FATAL_ERROR "the plug-in shows more than its entry point:\n${output}")
endif()
refused("Eigen's alignment (-m flags) of 32; expected 16" "${prefix}/bin/prospect" list solvers
  --plugin "${wide}/libdifferential_evolution.so")

# And of a later version of Prospect.
file(READ "${EXAMPLES}/plugin/differential_evolution.cc" source)
file(READ "${EXAMPLES}/plugin/CMakeLists.txt" list_file)
set(later "${WORK}/plugin of a later version")
file(READ "${prefix}/include/prospect/models/version.h" text)
string(REGEX REPLACE "[0-9.]+\";" "99.0.0\";" changed "${text}")
if(changed STREQUAL text)
  message(FATAL_ERROR "models/version.h has no version to change")
endif()
file(WRITE "${later}/models/version.h" "${changed}")
file(WRITE "${later}/differential_evolution.cc" "${source}")
file(WRITE "${later}/CMakeLists.txt" "${list_file}"
  "target_include_directories(differential_evolution BEFORE PRIVATE \${CMAKE_CURRENT_SOURCE_DIR})\n")
run(${CMAKE_COMMAND} -S "${later}" -B "${later} built" ${consumer})
run(${CMAKE_COMMAND} --build "${later} built")
refused("was built with Prospect 99.0.0; expected " "${prefix}/bin/prospect" explore office --time-limit 1
  --out "${WORK}/refused" --plugin "${later} built/libdifferential_evolution.so")
if(EXISTS "${WORK}/refused")
  message(FATAL_ERROR "a mission with a plug-in that was refused left a run folder")
endif()
