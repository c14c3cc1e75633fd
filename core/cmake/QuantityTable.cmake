# schemas/quantities.yaml as a C++ table in the base library, so that the program needs no data file
# to know its quantities. Run as a script (-P) this file is the generator; included, it adds the
# generated source to pileus_base.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(quantity_table ${CMAKE_CURRENT_BINARY_DIR}/quantity_table.cpp)
  add_custom_command(
    OUTPUT ${quantity_table}
    COMMAND ${CMAKE_COMMAND} -D INPUT=${PROJECT_SOURCE_DIR}/schemas/quantities.yaml -D
            OUTPUT=${quantity_table} -P ${CMAKE_CURRENT_LIST_FILE}
    DEPENDS ${PROJECT_SOURCE_DIR}/schemas/quantities.yaml ${CMAKE_CURRENT_LIST_FILE}
    COMMENT "Compiling schemas/quantities.yaml"
    VERBATIM)
  target_sources(pileus_base PRIVATE ${quantity_table})
  return()
endif()

cmake_minimum_required(VERSION 3.25)
set(keys units symbol definition standard_name carried)
set(rows "")
set(name "")

macro(finish_entry)
  if(name)
    if(NOT DEFINED entry_units OR NOT DEFINED entry_symbol OR NOT DEFINED entry_definition)
      message(FATAL_ERROR "${INPUT}: '${name}' needs units, symbol and definition")
    endif()
    set(carried true)
    if("${entry_carried}" STREQUAL "no")
      set(carried false)
    endif()
    string(APPEND rows "    {\"${name}\", \"${entry_units}\", \"${entry_symbol}\",\n"
                       "     \"${entry_definition}\", \"${entry_standard_name}\", ${carried}},\n")
  endif()
  foreach(key IN LISTS keys)
    unset(entry_${key})
  endforeach()
endmacro()

file(STRINGS ${INPUT} lines)
foreach(line IN LISTS lines)
  if(line MATCHES "^ *#" OR line MATCHES "^ *$")
    continue()
  elseif(line MATCHES "^([a-z][a-z0-9_]*):$")
    set(next ${CMAKE_MATCH_1})
    finish_entry()
    set(name ${next})
  elseif(line MATCHES "^  (units|symbol|definition|standard_name|carried): ([^\"\\]+)$")
    set(entry_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
  else()
    message(FATAL_ERROR "${INPUT}: cannot read the line '${line}'")
  endif()
endforeach()
finish_entry()

file(
  WRITE ${OUTPUT}
  "// Generated from schemas/quantities.yaml.
#include <array>

#include \"base/quantities.hpp\"

namespace pileus {

std::span<const Quantity> quantities() {
  static constexpr auto table = std::to_array<Quantity>({
${rows}  });
  return table;
}

}  // namespace pileus
")
