# SPDX-License-Identifier: BSD-3-Clause
# Debian packages: cpack --config <build folder>/CPackConfig.cmake -B <folder>. One package for each component of install.cmake.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME glint)
set(CPACK_PACKAGE_CONTACT "The Glint developers <developers@glint.example>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Specular highlights: find, predict, compare, measure lamps")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/resources/install/staged.cmake)
set(CPACK_POST_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/resources/install/packed.cmake)
set(CPACK_COMPONENTS_ALL libraries development glint)
if(GLINT_GUI)
  list(APPEND CPACK_COMPONENTS_ALL inspector)
endif()
if(TARGET glint_python)
  list(APPEND CPACK_COMPONENTS_ALL python paraview)
endif()

# glint_package(COMPONENT NAME SECTION DEPENDS SUMMARY TEXT): what Debian's control file says of it. TEXT: lines are wrapped here, by hand.
macro(glint_package component name section depends summary text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${text}")
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${text}")
  install(FILES ${PROJECT_BINARY_DIR}/package/copyright ${PROJECT_BINARY_DIR}/package/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${name} COMPONENT ${component} EXCLUDE_FROM_ALL)
endmacro()
set(same "(= ${PROJECT_VERSION})")
glint_package(libraries libglint${GLINT_SOVERSION} libs "" "shared libraries of Glint"
  "Find specular highlights in photographs, fit models of them, predict them in\nviews that were not taken, measure lamps. This package has the libraries that\nthe programs, the Python module and plugins share.")
glint_package(development libglint-dev libdevel "libglint${GLINT_SOVERSION} ${same}, libeigen3-dev, python3" "headers of Glint for C++ programs and plugins"
  "Headers, a package file for find_package(Glint), the static library for\npictures with VTK, and examples of a program and of a plugin.")
glint_package(glint glint science "libglint${GLINT_SOVERSION} ${same}" "predict specular highlights from a few images (command line)"
  "Find specular highlights in photographs of a known scene, fit models of them,\npredict them in views that were not taken, compare, and measure where lamps\nstand. With ready-made sessions.")
glint_package(inspector glint-inspector science "glint ${same}, libglint${GLINT_SOVERSION} ${same}" "inspect specular highlights and their models (window)"
  "Every step from photographs to predicted highlights in 3D and in the\nphotographs: cameras and mirrored cameras, tangent planes, ellipsoids, lamps.")
glint_package(python python3-glint python "libglint${GLINT_SOVERSION} ${same}, python3 (>= 3.11), python3 (<< 3.12), python3-numpy" "Python module of Glint"
  "Find specular highlights, fit models, predict and measure lamps from Python,\nwith NumPy arrays in and out.")
glint_package(paraview glint-paraview science "python3-glint ${same}" "Glint in ParaView"
  "A plugin of ParaView: a reader of sessions and scenes, and a filter that\npredicts highlights on a mesh of a pipeline. Load\n/usr/share/glint/paraview/glint_paraview.py under Tools > Manage Plugins.")
set(CPACK_DEBIAN_PARAVIEW_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PARAVIEW_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PARAVIEW_PACKAGE_RECOMMENDS "paraview, python3-paraview")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "libvtk9-dev, libopencv-dev, libx11-dev")  # Glint::viz
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/package/triggers ${PROJECT_BINARY_DIR}/package/shlibs)

# Byte code goes with the package.
foreach(script postinst prerm)
  configure_file(${PROJECT_SOURCE_DIR}/resources/install/python_${script}.sh ${PROJECT_BINARY_DIR}/package/python/${script} COPYONLY)
endforeach()
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/package/python/postinst ${PROJECT_BINARY_DIR}/package/python/prerm)

# Their texts, with dates from the source alone, so that two builds give the same bytes.
file(READ ${PROJECT_SOURCE_DIR}/LICENSE glint_license)
string(STRIP "${glint_license}" glint_license)
# libglint-core holds three.js, which it writes into shared pages.
file(READ ${PROJECT_SOURCE_DIR}/resources/share/three-licence.txt glint_three_licence)
string(STRIP "${glint_three_licence}" glint_three_licence)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/package/copyright CONTENT
"Glint

Copyright: 2026, the Glint developers
License: BSD-3-Clause

@glint_license@

Pages of `glint share` hold three.js. What such a page says of it:

@glint_three_licence@
")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/package/changelog CONTENT
"glint (@PROJECT_VERSION@) unstable; urgency=medium

  * See CHANGELOG.md of the source.

 -- The Glint developers <developers@glint.example>  Thu, 01 Jan 2026 00:00:00 +0000
")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/package/triggers CONTENT "activate-noawait ldconfig\n")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/package/shlibs CONTENT
"libglint-codecs @GLINT_SOVERSION@ libglint@GLINT_SOVERSION@ (= @PROJECT_VERSION@)
libglint-core @GLINT_SOVERSION@ libglint@GLINT_SOVERSION@ (= @PROJECT_VERSION@)
libglint-io @GLINT_SOVERSION@ libglint@GLINT_SOVERSION@ (= @PROJECT_VERSION@)
")
execute_process(COMMAND gzip -9nc ${PROJECT_BINARY_DIR}/package/changelog OUTPUT_FILE ${PROJECT_BINARY_DIR}/package/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
include(CPack)
