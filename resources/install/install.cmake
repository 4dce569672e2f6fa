# SPDX-License-Identifier: BSD-3-Clause
# cmake --install: programs, shared libraries, headers under a folder with the version, a package file for find_package(Glint), shipped
# sessions. Every rule names a component; the Debian packages are made of those (resources/install/packages.cmake).
include(CMakePackageConfigHelpers)

set(glint_headers ${CMAKE_INSTALL_INCLUDEDIR}/glint-${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(glint_package ${CMAKE_INSTALL_LIBDIR}/cmake/Glint)
foreach(library io core)
  target_include_directories(glint_shared_${library} INTERFACE $<INSTALL_INTERFACE:${glint_headers}>)
  target_compile_features(glint_shared_${library} PUBLIC cxx_std_20)
  install(TARGETS glint_shared_${library} EXPORT GlintTargets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libraries NAMELINK_COMPONENT development)
endforeach()
install(TARGETS glint_shared_codecs LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libraries NAMELINK_SKIP)  # libglint-core loads it from there
set_target_properties(glint_viz PROPERTIES EXPORT_NAME viz OUTPUT_NAME glint-viz)
# Static: a program that draws carries it, and the shared libraries stay free of VTK.
install(TARGETS glint_viz EXPORT GlintVizTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(EXPORT GlintTargets NAMESPACE Glint:: DESTINATION ${glint_package} COMPONENT development)
install(EXPORT GlintVizTargets NAMESPACE Glint:: DESTINATION ${glint_package} COMPONENT development)
get_target_property(glint_viz_modules glint_viz INTERFACE_LINK_LIBRARIES)
list(FILTER glint_viz_modules INCLUDE REGEX "^VTK::[A-Z]")
list(TRANSFORM glint_viz_modules REPLACE "^VTK::" "")
list(JOIN glint_viz_modules " " glint_viz_components)
configure_package_config_file(resources/install/GlintConfig.cmake.in ${PROJECT_BINARY_DIR}/GlintConfig.cmake INSTALL_DESTINATION ${glint_package})
# Before 1.0 a minor version may change everything.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/GlintConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/GlintConfig.cmake ${PROJECT_BINARY_DIR}/GlintConfigVersion.cmake DESTINATION ${glint_package} COMPONENT development)
foreach(layer core io viz)
  # Those that are left out need libraries that programs outside are not asked for; only sources of core include them.
  install(DIRECTORY ${layer} DESTINATION ${glint_headers} COMPONENT development FILES_MATCHING PATTERN "*.h"
    PATTERN "*_dom.h" EXCLUDE PATTERN "fifty_digits.h" EXCLUDE PATTERN "colmap_parts.h" EXCLUDE PATTERN "codec_table.h" EXCLUDE PATTERN "text_rows.h" EXCLUDE)
endforeach()

install(TARGETS glint RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT glint)
install(DIRECTORY resources/specs DESTINATION ${CMAKE_INSTALL_DATADIR}/glint COMPONENT glint)
install(DIRECTORY resources/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/glint COMPONENT development USE_SOURCE_PERMISSIONS)
install(DIRECTORY plugins/example DESTINATION ${CMAKE_INSTALL_DATADIR}/glint/examples/plugins COMPONENT development)
install(DIRECTORY sessions DESTINATION ${CMAKE_INSTALL_DATADIR}/glint COMPONENT glint PATTERN "make_sessions.sh" EXCLUDE)
install(FILES resources/scene.schema.json resources/session.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/glint COMPONENT glint)
if(GLINT_GUI)
  install(TARGETS glint-inspector RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT inspector)
endif()

# Documentation of the headers: cmake --build <folder> --target api.
find_program(GLINT_DOXYGEN doxygen)
if(GLINT_DOXYGEN)
  configure_file(resources/install/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)
  add_custom_target(api COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/api COMMAND ${GLINT_DOXYGEN} ${PROJECT_BINARY_DIR}/Doxyfile
    COMMAND ${CMAKE_COMMAND} -D FILE=${PROJECT_BINARY_DIR}/api/warnings.txt -P ${PROJECT_SOURCE_DIR}/resources/install/no_warnings.cmake VERBATIM)
endif()

# Manual pages and completion, from the programs' own help.
set(glint_pages ${PROJECT_BINARY_DIR}/pages)
find_program(GLINT_INSTALL_PYTHON python3)
if(GLINT_INSTALL_PYTHON)
  set(page_programs --glint $<TARGET_FILE:glint>)
  set(page_targets glint)
  if(GLINT_GUI)
    list(APPEND page_programs --inspector $<TARGET_FILE:glint-inspector>)
    list(APPEND page_targets glint-inspector)
  endif()
  add_custom_command(OUTPUT ${glint_pages}/glint.bash ${glint_pages}/_glint ${glint_pages}/glint.fish
    COMMAND ${GLINT_INSTALL_PYTHON} -B ${PROJECT_SOURCE_DIR}/resources/install/make_pages.py ${page_programs} --out ${glint_pages}
    DEPENDS ${page_targets} resources/install/make_pages.py VERBATIM)
  add_custom_target(pages ALL DEPENDS ${glint_pages}/glint.bash)
  install(DIRECTORY ${glint_pages}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT glint FILES_MATCHING PATTERN "glint*.1" PATTERN "glint-inspector.1" EXCLUDE)
  install(FILES ${glint_pages}/glint.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME glint COMPONENT glint)
  install(FILES ${glint_pages}/_glint DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT glint)
  install(FILES ${glint_pages}/glint.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT glint)
endif()
if(GLINT_GUI)
  install(FILES ${glint_pages}/glint-inspector.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT inspector OPTIONAL)
  install(FILES resources/install/glint-inspector.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT inspector)
  install(FILES resources/install/glint-inspector.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo COMPONENT inspector)
  install(FILES resources/install/glint.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages COMPONENT inspector)
  install(FILES resources/icons/glint.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT inspector)
endif()

# The Python module where Debian's interpreter looks: below /usr it is found, below another prefix by PYTHONPATH.
if(TARGET glint_python)
  set(glint_python_packages lib/python3/dist-packages/glint)
  install(TARGETS glint_python LIBRARY DESTINATION ${glint_python_packages} COMPONENT python)
  install(FILES plugins/python/glint/__init__.py plugins/python/glint/_glint.pyi plugins/python/glint/py.typed DESTINATION ${glint_python_packages} COMPONENT python)
  # ParaView is told the place of the plugin; it looks nowhere by itself.
  install(FILES plugins/paraview/glint_paraview.py plugins/paraview/glint_paraview_blocks.py plugins/paraview/glint_paraview_vtk.py
    plugins/paraview/setup_paraview.py
    DESTINATION ${CMAKE_INSTALL_DATADIR}/glint/paraview COMPONENT paraview)
endif()

include(resources/install/packages.cmake)
