# pileus_add_plugin(name SOURCES files…): a loadable operator library lib<name>.so.
#
# The library sees the plugin headers and nothing else of Pileus, exports the entry symbol and
# nothing else, and keeps whatever it links statically to itself: two libraries that carry the same
# C++ symbols must never meet in one process. Works in the source tree and from an installed
# package; the target Pileus::plugin stands for the headers in both.

include_guard()
include(GNUInstallDirs)

set(PILEUS_PLUGIN_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/plugin_exports.map)

if(NOT TARGET Pileus::plugin)
  add_library(pileus_plugin INTERFACE)
  add_library(Pileus::plugin ALIAS pileus_plugin)
  target_compile_features(pileus_plugin INTERFACE cxx_std_20)
  target_include_directories(
    pileus_plugin INTERFACE $<BUILD_INTERFACE:${CMAKE_CURRENT_LIST_DIR}/../include>
                            $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endif()

function(pileus_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "NO_INSTALL" "OUTPUT_DIRECTORY" "SOURCES")
  if(NOT ARG_SOURCES)
    message(FATAL_ERROR "pileus_add_plugin(${name}): SOURCES is missing")
  endif()
  if(NOT ARG_OUTPUT_DIRECTORY)
    set(ARG_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/pileus/plugins)
  endif()
  add_library(${name} MODULE ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE Pileus::plugin)
  if(TARGET pileus_build)
    target_link_libraries(${name} PRIVATE pileus_build)
  endif()
  # Same bits on every machine and with every vector width: no contraction into fused operations.
  # Exception flags and errno are nobody's business; without them comparisons become vector code.
  target_compile_options(${name} PRIVATE -ffp-contract=off -fno-trapping-math -fno-math-errno)
  # The version script makes every symbol but the entry local, "unique" ones of templates included.
  target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL
                      -Wl,--version-script=${PILEUS_PLUGIN_SCRIPT})
  if(NOT PILEUS_SANITIZER)  # the program brings a sanitizer's functions
    target_link_options(${name} PRIVATE -Wl,--no-undefined)
  endif()
  set_target_properties(
    ${name}
    PROPERTIES PREFIX lib
               C_VISIBILITY_PRESET hidden
               CXX_VISIBILITY_PRESET hidden
               VISIBILITY_INLINES_HIDDEN ON
               LINK_DEPENDS ${PILEUS_PLUGIN_SCRIPT}
               LIBRARY_OUTPUT_DIRECTORY ${ARG_OUTPUT_DIRECTORY})
  if(NOT ARG_NO_INSTALL)
    install(TARGETS ${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/pileus/plugins)
  endif()
endfunction()
