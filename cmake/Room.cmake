# SPDX-License-Identifier: Apache-2.0
# prospect_room(NAME): the static library of the room in the current folder, target prospect::NAME,
# from every .cc below it (except under folders given after EXCEPT), compiled several as one unless
# FILE_BY_FILE (see prospect_unity). QUICK_BUILD: see prospect_quick_build.
function(prospect_room name)
  cmake_parse_arguments(ARG "FILE_BY_FILE;KNOBS;QUICK_BUILD" "" "EXCEPT" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  foreach(folder ${ARG_EXCEPT})
    list(FILTER sources EXCLUDE REGEX "${CMAKE_CURRENT_SOURCE_DIR}/${folder}/")
  endforeach()
  # KNOBS: descriptions of options, CONCEPT_knobs.cc, are a library of their own, prospect::NAME_knobs: who
  # reads a configuration builds nothing that acts on it.
  if(ARG_KNOBS)
    set(knobs ${sources})
    list(FILTER knobs INCLUDE REGEX "_knobs\\.cc$")
    list(REMOVE_ITEM sources ${knobs})
    add_library(prospect_${name}_knobs STATIC ${knobs})
    prospect_flags(prospect_${name}_knobs)
    add_library(prospect::${name}_knobs ALIAS prospect_${name}_knobs)
    set_target_properties(prospect_${name}_knobs PROPERTIES EXPORT_NAME ${name}_knobs)
    target_link_libraries(prospect_${name}_knobs PUBLIC prospect::engine)
    prospect_unity(prospect_${name}_knobs)
    prospect_precompile(prospect_${name}_knobs)
  endif()
  add_library(prospect_${name} STATIC ${sources})
  if(ARG_KNOBS)
    target_link_libraries(prospect_${name} PUBLIC prospect::${name}_knobs)
  endif()
  prospect_flags(prospect_${name})
  if(ARG_QUICK_BUILD)
    prospect_quick_build(prospect_${name})
  endif()
  add_library(prospect::${name} ALIAS prospect_${name})
  set_target_properties(prospect_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(prospect_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/prospect>)
  target_compile_features(prospect_${name} PUBLIC cxx_std_20)
  if(NOT ARG_FILE_BY_FILE)
    prospect_unity(prospect_${name})
  endif()
  prospect_precompile(prospect_${name})
endfunction()

# Eigen and the standard library are read once for all targets that have the same flags. Only a
# saving of time: every file includes what it uses of them, which tests/architecture checks
# (precompiled_includes_test.cc), as do the builds without them (presets dev, asan, tsan).
set(PROSPECT_PRECOMPILED_HEADERS <Eigen/Dense> <algorithm> <array> <charconv> <chrono> <filesystem> <fstream> <functional>
  <iostream> <map> <memory> <numbers> <numeric> <optional> <random> <set> <sstream> <string> <thread> <tuple> <unordered_map>
  <variant> <vector>)
function(prospect_precompile target)
  # Programs are position-independent in another way than libraries: they have a header of their own. So have
  # those that are optimised less: g++ takes the optimisation from the header, whatever its command says.
  get_target_property(type ${target} TYPE)
  get_target_property(quick ${target} PROSPECT_QUICK_BUILD)
  set(first prospect_models)
  if(type STREQUAL "EXECUTABLE")
    set(first prospect)
  elseif(quick)
    set(first prospect_files)
  endif()
  if(TARGET ${first} AND NOT target STREQUAL first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    target_precompile_headers(${target} PRIVATE ${PROSPECT_PRECOMPILED_HEADERS})
  endif()
endfunction()

# For what takes longer to compile than it ever runs, tests and what reads and writes text: less optimisation saves a
# third of the time to compile, under sanitizers a seventh. (At -O0 tests would run half as long again: the linker
# takes Eigen's functions that are not inlined from them for the rooms, too.) After prospect_flags, before
# prospect_precompile.
function(prospect_quick_build target)
  set_target_properties(${target} PROPERTIES PROSPECT_QUICK_BUILD ON)
  if(PROSPECT_SANITIZE)
    target_compile_options(${target} PRIVATE -Og)
  endif()
  # At -O1 g++ 12 warns falsely of operator+ of strings, here or there with the length of a path.
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-O1;-Wno-array-bounds;-Wno-restrict;-Wno-stringop-overflow>")
endfunction()

# Warnings, sanitizers and reproducible arithmetic, for our own targets only. -ffp-contract=off keeps
# results identical between builds for machines with and without fused multiply-add.
function(prospect_flags target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -ffp-contract=off -fno-math-errno)
  # g++ collects its garbage at 128 MB, which Eigen reaches soon: a tenth of the time of a build.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE "SHELL:--param ggc-min-expand=300" "SHELL:--param ggc-min-heapsize=524288")
  endif()
  if(PROSPECT_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  # Coverage, by which libFuzzer chooses its next input.
  if(PROSPECT_BUILD_FUZZERS AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
    target_link_options(${target} PUBLIC -fsanitize=fuzzer-no-link)
  endif()
  if(PROSPECT_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${PROSPECT_SANITIZE} -fno-omit-frame-pointer
      -fno-sanitize-recover=undefined)
    # Checks at every access, nearly half of the time to compile: what they find AddressSanitizer finds as
    # well, but for alignment, which Eigen asserts itself.
    if(PROSPECT_SANITIZE MATCHES "address.*undefined")
      target_compile_options(${target} PRIVATE -fno-sanitize=null,alignment,object-size,pointer-overflow,vptr)
    endif()
    # A third of the time to compile, as Eigen's expressions are all temporaries. -Wdangling-pointer, in
    # -Wall, sees what is used after its scope within a function.
    if(PROSPECT_SANITIZE MATCHES "address")
      target_compile_options(${target} PRIVATE -fno-sanitize-address-use-after-scope)
    endif()
    # No sanitizer here sees a value that nobody has set. Eigen's own are not a number until somebody does.
    target_compile_definitions(${target} PRIVATE EIGEN_INITIALIZE_MATRICES_BY_NAN)
    # Under AddressSanitizer Eigen aligns by hand what it allocates: other memory than objects of a release expect.
    if(PROSPECT_TEST_OBJECTS)
      target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
    endif()
    target_link_options(${target} PUBLIC -fsanitize=${PROSPECT_SANITIZE})
  endif()
endfunction()

# Much of the time that a file takes to compile goes into what it includes, so several are compiled as one.
# (Names in unnamed namespaces are therefore unique in their room.) Not so a room full of Eigen's
# expressions, FILE_BY_FILE: the time g++ takes grows faster than the number of their types in one unit. The
# presets dev, asan and tsan do without.
option(PROSPECT_UNITY_ROOMS "Compile several files of a room as one" ON)
set(CMAKE_UNITY_BUILD_BATCH_SIZE 16)
function(prospect_unity target)
  if(PROSPECT_UNITY_ROOMS)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON)
    # Of several files compiled as one, g++ takes all but the first for headers.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
endfunction()
