# SPDX-License-Identifier: Apache-2.0
# prospect_embed(TARGET NAMESPACE name=file...): compiles the bytes of each file into TARGET; of several, name=A|B,
# one behind the other, such as the licence of a library before it. Each
# becomes a function `std::string_view NAME();` in namespace prospect::NAMESPACE, which a header of
# the target declares.
function(prospect_embed target namespace)
  set(files)
  foreach(entry ${ARGN})
    string(REGEX REPLACE "^[^=]*=" "" file "${entry}")
    string(REPLACE "|" ";" file "${file}")
    list(APPEND files ${file})
  endforeach()
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${namespace}.cc)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -D NAMESPACE=${namespace} -D OUTPUT=${output} -D "ENTRIES=${ARGN}"
      -P ${PROJECT_SOURCE_DIR}/cmake/Embed.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/Embed.cmake
    COMMENT "Embedding ${namespace}" VERBATIM)
  set_source_files_properties(${output} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${target} PRIVATE ${output})
endfunction()

# Run as a script, at build time.
if(CMAKE_SCRIPT_MODE_FILE)
  set(source "#include <string_view>\n\nnamespace prospect::${NAMESPACE} {\n")
  foreach(entry ${ENTRIES})
    string(REGEX MATCH "^[^=]*" name "${entry}")
    string(REGEX REPLACE "^[^=]*=" "" file "${entry}")
    string(REPLACE "|" ";" parts "${file}")
    set(hex "")
    foreach(part ${parts})
      file(READ "${part}" text HEX)
      string(APPEND hex ${text})
    endforeach()
    string(REGEX REPLACE "(................................)" "\\1\n" hex "${hex}")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," hex "${hex}")
    string(APPEND source "\nstd::string_view ${name}();\nstd::string_view ${name}() {\n"
      "  static const unsigned char bytes[] = {\n${hex}0};\n"
      "  return {reinterpret_cast<const char*>(bytes), sizeof bytes - 1};\n}\n")
  endforeach()
  string(APPEND source "\n}  // namespace prospect::${NAMESPACE}\n")
  file(WRITE "${OUTPUT}" "${source}")
endif()
