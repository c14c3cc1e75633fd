# Texts that plugin authors are given, compiled into the authoring library so that the program needs
# no data files for them: the projects that `pileus new-plugin` writes (core/templates) and the headers
# whose words `pileus schema plugin --reference` explains. Run as a script (-P) this file is the generator;
# included, it adds the generated source to pileus_authoring.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(embedded_texts ${CMAKE_CURRENT_BINARY_DIR}/embedded_texts.cpp)
  file(GLOB template_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/templates/*/*)
  set(headers ${CMAKE_CURRENT_SOURCE_DIR}/include/pileus)
  add_custom_command(
    OUTPUT ${embedded_texts}
    COMMAND
      ${CMAKE_COMMAND} -D TEMPLATES=${CMAKE_CURRENT_SOURCE_DIR}/templates -D HEADERS=${headers}
      -D OUTPUT=${embedded_texts} -P ${CMAKE_CURRENT_LIST_FILE}
    DEPENDS ${template_files} ${headers}/abi.h ${headers}/declaration.hpp ${CMAKE_CURRENT_LIST_FILE}
    COMMENT "Embedding core/templates and headers"
    VERBATIM)
  target_sources(pileus_authoring PRIVATE ${embedded_texts})
  return()
endif()

cmake_minimum_required(VERSION 3.25)
file(GLOB files RELATIVE ${TEMPLATES} ${TEMPLATES}/*/*)
set(rows "")
foreach(file ${files})
  get_filename_component(kind ${file} DIRECTORY)
  get_filename_component(name ${file} NAME)
  file(READ ${TEMPLATES}/${file} text)
  string(APPEND rows "      {\"${kind}\", \"${name}\", R\"text(${text})text\"},\n")
endforeach()
file(READ ${HEADERS}/abi.h interface)
file(READ ${HEADERS}/declaration.hpp declaration)
file(
  WRITE ${OUTPUT}
  "// Generated from core/templates and core/include/pileus.
#include <array>

#include \"authoring/embedded_texts.hpp\"

namespace pileus::authoring {

std::span<const TemplateFile> template_files() {
  static constexpr auto files = std::to_array<TemplateFile>({
${rows}  });
  return files;
}

std::string_view interface_text() {
  return R\"text(${interface})text\";
}

std::string_view declaration_text() {
  return R\"text(${declaration})text\";
}

}  // namespace pileus::authoring
")
