# SPDX-License-Identifier: BSD-3-Clause
# cmake -DSRC=<project> -P source_rules.cmake: rules of the sources that a reviewer should not have to look for.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/complain.cmake)

# Files beyond 600 lines, each with the reason why it is better whole: "path: reason".
set(longFiles "core/surface/mesh.cpp: one class, whose rays, feet and searches share its triangles"
              "viz/scene_view.cpp: one class, whose drawing and picking share its list of layers")
set(maxLines 600)

set(sources "")
foreach(layer io core viz gui cli plugins tests bench)
  file(GLOB_RECURSE found "${SRC}/${layer}/*.h" "${SRC}/${layer}/*.cpp")
  list(APPEND sources ${found})
endforeach()
foreach(f IN LISTS sources)
  file(READ "${f}" head LIMIT 64)
  if(NOT head MATCHES "^// SPDX-License-Identifier: BSD-3-Clause\n")
    complain("${f}" "first line is not '// SPDX-License-Identifier: BSD-3-Clause'")
  endif()
  file(RELATIVE_PATH name "${SRC}" "${f}")
  if(name MATCHES "^(io|core|viz|gui|cli)/")
    file(READ "${f}" text)
    string(REGEX REPLACE "[^\n]" "" text "${text}")
    string(LENGTH "${text}" lines)
    if(lines GREATER maxLines AND NOT ";${longFiles}" MATCHES ";${name}: ")
      complain("${f}" "${lines} lines, more than ${maxLines}: split it, or list it in source_rules.cmake with the reason")
    endif()
  endif()
endforeach()

# A small number in core is a threshold, and a threshold has its reason beside it: a comment on its line or on the one above. Exempt are units (`Us * 1e-3`), ranges of inputs, and tables of settings.
file(GLOB_RECURSE coreSources "${SRC}/io/*.h" "${SRC}/io/*.cpp" "${SRC}/core/*.h" "${SRC}/core/*.cpp")
list(FILTER coreSources EXCLUDE REGEX "core/(base/settings[.]cpp|choice/tradeoff_knobs[.]cpp)")
foreach(f IN LISTS coreSources)
  file(READ "${f}" text)
  string(REGEX REPLACE "[][;]" " " text "${text}")  # CMake's list syntax
  string(REGEX MATCHALL "\n[^\n]*\n[^\n]*[0-9]e-[0-9][^\n]*" pairs "${text}")
  foreach(pair IN LISTS pairs)
    if(NOT pair MATCHES "//|Us [*] 1e-|inRange[(]")
      string(REGEX REPLACE "^\n[^\n]*\n *" "" line "${pair}")
      complain("${f}" "a threshold without its reason: ${line}")
    endif()
  endforeach()
endforeach()

# Numbers never depend on the locale: text is made by formatted and read by numberFrom or std::from_chars (core/base/number_text.h).
# Two files may call the C functions: the one that makes them free of the locale, and one that prints no number with a point.
file(GLOB_RECURSE numberSources "${SRC}/io/*.h" "${SRC}/io/*.cpp" "${SRC}/core/*.h" "${SRC}/core/*.cpp" "${SRC}/viz/*.h" "${SRC}/viz/*.cpp"
     "${SRC}/cli/*.h" "${SRC}/cli/*.cpp" "${SRC}/gui/*.h" "${SRC}/gui/*.cpp")
list(FILTER numberSources EXCLUDE REGEX "core/(base/number_text|scene/image_decode)[.]cpp$")
foreach(f IN LISTS numberSources)
  file(STRINGS "${f}" hit REGEX "(^|[^A-Za-z_])(snprintf|sprintf|strtod|strtof|strtold|atof|stod|stof|stold|sscanf|asprintf) *[(]")
  if(hit)
    complain("${f}" "depends on the locale (see core/base/number_text.h): ${hit}")
  endif()
endforeach()

# A model is one file: what others must know of it is a virtual or the traits of HighlightModel (core/model/model.h). Exempt are the stability
# cases, which are of one model each, and files where the word means something else: "path: reason".
set(modelWords "core/pipeline/stage_run.cpp: a stage's name" "core/pipeline/fit_engine.cpp: a stage's name" "core/synth/spec.cpp: values of the file format"
               "core/synth/synth.h: values of the file format" "core/advise/conditioning.cpp: a kind of contour"
               "core/draw/plots.cpp: a plot's name" "gui/plots/plots_panel.cpp: a plot's name" "gui/frame/pair_bar.cpp: a kind of ellipse"
               "viz/camera_colours.h: a word of the legend")
file(GLOB_RECURSE modelSources "${SRC}/io/*.h" "${SRC}/io/*.cpp" "${SRC}/core/*.h" "${SRC}/core/*.cpp" "${SRC}/viz/*.h" "${SRC}/viz/*.cpp"
     "${SRC}/cli/*.h" "${SRC}/cli/*.cpp" "${SRC}/gui/*.h" "${SRC}/gui/*.cpp")
list(FILTER modelSources EXCLUDE REGEX "/core/(model|stability)/")
foreach(f IN LISTS modelSources)
  file(RELATIVE_PATH name "${SRC}" "${f}")
  file(STRINGS "${f}" hit REGEX "\"(primal|dual|canonical|limit-angle|reflectance)\"")
  if(hit AND NOT ";${modelWords}" MATCHES ";${name}: ")
    complain("${f}" "knows a model by its name (see ModelTraits): ${hit}")
  endif()
endforeach()

# Sources are listed, not globbed: a new file must make CMake run again, and a stray one must not enter the build.
file(GLOB_RECURSE lists "${SRC}/io/CMakeLists.txt" "${SRC}/core/CMakeLists.txt" "${SRC}/viz/CMakeLists.txt" "${SRC}/gui/CMakeLists.txt" "${SRC}/cli/CMakeLists.txt"
     "${SRC}/plugins/CMakeLists.txt" "${SRC}/tests/CMakeLists.txt" "${SRC}/bench/CMakeLists.txt")
foreach(f "${SRC}/CMakeLists.txt" ${lists})
  if(EXISTS "${f}")
    file(STRINGS "${f}" hit REGEX "(file[ \t]*\\([ \t]*GLOB|aux_source_directory)")
    if(hit)
      complain("${f}" "sources are found by a pattern: ${hit}")
    endif()
  endif()
endforeach()

# Files name nothing of one machine or one network: no absolute paths of home and work folders, no hosts that serve packages.
# (The patterns are written so that they do not match themselves.)
set(places "(^|[^A-Za-z0-9_.~/-])/(wor[k]|hom[e]|roo[t]|User[s]|mn[t]/[a-z])/[A-Za-z0-9]")
set(hosts "(de[b][.]debian[.]org|snapshot[.]debian[.]org|registry[.]npmj[s]|pyp[i][.]org|crate[s][.]io|archive[.]ubuntu[.]com|conda[.]anacond[a]|nodesourc[e][.]com|package[s][.]cloud)")
file(GLOB rootFiles LIST_DIRECTORIES false "${SRC}/*" "${SRC}/.clang-*" "${SRC}/.gitignore" "${SRC}/.ci/*")
list(FILTER rootFiles EXCLUDE REGEX "/([.]git|CMakeUserPresets[.]json|compile_commands[.]json)$")
set(texts ${rootFiles})
foreach(folder io core viz gui cli plugins tests bench docs resources sessions)
  file(GLOB_RECURSE found LIST_DIRECTORIES false "${SRC}/${folder}/*")
  list(APPEND texts ${found})
endforeach()
list(FILTER texts EXCLUDE REGEX "[.](png|jpg|jpeg|tif|tiff|exr|ply|stl|ico|ttf|pdf|mp4|pyc)$")
foreach(f IN LISTS texts)
  file(STRINGS "${f}" hit REGEX "${places}")
  if(hit)
    complain("${f}" "path of one machine: ${hit}")
  endif()
  file(STRINGS "${f}" hit REGEX "${hosts}")
  if(hit)
    complain("${f}" "host of a package registry: ${hit}")
  endif()
endforeach()

if(broken)
  message(FATAL_ERROR "source rules:${broken}")
endif()
