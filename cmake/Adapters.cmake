# SPDX-License-Identifier: Apache-2.0
# The table of `prospect list adapters`: what a build may lack. A row: name|what it does|what it needs; each
# need is a target of CMake and the package of Debian that brings it, TARGET=PACKAGE, separated by commas. An
# adapter is built in where all its targets are found. A row may end with |modules of the Python package: they are
# no part of the program, which looks for them.
set(prospect_adapter_rows
  "gazebo|drives a robot in Gazebo 11: prospect drive --base gazebo|protobuf::libprotobuf=libprotobuf-dev,protobuf::protoc=protobuf-compiler"
  "dds|drives a robot behind topics of ROS 2: prospect drive --base dds|CycloneDDS::ddsc=cyclonedds-dev,OpenSSL::Crypto=libssl-dev"
  "live|a mission in the browser, live: prospect explore or drive --live PORT|Boost::headers=libboost-dev"
  "cameras|images of the simulator's robot: prospect explore --sensors camera|embree=libembree-dev"
  "meshes|worlds from mesh files|assimp::assimp=libassimp-dev,PkgConfig::TINYXML2=libtinyxml2-dev"
  "python|the package for Python: import prospect|Python::Module=python3-dev,pybind11::module=pybind11-dev|_core _program"
  "lz4|bags of ROS that are compressed by LZ4|PkgConfig::LZ4=liblz4-dev"
  "zstd|bags of ROS that are compressed by Zstandard|PkgConfig::ZSTD=libzstd-dev"
  "sqlite|bags of ROS 2 in SQLite|PkgConfig::SQLITE=libsqlite3-dev")

# prospect_adapter_table(TARGET): adds to TARGET the definitions of adapters/program/cli/adapter_table.h that the build
# writes. After the folder of the Python package.
function(prospect_adapter_table target)
  set(PROSPECT_ADAPTERS "")
  foreach(row IN LISTS prospect_adapter_rows)
    string(REPLACE "|" ";" row "${row}")
    list(POP_FRONT row name does needs modules)
    string(REPLACE "," ";" needs "${needs}")
    set(all "")
    set(missing "")
    foreach(need IN LISTS needs)
      string(REPLACE "=" ";" need "${need}")
      list(POP_FRONT need found package)
      list(APPEND all ${package})
      if(NOT TARGET ${found})
        list(APPEND missing ${package})
      endif()
    endforeach()
    list(JOIN all " " all)
    list(JOIN missing " " missing)
    string(APPEND PROSPECT_ADAPTERS "    {\"${name}\", \"${does}\", \"${all}\", \"${missing}\", \"${modules}\"},\n")
  endforeach()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/adapter_table.cc)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/adapter_table.cc.in ${source} @ONLY)
  target_sources(${target} PRIVATE ${source})
endfunction()
