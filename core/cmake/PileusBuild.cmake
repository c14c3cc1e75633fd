# Compiler settings shared by every target: language level, warnings, sanitizers, ccache.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

# A development build without any optimisation is too slow to run a single scene.
set(CMAKE_CXX_FLAGS_DEBUG "-Og -g")

option(PILEUS_WARNINGS_AS_ERRORS "Treat compiler warnings as errors" OFF)
set(PILEUS_SANITIZER "" CACHE STRING "address, undefined, both joined by a comma, thread, or empty")
option(PILEUS_FUZZING "Build with clang's coverage for libFuzzer" OFF)

find_program(PILEUS_CCACHE ccache)
if(PILEUS_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER ${PILEUS_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${PILEUS_CCACHE})
endif()

# Every in-tree target links this: warnings and the floating-point rules that keep results
# bitwise reproducible (no contraction that could differ between a vector body and its tail).
add_library(pileus_build INTERFACE)
target_compile_options(
  pileus_build INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                         -Wno-psabi -fno-math-errno
                         $<$<NOT:$<BOOL:$<TARGET_PROPERTY:PILEUS_FUSES_MULTIPLY_ADD>>>:-ffp-contract=off>
                         # GCC 12 warns about joining std::string temporaries for no reason
                         # (its bug 105651).
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(PILEUS_WARNINGS_AS_ERRORS)
  target_compile_options(pileus_build INTERFACE -Werror)
endif()
if(PILEUS_FUZZING)
  target_compile_options(pileus_build INTERFACE -fsanitize=fuzzer-no-link)
endif()
if(PILEUS_SANITIZER)
  target_compile_options(pileus_build INTERFACE -fsanitize=${PILEUS_SANITIZER}
                                                -fno-omit-frame-pointer)
  target_link_options(pileus_build INTERFACE -fsanitize=${PILEUS_SANITIZER})
  if(PILEUS_SANITIZER MATCHES "undefined")
    target_compile_options(pileus_build INTERFACE -fno-sanitize-recover=all)
  endif()
endif()

# One static library per folder of core/src; the folder name is the target's suffix. Sources are
# globbed so that a file's folder alone decides where it belongs.
function(pileus_add_folder folder)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "LINK")
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/${folder}/*.cpp)
  if(sources)
    add_library(pileus_${folder} STATIC ${sources})
    target_include_directories(pileus_${folder} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/src
                                                       ${CMAKE_CURRENT_SOURCE_DIR}/include)
    target_link_libraries(pileus_${folder} PUBLIC pileus_build ${ARG_LINK})
  else()
    add_library(pileus_${folder} INTERFACE)
    target_include_directories(pileus_${folder} INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/src
                                                          ${CMAKE_CURRENT_SOURCE_DIR}/include)
    target_link_libraries(pileus_${folder} INTERFACE pileus_build ${ARG_LINK})
  endif()
endfunction()

# Vector kernels of a folder (src/<folder>/kernels/*.cpp) are compiled once per instruction set and
# chosen at run time. Each copy lives in a namespace of its own (PILEUS_ISA), so that no inline
# function of the wide version can be linked into the narrow one. They work on whole packs and have no
# tails, so that products and sums may be fused: a parcel meets the same operations wherever it stands.
function(pileus_add_kernels folder)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/${folder}/kernels/*.cpp)
  if(NOT sources)
    return()
  endif()
  set(flags_baseline "")
  set(flags_avx2 -mavx2 -mfma -mbmi2)
  set(flags_avx512 -mavx512f -mavx512dq -mavx512vl -mavx512bw -mavx2 -mfma -mbmi2
                   -mprefer-vector-width=512)
  foreach(isa baseline avx2 avx512)
    set(target pileus_${folder}_${isa})
    add_library(${target} OBJECT ${sources})
    target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
    target_link_libraries(${target} PRIVATE pileus_build)
    target_compile_definitions(${target} PRIVATE PILEUS_ISA=${isa})
    target_compile_options(${target} PRIVATE -Wno-psabi "$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-uninitialized>" $<$<CONFIG:Debug>:-O2> ${flags_${isa}})
    if(NOT isa STREQUAL "baseline")
      set_target_properties(${target} PROPERTIES PILEUS_FUSES_MULTIPLY_ADD ON)
      target_compile_options(${target} PRIVATE -ffp-contract=fast)
    endif()
    target_sources(pileus_${folder} PRIVATE $<TARGET_OBJECTS:${target}>)
  endforeach()
endfunction()
