# SPDX-License-Identifier: Apache-2.0
# prospect_build_versions(TARGET): adds to TARGET the definitions of adapters/program/cli/build_versions.h: what compiles
# it, and the libraries that this build has found.
function(prospect_build_versions target)
  set(PROSPECT_COMPILER "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}")
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  # Of the engine, which computes; less what decides about warnings and the compiler's own memory, which change no bit.
  get_target_property(options prospect_engine COMPILE_OPTIONS)
  list(FILTER options EXCLUDE REGEX "^-W|ggc-min")
  if(options MATCHES "\\$<")
    message(FATAL_ERROR "prospect_engine is compiled with '${options}': a generator expression cannot be reported as flags")
  endif()
  list(JOIN options " " options)
  set(flags "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}} ${options}")
  # Names of folders in what is compiled: whoever builds the same elsewhere gets the same bytes.
  string(REGEX REPLACE "-f[a-z]+-prefix-map=[^ ]*" "" flags "${flags}")
  string(STRIP "${flags}" PROSPECT_COMPILER_FLAGS)
  file(STRINGS ${PROSPECT_OPENCV_INCLUDE}/opencv2/core/version.hpp opencv REGEX "#define CV_VERSION_(MAJOR|MINOR|REVISION)")
  string(REGEX REPLACE "#define CV_VERSION_[A-Z]+ +" "" opencv "${opencv}")
  string(REPLACE ";" "." opencv "${opencv}")
  set(PROSPECT_BUILT_WITH "")
  foreach(library "Eigen|${Eigen3_VERSION}|" "OctoMap|${octomap_VERSION}|liboctomap.so" "FCL|${fcl_VERSION}|libfcl.so"
      "NLopt|${NLopt_VERSION}|libnlopt|NLopt::nlopt" "Ipopt|${IPOPT_VERSION}|libipopt.so|PkgConfig::IPOPT"
      "Ceres|${Ceres_VERSION}|libceres.so|Ceres::ceres" "OpenCV|${opencv}|libopencv_core.so" "HDF5|${HDF5_VERSION}|libhdf5"
      "yaml-cpp|${yaml-cpp_VERSION}|libyaml-cpp.so" "Embree|${embree_VERSION}|libembree|embree"
      "Assimp|${assimp_VERSION}|libassimp.so|assimp::assimp"
      "LZ4|${LZ4_VERSION}|liblz4.so|PkgConfig::LZ4" "Zstandard|${ZSTD_VERSION}|libzstd.so|PkgConfig::ZSTD"
      "SQLite|${SQLITE_VERSION}|libsqlite3.so|PkgConfig::SQLITE")
    string(REPLACE "|" ";" library "${library}")
    list(POP_FRONT library name version file needs)
    if(NOT needs OR TARGET ${needs})
      string(APPEND PROSPECT_BUILT_WITH "    {\"${name}\", \"${version}\", \"${file}\"},\n")
    endif()
  endforeach()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/build_versions.cc)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/build_versions.cc.in ${source} @ONLY)
  target_sources(${target} PRIVATE ${source})
endfunction()
