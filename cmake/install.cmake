# SPDX-License-Identifier: Apache-2.0
# What others get: `cmake --install` with the components `tools` (the programs, and the console page where it was built), `model` (the laws as a library, found by
# find_package(Capstan) or pkg-config), `python` (the module) and `firmware` (images for the motor board, where they were built); package.cmake
# makes Debian packages of them. The version comes from project() alone.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS capstan_model EXPORT CapstanTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT model)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/model/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/capstan/model COMPONENT model
  FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/own_controller DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/capstan-dev/examples COMPONENT model)
install(EXPORT CapstanTargets NAMESPACE capstan:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Capstan COMPONENT model)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/CapstanConfig.cmake.in ${PROJECT_BINARY_DIR}/CapstanConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Capstan)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/CapstanConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/CapstanConfig.cmake ${PROJECT_BINARY_DIR}/CapstanConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Capstan COMPONENT model)
configure_file(${CMAKE_CURRENT_LIST_DIR}/capstan-model.pc.in ${PROJECT_BINARY_DIR}/capstan-model.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/capstan-model.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig COMPONENT model)

install(TARGETS capstan capstan_plant capstan_drives capstan_linux_rt RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
install(FILES ${PROJECT_BINARY_DIR}/capstan_stm32f405.dbc DESTINATION ${CMAKE_INSTALL_DATADIR}/capstan COMPONENT tools)
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/capstan COMPONENT tools)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/capstan COMPONENT tools)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/tools/scenarios DESTINATION ${CMAKE_INSTALL_DATADIR}/capstan COMPONENT tools
  PATTERN README.md EXCLUDE)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/tools/demo_steps DESTINATION ${CMAKE_INSTALL_DATADIR}/capstan RENAME demo COMPONENT tools)
install(FILES ${PROJECT_SOURCE_DIR}/examples/routing.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/capstan/examples COMPONENT tools)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/README.Debian DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/capstan COMPONENT tools)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/schema DESTINATION ${CMAKE_INSTALL_DATADIR}/capstan COMPONENT tools)

set(CAPSTAN_PAGE ${PROJECT_SOURCE_DIR}/build/browser/site CACHE PATH "where the preset browser has put the console page")
if(EXISTS ${CAPSTAN_PAGE}/served.html)
  install(DIRECTORY ${CAPSTAN_PAGE}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/capstan/console COMPONENT tools)
endif()

if(TARGET capstan_python)  # where Debian's python3 looks, and anybody with PYTHONPATH
  install(TARGETS capstan_python LIBRARY DESTINATION lib/python3/dist-packages COMPONENT python)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/python/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-capstan/examples
    COMPONENT python)
endif()

set(CAPSTAN_FIRMWARE_IMAGES ${PROJECT_SOURCE_DIR}/build/stm32f405/bin CACHE PATH "where the preset stm32f405 has put its images")
if(EXISTS ${CAPSTAN_FIRMWARE_IMAGES}/capstan_stm32f405.hex)
  install(FILES ${CAPSTAN_FIRMWARE_IMAGES}/capstan_stm32f405.hex ${CAPSTAN_FIRMWARE_IMAGES}/capstan_stm32f405.bin
    DESTINATION ${CMAKE_INSTALL_DATADIR}/capstan/firmware COMPONENT firmware)
  set(CAPSTAN_HAS_FIRMWARE_IMAGES ON)
endif()

include(${CMAKE_CURRENT_LIST_DIR}/package.cmake)
