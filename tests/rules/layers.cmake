# SPDX-License-Identifier: BSD-3-Clause
# cmake -DSRC=<project> -P layers.cmake: reads every #include and every target_link_libraries and fails where an arrow of the
# layers is broken (docs/architecture.md):
#   cli, gui -> viz -> core,   plugins -> core and viz,   tests and bench -> everything,   nothing -> gui.
cmake_minimum_required(VERSION 3.25)

set(qt "[<\"](Qt[A-Za-z0-9]*/)?(Q[A-Z][A-Za-z0-9]*|QVTK[A-Za-z0-9]*[.]h)[>\"]")
# VTK's classes that draw, by their names: its headers all lie in one folder, so the path does not tell.
set(drawing "<vtk([A-Za-z0-9]*(Render|OpenGL|Actor|Mapper|Widget|Interactor|Representation|Texture|WindowToImage|Context2D|ContextScene|ContextView|Chart|Legend)[A-Za-z0-9]*|Camera|Light|LightKit|Property|Property2D|TextProperty|Prop|Prop3D|Picker|CellPicker|PropPicker|PointPicker|HardwareSelector)[.]h>")
set(leaks "")

# forbid(WHAT PATTERN GLOB...): no include line that matches PATTERN in the files.
function(forbid what pattern)
  foreach(glob IN LISTS ARGN)
    file(GLOB_RECURSE files "${SRC}/${glob}")
    list(FILTER files EXCLUDE REGEX "/bench/gui/")
    foreach(f IN LISTS files)
      file(STRINGS "${f}" lines REGEX "^[ \t]*#[ \t]*include")
      foreach(line IN LISTS lines)
        if(line MATCHES "${pattern}")
          file(RELATIVE_PATH name "${SRC}" "${f}")
          string(APPEND leaks "\n  ${name}: ${line}   (${what})")
        endif()
      endforeach()
    endforeach()
  endforeach()
  set(leaks "${leaks}" PARENT_SCOPE)
endfunction()

# Headers of core: an allow list, because it is the contract of all other layers.
file(GLOB_RECURSE files "${SRC}/core/*.h")
foreach(f IN LISTS files)
  file(STRINGS "${f}" lines REGEX "^[ \t]*#[ \t]*include")
  foreach(line IN LISTS lines)
    if(NOT line MATCHES "include[ \t]*(\"core/[^\"]+\"|<(unsupported/)?Eigen/[A-Za-z/]+>|<[a-z0-9_]+>)")
      file(RELATIVE_PATH name "${SRC}" "${f}")
      string(APPEND leaks "\n  ${name}: ${line}   (core headers include only Eigen, std and core)")
    endif()
  endforeach()
endforeach()

forbid("core does not know Qt" "${qt}" core/*.cpp)
forbid("core does not draw" "${drawing}" core/*.cpp)
forbid("core stands below viz, gui, cli and plugins" "\"([^\"]*/)?(viz|gui|cli|plugins)/" core/*.h core/*.cpp)
forbid("viz does not know Qt" "${qt}" viz/*.h viz/*.cpp)
forbid("viz stands below gui, cli and plugins" "\"([^\"]*/)?(gui|cli|plugins)/" viz/*.h viz/*.cpp)
forbid("cli does not know Qt" "${qt}" cli/*.h cli/*.cpp)
forbid("nothing includes gui or plugins" "\"([^\"]*/)?(gui|plugins)/" cli/*.h cli/*.cpp)
forbid("gui does not include cli or plugins" "\"([^\"]*/)?(cli|plugins)/" gui/*.h gui/*.cpp)
forbid("plugins stand on core and viz" "\"([^\"]*/)?(gui|cli)/" plugins/*.h plugins/*.cpp)
forbid("only the benchmarks of the window know gui" "\"([^\"]*/)?gui/" bench/*.h bench/*.cpp)

# The same arrows at the linker.
function(forbid_link what pattern)
  foreach(layer IN LISTS ARGN)
    file(GLOB_RECURSE files "${SRC}/${layer}/CMakeLists.txt")
    list(FILTER files EXCLUDE REGEX "/bench/gui/")
    foreach(f IN LISTS files)
      file(STRINGS "${f}" hits REGEX "${pattern}")
      if(hits)
        file(RELATIVE_PATH name "${SRC}" "${f}")
        string(APPEND leaks "\n  ${name}: ${hits}   (${what})")
      endif()
    endforeach()
  endforeach()
  set(leaks "${leaks}" PARENT_SCOPE)
endfunction()
forbid_link("Qt belongs to gui" "Qt([0-9]|[$])|GUISupportQt|glint::gui|glint_gui" core viz cli bench)
forbid_link("core does not draw" "VTK::(Rendering|Interaction|Views|Charts|IOExport)|glint::viz|glint_viz" core)

if(leaks)
  message(FATAL_ERROR "layers:${leaks}")
endif()
