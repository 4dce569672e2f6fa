# SPDX-License-Identifier: BSD-3-Clause
# cmake -DSRC=<project> -P citations.cmake: a page of docs that the source cites exists, and so does the section that stands in quotes behind it:
# docs/formats.md, "Noise". A citation may go on in the next line of its comment.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/complain.cmake)

set(sources "")
foreach(layer io core viz gui cli plugins tests bench)
  file(GLOB_RECURSE found "${SRC}/${layer}/*.h" "${SRC}/${layer}/*.cpp" "${SRC}/${layer}/*.py" "${SRC}/${layer}/*.cmake" "${SRC}/${layer}/CMakeLists.txt"
       "${SRC}/${layer}/run_*")
  list(APPEND sources ${found})
endforeach()
file(GLOB_RECURSE rules "${SRC}/tests/rules/*")  # these name pages that do not exist, to see that they are found
list(REMOVE_ITEM sources ${rules} "")
list(REMOVE_DUPLICATES sources)

foreach(f IN LISTS sources)
  file(READ "${f}" text)
  if(NOT text MATCHES "[.]md")
    continue()
  endif()
  string(REGEX REPLACE "[][;\\]" " " text "${text}")  # CMake's list syntax
  string(REGEX REPLACE "\n[ \t]*(///?<?|#|[*])[ \t]*" " " text "${text}")
  # A page without its folder led nowhere in a clone.
  if(text MATCHES "(^|[^/A-Za-z0-9_-])formats[.]md")
    complain("${f}" "cites formats.md without its folder: docs/formats.md, \"Section\"")
  endif()
  string(REGEX MATCHALL "docs/[A-Za-z0-9_-]+[.]md(,? \"[^\"\n]+\")?" citations "${text}")
  foreach(citation IN LISTS citations)
    string(REGEX MATCH "^(docs/[A-Za-z0-9_-]+[.]md)(,? \"([^\"]+)\")?$" parts "${citation}")
    set(page "${CMAKE_MATCH_1}")
    set(section "${CMAKE_MATCH_3}")
    if(NOT EXISTS "${SRC}/${page}")
      complain("${f}" "cites ${page}, which does not exist")
    elseif(NOT section STREQUAL "")
      file(STRINGS "${SRC}/${page}" headings REGEX "^##* ")
      list(TRANSFORM headings REPLACE "^#+ +" "")
      list(TRANSFORM headings STRIP)
      if(NOT section IN_LIST headings)
        complain("${f}" "cites ${page}, \"${section}\": no such heading there")
      endif()
    endif()
  endforeach()
endforeach()

if(broken)
  message(FATAL_ERROR "citations:${broken}")
endif()
