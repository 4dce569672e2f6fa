# SPDX-License-Identifier: BSD-3-Clause
# Precompiled headers of the builds of scripts (GLINT_UNITY): most of the compiler's time goes into headers of libraries. With clang alone: gcc refuses
# them for a target with a definition of its own.
set(GLINT_PRECOMPILE OFF)
set(CMAKE_PCH_PROLOGUE "")  # CMake would call all of them headers of the system, whose warnings are not shown
if(GLINT_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  set(GLINT_PRECOMPILE ON)
endif()

# glint_headers(NAME [LIBS ...] [PIC]): resources/setup/headers/NAME.h, compiled once with the options of this folder.
function(glint_headers name)
  cmake_parse_arguments(arg "PIC" "" "LIBS" ${ARGN})
  if(NOT GLINT_PRECOMPILE)
    return()
  endif()
  set(target glint_headers_${name})
  set(empty "${PROJECT_BINARY_DIR}/${target}.cpp")  # a target needs a file
  file(CONFIGURE OUTPUT "${empty}" CONTENT "")
  add_library(${target} OBJECT "${empty}")
  target_link_libraries(${target} PRIVATE Eigen3::Eigen glint_options ${arg_LIBS})
  target_precompile_headers(${target} PRIVATE "${PROJECT_SOURCE_DIR}/resources/setup/headers/${name}.h")
  target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")  # ccache compares bytes
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ${arg_PIC})
endfunction()

# glint_use_headers(TARGET NAME): before each file of the target stands that header.
function(glint_use_headers target name)
  if(GLINT_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM glint_headers_${name})
  endif()
endfunction()

glint_headers(core PIC)
glint_headers(inspected PIC)
