# Compiles what --version prints into the target `base` links. Included twice: by core/CMakeLists
# to set the rule up, and as a script (cmake -P) at every build to look at the commit, because a
# commit made after configuring must still end up in the files a run writes.

if(CMAKE_SCRIPT_MODE_FILE)
  set(commit unknown)
  find_program(GIT git)
  if(GIT AND EXISTS ${SOURCE_DIR}/.git)
    execute_process(COMMAND ${GIT} describe --always --abbrev=40 --exclude=* --dirty=-modified
                    WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE described
                    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed)
      set(commit ${described})
    endif()
  endif()
  # Written only when it differs, so that an unchanged commit rebuilds nothing.
  file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#define PILEUS_COMMIT \"${commit}\"\n")
  return()
endif()

function(pileus_add_version_record)
  set(folder ${CMAKE_BINARY_DIR}/generated/version)
  set(library_rows "")
  foreach(pair ${ARGN})
    string(REPLACE "=" "\", \"" row ${pair})
    string(APPEND library_rows "    {\"${row}\"},\n")
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/core/cmake/version.cpp.in ${folder}/version.cpp @ONLY)
  add_custom_target(
    pileus_commit
    COMMAND ${CMAKE_COMMAND} -D SOURCE_DIR=${PROJECT_SOURCE_DIR} -D OUTPUT=${folder}/commit.h -P
            ${PROJECT_SOURCE_DIR}/core/cmake/PileusVersion.cmake
    BYPRODUCTS ${folder}/commit.h)
  add_library(pileus_version STATIC ${folder}/version.cpp)
  add_dependencies(pileus_version pileus_commit)
  target_include_directories(pileus_version PRIVATE ${folder} ${PROJECT_SOURCE_DIR}/core/src)
  target_link_libraries(pileus_version PRIVATE pileus_build)
endfunction()
