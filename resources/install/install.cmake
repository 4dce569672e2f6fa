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
    PATTERN "json_dom.h" EXCLUDE PATTERN "fifty_digits.h" EXCLUDE PATTERN "colmap_parts.h" EXCLUDE PATTERN "text_rows.h" EXCLUDE)
endforeach()

install(TARGETS glint RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT glint)
install(DIRECTORY resources/specs resources/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/glint COMPONENT glint)
install(DIRECTORY sessions DESTINATION ${CMAKE_INSTALL_DATADIR}/glint COMPONENT glint)
install(FILES resources/scene.schema.json resources/session.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/glint COMPONENT glint)
if(GLINT_GUI)
  install(TARGETS glint-inspector RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT inspector)
endif()
