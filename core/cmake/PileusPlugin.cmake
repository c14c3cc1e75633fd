# What builds and tests plugins, in the source tree and from an installed package (docs/plugins):
#
#   pileus_add_plugin(name SOURCES files… [EFFECTS rules.yaml])   a library of operators, lib<name>.so
#   pileus_add_scene_test(name scene.yaml)                        a CTest that judges a scene with it
#   pileus_add_conformance_test(name [LEVEL threads])             a CTest that holds it to the contract
#
# The library sees the plugin headers and nothing else of Pileus, exports the entry symbol and
# nothing else, and keeps whatever it links statically to itself: two libraries that carry the same
# C++ symbols must never meet in one process. The target Pileus::plugin stands for the headers in the
# source tree and in the package, Pileus::pileus for the program.

include_guard()
include(GNUInstallDirs)

set(PILEUS_PLUGIN_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/plugin_exports.map)

if(NOT TARGET Pileus::plugin)
  add_library(pileus_plugin INTERFACE)
  add_library(Pileus::plugin ALIAS pileus_plugin)
  target_include_directories(
    pileus_plugin INTERFACE $<BUILD_INTERFACE:${CMAKE_CURRENT_LIST_DIR}/../include>
                            $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endif()

# EFFECTS: rules by which the planner judges the effects that the library brings with it, laid beside
# it as lib<name>.effects.yaml.
function(pileus_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "NO_INSTALL" "OUTPUT_DIRECTORY;EFFECTS" "SOURCES")
  if(NOT ARG_SOURCES)
    message(FATAL_ERROR "pileus_add_plugin(${name}): SOURCES is missing")
  endif()
  if(NOT ARG_OUTPUT_DIRECTORY)
    set(ARG_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/pileus/plugins)
  endif()
  add_library(${name} MODULE ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE Pileus::plugin m)  # C does not bring its mathematics
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
               C_STANDARD 11
               C_EXTENSIONS OFF
               CXX_STANDARD 20
               CXX_STANDARD_REQUIRED ON
               CXX_EXTENSIONS OFF
               C_VISIBILITY_PRESET hidden
               CXX_VISIBILITY_PRESET hidden
               VISIBILITY_INLINES_HIDDEN ON
               LINK_DEPENDS ${PILEUS_PLUGIN_SCRIPT}
               LIBRARY_OUTPUT_DIRECTORY ${ARG_OUTPUT_DIRECTORY})
  if(NOT ARG_NO_INSTALL)
    install(TARGETS ${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/pileus/plugins
                                    COMPONENT program)
  endif()
  if(ARG_EFFECTS)
    set(rules lib${name}.effects.yaml)
    configure_file(${ARG_EFFECTS} ${ARG_OUTPUT_DIRECTORY}/${rules} COPYONLY)
    if(NOT ARG_NO_INSTALL)
      install(FILES ${ARG_OUTPUT_DIRECTORY}/${rules}
              DESTINATION ${CMAKE_INSTALL_LIBDIR}/pileus/plugins COMPONENT program)
    endif()
  endif()
endfunction()

# Where the program is not installed beside the headers there is nothing to run libraries in.
function(pileus_add_program_test library test)
  if(TARGET Pileus::pileus)
    add_test(NAME ${test} COMMAND Pileus::pileus ${ARGN})
    set_tests_properties(
      ${test} PROPERTIES TIMEOUT 600 ENVIRONMENT
                         "PILEUS_PLUGIN_PATH=$<TARGET_FILE_DIR:${library}>;OMP_WAIT_POLICY=passive")
  else()
    message(STATUS "The program pileus is not installed beside this package: no test ${test}")
  endif()
endfunction()

# Runs the scene with the library on the search path and holds it to its `expect` section.
function(pileus_add_scene_test library scene)
  get_filename_component(scene_name ${scene} NAME_WE)
  get_filename_component(path ${scene} ABSOLUTE)
  pileus_add_program_test(${library} ${library}.scene.${scene_name} check --quiet --threads 1 --out
                          ${CMAKE_CURRENT_BINARY_DIR}/scenes/${scene_name} ${path})
endfunction()

# Runs all checks of `pileus conform`. LEVEL says for what the same bits are demanded: `threads`, any
# number of them, is what every plugin has to keep and the only level so far.
function(pileus_add_conformance_test library)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "LEVEL" "")
  if(ARG_UNPARSED_ARGUMENTS OR (ARG_LEVEL AND NOT ARG_LEVEL STREQUAL "threads"))
    message(FATAL_ERROR "pileus_add_conformance_test(${library}): expected nothing or LEVEL threads")
  endif()
  pileus_add_program_test(${library} ${library}.conformance conform $<TARGET_FILE:${library}>)
endfunction()
