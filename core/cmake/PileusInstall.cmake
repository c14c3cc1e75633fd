# What `cmake --install` puts where, and the Debian package that `cpack` makes of it.
#
#   component `program`   bin/pileus, lib/pileus/plugins, share/pileus/{schemas,scenes}
#   component `plugin`    include/pileus and the CMake package: all that building a plugin needs
#
# The program finds its plugins relative to itself, so that a prefix can be moved.

include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Pileus)

if(TARGET pileus)
  install(TARGETS pileus RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endif()
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pileus RENAME copyright COMPONENT program)
install(DIRECTORY schemas DESTINATION ${CMAKE_INSTALL_DATADIR}/pileus COMPONENT program)
install(DIRECTORY configs/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/pileus COMPONENT program
        FILES_MATCHING PATTERN "*.yaml" PATTERN "*.csv" PATTERN "*.nc")
# Scenes name the schema that editors complete them with by its place in the source tree.
install(CODE "set(scenes_folder \"${CMAKE_INSTALL_DATADIR}/pileus/scenes\")" COMPONENT program)
install(
  CODE [[
  file(GLOB scene_files "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${scenes_folder}/*/*.yaml")
  foreach(scene_file ${scene_files})
    file(READ "${scene_file}" text)
    string(REGEX REPLACE "^(# yaml-language-server: [$]schema=)../../../" "\\1../../" text "${text}")
    file(WRITE "${scene_file}" "${text}")
  endforeach()
  ]]
  COMPONENT program)

install(DIRECTORY core/include/pileus DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT plugin)
set_target_properties(pileus_plugin PROPERTIES EXPORT_NAME plugin)
install(TARGETS pileus_plugin EXPORT PileusTargets)
install(EXPORT PileusTargets NAMESPACE Pileus:: DESTINATION ${package_folder} COMPONENT plugin)
configure_package_config_file(
  core/cmake/PileusConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/package/PileusConfig.cmake
  INSTALL_DESTINATION ${package_folder} PATH_VARS CMAKE_INSTALL_BINDIR)
# While the major version is 0 a minor one may change the interface; headers suit any processor.
write_basic_package_version_file(
  ${CMAKE_CURRENT_BINARY_DIR}/package/PileusConfigVersion.cmake COMPATIBILITY SameMinorVersion
  ARCH_INDEPENDENT)
install(
  FILES ${CMAKE_CURRENT_BINARY_DIR}/package/PileusConfig.cmake
        ${CMAKE_CURRENT_BINARY_DIR}/package/PileusConfigVersion.cmake
        core/cmake/PileusPlugin.cmake core/cmake/plugin_exports.map
  DESTINATION ${package_folder} COMPONENT plugin)

# `cpack --config build/release/CPackConfig.cmake`: one package of both components, in the folder
# `package` of the build. Its dependencies are found by dpkg-shlibdeps.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/package)
set(CPACK_PACKAGE_NAME pileus)
set(CPACK_PACKAGE_VENDOR "Pileus contributors")
set(CPACK_PACKAGE_CONTACT "Pileus contributors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake")
include(CPack)
