# SPDX-License-Identifier: Apache-2.0
# Targets for libraries that export plain names and variables instead. Used by the build and, from
# the installed prospectConfig.cmake, by consumers: nothing of the machine that built is kept.
if(NOT TARGET prospect_octomap)
  add_library(prospect_octomap INTERFACE IMPORTED)
  set_target_properties(prospect_octomap PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${OCTOMAP_INCLUDE_DIRS}"
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${OCTOMAP_INCLUDE_DIRS}"
    INTERFACE_LINK_LIBRARIES "${OCTOMAP_LIBRARIES}")
endif()
if(NOT TARGET prospect_fcl)
  add_library(prospect_fcl INTERFACE IMPORTED)
  set_target_properties(prospect_fcl PROPERTIES INTERFACE_LINK_LIBRARIES "fcl;prospect_octomap")
endif()
