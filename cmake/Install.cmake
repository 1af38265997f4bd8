# SPDX-License-Identifier: Apache-2.0
# `cmake --install`: the program, and the rooms that another project can link, with
#   find_package(prospect CONFIG REQUIRED)
#   target_link_libraries(controller PRIVATE prospect::engine prospect::solvers)
# The adapters stay inside the program: they are how it meets files and screens. One is a library of
# its own, prospect::problem_file, for those who want to read the problems of a mission. All of it together is
# prospect::robot, a shared library, for programs that drive a robot of their own:
#   find_package(prospect CONFIG REQUIRED COMPONENTS robot)
#   target_link_libraries(controller PRIVATE prospect::robot)
include(CMakePackageConfigHelpers)
install(FILES LICENSE NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY licences DESTINATION ${CMAKE_INSTALL_DOCDIR})
# All that is installed, and the programs that pages of the docs start besides (tests/CMakeLists.txt): what
# scripts/explore leaves.
add_custom_target(product)
set(rooms models engine solvers perception runtime)
foreach(room ${rooms})
  add_dependencies(product prospect_${room})
  install(TARGETS prospect_${room} EXPORT prospect ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY ${room}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/prospect/${room}
    FILES_MATCHING PATTERN *.h)
endforeach()
add_dependencies(product prospect_perception_knobs prospect_runtime_knobs prospect_problem_file)
install(TARGETS prospect_perception_knobs prospect_runtime_knobs EXPORT prospect ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS prospect_problem_file EXPORT prospect ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES adapters/formats/problem_file/problem_file.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/prospect/adapters/formats/problem_file)
add_dependencies(product prospect_robot)
install(TARGETS prospect_robot EXPORT prospect LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES adapters/program/robot/run_robot.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/prospect/adapters/program/robot)
add_dependencies(product prospect_external)
install(TARGETS prospect_external EXPORT prospect LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES adapters/program/external/prospect_external.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/prospect/adapters/program/external)
foreach(target _core _program write_depth_recording write_stereo_recording)
  if(TARGET ${target})
    add_dependencies(product ${target})
  endif()
endforeach()
if(TARGET prospect)
  add_dependencies(product prospect)
  install(TARGETS prospect RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  set(share ${PROJECT_BINARY_DIR}/share)  # written as the program is linked
  install(DIRECTORY ${share}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR})
  foreach(shell bash-completion zsh fish)
    install(DIRECTORY ${share}/${shell} DESTINATION ${CMAKE_INSTALL_DATAROOTDIR})
  endforeach()
endif()

# What whoever links the installed libraries reads before all else: the layout that these are compiled with.
function(prospect_eigen_value name result)
  separate_arguments(flags UNIX_COMMAND "${CMAKE_CXX_FLAGS}")
  get_target_property(folders Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
  list(TRANSFORM folders PREPEND -I)
  file(WRITE ${PROJECT_BINARY_DIR}/layout/asked.cc "#include <Eigen/Core>\nlayout ${name}\n")
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${flags} -std=c++20 ${folders} -E -P ${PROJECT_BINARY_DIR}/layout/asked.cc
    OUTPUT_VARIABLE text ERROR_VARIABLE error)
  if(NOT text MATCHES "layout ([0-9]+)")
    message(FATAL_ERROR "Eigen's ${name} cannot be asked for: ${error}")
  endif()
  set(${result} ${CMAKE_MATCH_1} PARENT_SCOPE)
endfunction()
prospect_eigen_value(EIGEN_MAX_ALIGN_BYTES PROSPECT_EIGEN_MAX_ALIGN)
prospect_eigen_value(EIGEN_MAX_STATIC_ALIGN_BYTES PROSPECT_EIGEN_MAX_STATIC_ALIGN)
configure_file(${PROJECT_SOURCE_DIR}/cmake/compiled_as.h.in ${PROJECT_BINARY_DIR}/layout/compiled_as.h @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/layout/compiled_as.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/prospect/models)
foreach(target prospect_models prospect_robot)
  target_compile_options(${target} INTERFACE
    "$<INSTALL_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:SHELL:-include models/compiled_as.h>>")
endforeach()

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/prospect)
install(EXPORT prospect FILE prospectTargets.cmake NAMESPACE prospect:: DESTINATION ${package})
# A consumer needs the solver libraries that this build has found.
set(PROSPECT_WITH_NLOPT OFF)
if(TARGET NLopt::nlopt)
  set(PROSPECT_WITH_NLOPT ON)
endif()
set(PROSPECT_WITH_IPOPT OFF)
if(TARGET PkgConfig::IPOPT)
  set(PROSPECT_WITH_IPOPT ON)
endif()
set(PROSPECT_WITH_CERES OFF)
if(TARGET Ceres::ceres)
  set(PROSPECT_WITH_CERES ON)
endif()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/prospectConfig.cmake.in
  ${PROJECT_BINARY_DIR}/prospectConfig.cmake INSTALL_DESTINATION ${package})
# What changes works for a version more, and what is gone does not compile: who asks for an older 0.x is served.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/prospectConfigVersion.cmake
  COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/prospectConfig.cmake ${PROJECT_BINARY_DIR}/prospectConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/LibraryTargets.cmake DESTINATION ${package})
