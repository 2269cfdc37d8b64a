# SPDX-License-Identifier: Apache-2.0
# What others get: `cmake --install` with two components, `tools` (the programs) and `model` (the laws as a library, found by
# find_package(Capstan) or pkg-config), and CPack's Debian packages of the two. The version comes from project() alone.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS capstan_model EXPORT CapstanTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT model)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/model/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/capstan/model COMPONENT model
  FILES_MATCHING PATTERN "*.hpp")
install(EXPORT CapstanTargets NAMESPACE capstan:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Capstan COMPONENT model)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/CapstanConfig.cmake.in ${PROJECT_BINARY_DIR}/CapstanConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Capstan)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/CapstanConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/CapstanConfig.cmake ${PROJECT_BINARY_DIR}/CapstanConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Capstan COMPONENT model)
configure_file(${CMAKE_CURRENT_LIST_DIR}/capstan-model.pc.in ${PROJECT_BINARY_DIR}/capstan-model.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/capstan-model.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT model)

install(TARGETS capstan capstan_plant capstan_drives capstan_linux_rt RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
install(FILES ${PROJECT_BINARY_DIR}/capstan_stm32f405.dbc DESTINATION ${CMAKE_INSTALL_DATADIR}/capstan COMPONENT tools)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/tools/scenarios DESTINATION ${CMAKE_INSTALL_DATADIR}/capstan COMPONENT tools)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the Capstan project <capstan@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Control firmware and tools for joints driven through tendons")
set(CPACK_COMPONENTS_ALL tools model)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME capstan)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_MODEL_PACKAGE_NAME capstan-dev)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "The host program capstan: reads logs of a tendon-driven joint, identifies its law, says what the law\n lacks, and puts the missing effect into a running board. With the simulated plant and drives.")
set(CPACK_COMPONENT_MODEL_DESCRIPTION "Capstan's laws of motion and force as header-only templates, for controllers of one's own:\n find_package(Capstan), then link capstan::model.")
include(CPack)
