# SPDX-License-Identifier: Apache-2.0
# Third-party libraries, as Debian ships them. A back end whose library is absent is left out with a
# message; everything else is required.
# NLopt for C++ alone (nlopt_cxx/) calls itself NLopt, too: not whichever of the two a disk lists first.
set(CMAKE_FIND_PACKAGE_SORT_ORDER NAME)
set(CMAKE_FIND_PACKAGE_SORT_DIRECTION ASC)
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 CONFIG REQUIRED)
find_package(octomap CONFIG REQUIRED)
find_package(fcl CONFIG REQUIRED)
find_package(yaml-cpp CONFIG REQUIRED)
find_package(CLI11 CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
# Debian's builds of these join parts under the GPL, CPL, CeCILL-C and LGPL: NOTICE, scripts/licences.
# GPL leaves out Ipopt alone: its CPL lets nobody hand on a program that is under the GPL, too.
set(PROSPECT_COPYLEFT ON CACHE STRING
  "Parts under copyleft. ON: NLopt, Ceres, OpenCV's codecs of images and Ipopt; GPL: without Ipopt; OFF: none")
if(NOT PROSPECT_COPYLEFT MATCHES "^(ON|GPL|OFF)$")
  message(FATAL_ERROR "PROSPECT_COPYLEFT: '${PROSPECT_COPYLEFT}'; expected ON, GPL or OFF")
endif()
if(NOT PROSPECT_COPYLEFT STREQUAL "OFF")
  find_package(NLopt CONFIG QUIET)
  if(PROSPECT_COPYLEFT STREQUAL "ON")
    pkg_check_modules(IPOPT QUIET IMPORTED_TARGET ipopt)
  endif()
  set(CMAKE_MESSAGE_LOG_LEVEL NOTICE)  # its SuiteSparse module reports every library it looks at
  find_package(Ceres CONFIG QUIET)
  unset(CMAKE_MESSAGE_LOG_LEVEL)
endif()
# What pictures of the world need: without it the simulator has no camera tier, and says so.
find_package(embree 3 CONFIG QUIET)
# What mesh files need: without them such worlds are refused, and say so.
find_package(assimp CONFIG QUIET)
pkg_check_modules(TINYXML2 QUIET IMPORTED_TARGET tinyxml2)
# What bags of ROS 2 need: without them such recordings are refused, and say so.
find_package(ZLIB REQUIRED)
pkg_check_modules(LZ4 QUIET IMPORTED_TARGET liblz4)
pkg_check_modules(ZSTD QUIET IMPORTED_TARGET libzstd)
pkg_check_modules(SQLITE QUIET IMPORTED_TARGET sqlite3)
# What the transport of Gazebo needs: without it such a robot cannot be driven, and it says so.
find_package(Protobuf QUIET)
# What topics of ROS 2 need: without it such a robot cannot be driven, and it says so.
find_package(CycloneDDS CONFIG QUIET)
find_package(OpenSSL QUIET COMPONENTS Crypto)
# Another vendor of it, the other side in tests and measurements.
find_package(fastrtps CONFIG QUIET)
find_package(fastcdr CONFIG QUIET)
# What the live view needs: without it --live is refused, and says so.
find_package(Boost 1.74 CONFIG QUIET)
# What the Python package needs: without it it is left out. Debian's interpreter, not another one that
# happens to be first in PATH: Debian's packages belong to it.
if(NOT DEFINED Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python QUIET COMPONENTS Interpreter Development.Module)
find_package(pybind11 CONFIG QUIET)
pkg_check_modules(HDF5 REQUIRED IMPORTED_TARGET hdf5)

# Debian's OpenCV module packages ship neither a CMake configuration nor a pkg-config file.
find_path(PROSPECT_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(module core imgproc imgcodecs features2d calib3d)
  find_library(PROSPECT_OPENCV_${module} opencv_${module} REQUIRED)
  add_library(opencv_${module} UNKNOWN IMPORTED)
  set_target_properties(opencv_${module} PROPERTIES
    IMPORTED_LOCATION ${PROSPECT_OPENCV_${module}}
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${PROSPECT_OPENCV_INCLUDE}
    INTERFACE_INCLUDE_DIRECTORIES ${PROSPECT_OPENCV_INCLUDE})
endforeach()

include(${CMAKE_CURRENT_LIST_DIR}/LibraryTargets.cmake)
