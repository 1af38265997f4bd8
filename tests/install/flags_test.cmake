# SPDX-License-Identifier: Apache-2.0
# Programs of others, compiled with their own flags against an installed tree: each works as the plain one does, or is
# refused with a line that names the flag. And a component brings nothing but what it needs.
#   cmake -D BUILD=<build tree> -D SOURCE=<tests/install/layout> -D WORK=<scratch> -D GENERATOR=<generator>
#         -D COMPILER=<C++ compiler> -P flags_test.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE "${WORK}")
set(prefix "${WORK}/installed")
execute_process(COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --prefix "${prefix}" RESULT_VARIABLE code
  OUTPUT_VARIABLE out ERROR_VARIABLE out)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "cmake --install: ${out}")
endif()

# build(NAME ARGUMENT...): configures and builds the program; leaves $code and $output, and where it stands in $program.
function(build name)
  set(tree "${WORK}/${name}")
  execute_process(COMMAND ${CMAKE_COMMAND} -S "${SOURCE}" -B "${tree}" -G ${GENERATOR} "-DCMAKE_PREFIX_PATH=${prefix}"
    "-DCMAKE_CXX_COMPILER=${COMPILER}" -DCMAKE_BUILD_TYPE=Release -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
    -DCOMPONENTS=engine -DLIBRARIES=prospect::engine ${ARGN}
    RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(code EQUAL 0)
    execute_process(COMMAND ${CMAKE_COMMAND} --build "${tree}" RESULT_VARIABLE code OUTPUT_VARIABLE output
      ERROR_VARIABLE output)
  endif()
  set(code ${code} PARENT_SCOPE)
  set(output "${output}" PARENT_SCOPE)
  set(program "${tree}/layout" PARENT_SCOPE)
endfunction()

function(works name)
  build("${name}" ${ARGN})
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${name}: ${output}")
  endif()
  execute_process(COMMAND "${program}" RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${name} ends with ${code}: ${said}")
  endif()
  if(NOT DEFINED plain)
    set(plain "${said}" PARENT_SCOPE)
    set(plain "${said}")
  endif()
  if(NOT said STREQUAL plain)
    message(FATAL_ERROR "${name} sees other types:\n${said}\nthan the plain program:\n${plain}")
  endif()
  message(STATUS "${name}: works")
  set(program "${program}" PARENT_SCOPE)
endfunction()

function(refused name expected)
  build("${name}" ${ARGN})
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  string(FIND "${output}" "${expected}" at)
  if(code EQUAL 0 OR at EQUAL -1)
    message(FATAL_ERROR "${name}: expected a refusal with '${expected}', got ${code}: ${output}")
  endif()
  message(STATUS "${name}: refused")
endfunction()

# Nothing of perception, back ends, files or transports is looked for, found or loaded.
set(alone "")
foreach(package OpenCV NLopt Ceres PkgConfig HDF5 CycloneDDS Boost)
  list(APPEND alone -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
works("plain" ${alone} -DASKED=0.1)
if(NOT plain MATCHES "Belief [0-9]+ 16\n" OR NOT plain MATCHES "4: [0-9.]+ '[^']+'")
  message(FATAL_ERROR "the program tells something else:\n${plain}")
endif()
execute_process(COMMAND ldd "${program}" OUTPUT_VARIABLE loaded)
if(NOT loaded MATCHES "libstdc" OR loaded MATCHES "opencv|hdf5|ddsc|nlopt|ipopt|cholmod|crypto")
  message(FATAL_ERROR "who links prospect::engine loads:\n${loaded}")
endif()
refused("a later version" "compatible with requested version" -DASKED=0.99)
refused("no such component" "no component 'engin'; expected models, engine" -DCOMPONENTS=engin -DLIBRARIES=prospect::engine)
refused("a component without its library" "package for module PkgConfig" -DCOMPONENTS=problem_file -DLIBRARIES=prospect::problem_file
  -DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig=ON)

# Flags that matter. Wide registers would align Eigen's matrices otherwise.
cmake_host_system_information(RESULT platform QUERY OS_PLATFORM)
if(platform STREQUAL "x86_64")
  works("wide registers" -DCMAKE_CXX_FLAGS=-mavx)
endif()
works("this machine" -DCMAKE_CXX_FLAGS=-march=native)
works("not optimised" -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=-O0 -g0")
works("checked" -DCMAKE_CXX_FLAGS=-D_GLIBCXX_ASSERTIONS)
works("newer" -DCMAKE_CXX_STANDARD=23)
works("at link time" -DCMAKE_INTERPROCEDURAL_OPTIMIZATION=ON)
works("shared" -DCOMPONENTS=robot -DLIBRARIES=prospect::robot)
works("packages in another order" -DCOMPONENTS=solvers -DLIBRARIES=prospect::solvers
  -DCMAKE_FIND_PACKAGE_SORT_ORDER=NAME -DCMAKE_FIND_PACKAGE_SORT_DIRECTION=DEC)
find_program(CLANG clang++)
if(CLANG)
  works("clang" -DCMAKE_CXX_COMPILER=${CLANG} -DCMAKE_CXX_FLAGS=-march=native)
else()
  message(STATUS "clang: skipped: there is no clang++")
endif()
refused("debug containers" "CMAKE_CXX_FLAGS has -D_GLIBCXX_DEBUG" -DCMAKE_CXX_FLAGS=-D_GLIBCXX_DEBUG)
refused("debug containers of one target" "_GLIBCXX_DEBUG: its containers have another layout"
  -DDEFINITIONS=_GLIBCXX_DEBUG)
refused("old strings" "expected 1" -DDEFINITIONS=_GLIBCXX_USE_CXX11_ABI=0)
refused("rows" "EIGEN_DEFAULT_TO_ROW_MAJOR" -DDEFINITIONS=EIGEN_DEFAULT_TO_ROW_MAJOR)
refused("other alignment" "EIGEN_MAX_ALIGN_BYTES: Prospect's libraries are compiled with 16"
  -DDEFINITIONS=EIGEN_MAX_ALIGN_BYTES=32)
# Without that it would not be seen: what the check is for.
build("unchecked" "-DCMAKE_CXX_FLAGS=-mavx -D PROSPECT_ANY_LAYOUT")
if(platform STREQUAL "x86_64" AND code EQUAL 0)
  execute_process(COMMAND "${program}" OUTPUT_VARIABLE said)
  if(said STREQUAL plain)
    message(FATAL_ERROR "wide registers change no layout here: the test tests nothing")
  endif()
endif()

# An older Eigen than the libraries were compiled with.
file(WRITE "${WORK}/eigen/Eigen3Config.cmake" "add_library(Eigen3::Eigen INTERFACE IMPORTED)\n")
file(WRITE "${WORK}/eigen/Eigen3ConfigVersion.cmake" "set(PACKAGE_VERSION 3.3.9)\n")
find_program(MAKE_PROGRAM NAMES ninja make)
refused("Eigen 3.3" "version: 3.3.9" "-DEigen3_ROOT=${WORK}/eigen" -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF
  -DCMAKE_FIND_USE_SYSTEM_ENVIRONMENT_PATH=OFF "-DCMAKE_MAKE_PROGRAM=${MAKE_PROGRAM}")
message(STATUS "flags: all checks pass")
