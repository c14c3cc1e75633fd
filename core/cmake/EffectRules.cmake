# schemas/effects.yaml as a text in the planner library, so that the program needs no data file to
# plan a scene, and a mistake in a rule is reported with the line it stands on. Run as a script (-P)
# this file is the generator; included, it adds the generated source to pileus_planner.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(effect_rules ${CMAKE_CURRENT_BINARY_DIR}/effect_rules_text.cpp)
  add_custom_command(
    OUTPUT ${effect_rules}
    COMMAND ${CMAKE_COMMAND} -D INPUT=${PROJECT_SOURCE_DIR}/schemas/effects.yaml -D
            OUTPUT=${effect_rules} -P ${CMAKE_CURRENT_LIST_FILE}
    DEPENDS ${PROJECT_SOURCE_DIR}/schemas/effects.yaml ${CMAKE_CURRENT_LIST_FILE}
    COMMENT "Embedding schemas/effects.yaml"
    VERBATIM)
  target_sources(pileus_planner PRIVATE ${effect_rules})
  return()
endif()

cmake_minimum_required(VERSION 3.25)
file(READ ${INPUT} text)
file(
  WRITE ${OUTPUT}
  "// Generated from schemas/effects.yaml.
#include \"planner/rules.hpp\"

namespace pileus::planner {

std::string_view built_in_rules_text() {
  return R\"rules(${text})rules\";
}

}  // namespace pileus::planner
")
