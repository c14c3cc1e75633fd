# The layout of the contract and the values of its words, as C and C++ compilers see them, against the
# record of interface 1 (compare_layout.py says what may be added to it).
set(contract ${PROJECT_SOURCE_DIR}/core/include/pileus/abi.h
             ${PROJECT_SOURCE_DIR}/core/include/pileus/selftest.h)
set(layout_folder ${CMAKE_CURRENT_BINARY_DIR}/layout)
add_custom_command(
  OUTPUT ${layout_folder}/layout.inc
  COMMAND ${PILEUS_PYTHON} -B ${CMAKE_CURRENT_SOURCE_DIR}/header.py layout
          ${layout_folder}/layout.inc ${contract}
  DEPENDS header.py ${contract}
  VERBATIM)
add_custom_target(abi_layout_lines DEPENDS ${layout_folder}/layout.inc)

function(pileus_add_layout_test name program)
  add_test(NAME abi.layout_${name}
           COMMAND ${PILEUS_PYTHON} -B ${CMAKE_CURRENT_SOURCE_DIR}/compare_layout.py
                   ${CMAKE_CURRENT_SOURCE_DIR}/layout_v1.txt ${program})
  set_tests_properties(abi.layout_${name} PROPERTIES LABELS "abi")
endfunction()

# Padding at a table's end would hide a member that the next minor appends there.
set(no_padding -Wpadded -Werror=padded)
foreach(language c cpp)
  set(program abi_layout_${language})
  add_executable(${program} layout.${language})
  add_dependencies(${program} abi_layout_lines)
  target_include_directories(${program} PRIVATE ${layout_folder})
  target_compile_options(${program} PRIVATE ${no_padding})
  target_link_libraries(${program} PRIVATE Pileus::plugin pileus_build)
  pileus_add_layout_test(${language} $<TARGET_FILE:${program}>)
endforeach()

# The other compiler, where there is one.
find_program(PILEUS_CLANG clang)
if(PILEUS_CLANG AND NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
  foreach(language c cpp)
    set(standard c11)
    if(language STREQUAL cpp)
      set(standard c++20)
    endif()
    set(program ${layout_folder}/clang_${language})
    add_custom_command(
      OUTPUT ${program}
      COMMAND
        ${PILEUS_CLANG} -std=${standard} -Wall -Wextra -Wpedantic ${no_padding} -I ${layout_folder}
        -I ${PROJECT_SOURCE_DIR}/core/include ${CMAKE_CURRENT_SOURCE_DIR}/layout.${language} -o
        ${program}
      DEPENDS ${layout_folder}/layout.inc layout.${language} print_layout.h ${contract}
      VERBATIM)
    add_custom_target(abi_layout_clang_${language} ALL DEPENDS ${program})
    pileus_add_layout_test(clang_${language} ${program})
  endforeach()
endif()
