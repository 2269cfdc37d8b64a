# SPDX-License-Identifier: Apache-2.0
# Debian packages of the installed components; tools/package makes and tries them.
set(components tools model)
set(packages_tools capstan)
set(packages_model capstan-dev)
if(TARGET capstan_python)
  list(APPEND components python)
  set(packages_python python3-capstan)
  execute_process(COMMAND ${CAPSTAN_PYTHON} -c "import sys; v = sys.version_info; print(f'python3 (>= {v[0]}.{v[1]}), python3 (<< {v[0]}.{v[1] + 1})')"
    OUTPUT_VARIABLE python_depends OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
endif()
if(CAPSTAN_HAS_FIRMWARE_IMAGES)
  list(APPEND components firmware)
  set(packages_firmware capstan-firmware)
endif()

# Who answers for the packages; whoever distributes them gives an address of his own. RFC 2606 keeps `invalid` for what is none.
set(CAPSTAN_MAINTAINER "The Capstan project <noreply@capstan.invalid>" CACHE STRING "name and address of the packages' maintainer")

# What Debian wants of every package: changelog and copyright.
find_program(GZIP gzip)
set(changelog ${PROJECT_BINARY_DIR}/package/changelog)
file(WRITE ${changelog}.Debian "capstan (${PROJECT_VERSION}-1) unstable; urgency=medium\n\n  * See /usr/share/doc/capstan/changelog.gz.\n\n"
  " -- ${CAPSTAN_MAINTAINER}  Sun, 22 Nov 2026 00:00:00 +0000\n")
configure_file(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${changelog} COPYONLY)
if(GZIP)
  foreach(file ${changelog} ${changelog}.Debian)
    execute_process(COMMAND ${GZIP} -9 -n -c ${file} OUTPUT_FILE ${file}.gz COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endif()
foreach(component ${components})
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/${packages_${component}})
  install(FILES ${changelog}.Debian.gz ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${folder} COMPONENT ${component} OPTIONAL)
endforeach()
install(FILES ${changelog}.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/capstan COMPONENT tools OPTIONAL)

# A manual page for each program, of what it says about itself.
set(purpose_capstan "identify, diagnose, correct and run joints driven through tendons")
set(purpose_capstan_plant "simulated joint for a board on a serial line")
set(purpose_capstan_drives "simulated CiA 402 drives on a CAN bus")
set(purpose_capstan_linux_rt "Capstan's firmware on a real-time Linux")
foreach(program capstan capstan_plant capstan_drives capstan_linux_rt)
  set(page ${PROJECT_BINARY_DIR}/package/${program}.1)
  add_custom_command(OUTPUT ${page}.gz
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${program}> -DOUTPUT=${page} -DVERSION=${PROJECT_VERSION}
      -DPURPOSE=${purpose_${program}} -P ${CMAKE_CURRENT_LIST_DIR}/man_page.cmake
    DEPENDS ${program} ${CMAKE_CURRENT_LIST_DIR}/man_page.cmake VERBATIM)
  list(APPEND pages ${page}.gz)
endforeach()
add_custom_target(capstan_man_pages ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)

set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # tools/package builds what is packed, and no test
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME capstan)
set(CPACK_PACKAGE_CONTACT "${CAPSTAN_MAINTAINER}")
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME ${packages_tools})
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "openocd | stlink-tools | dfu-util")
# A description's first line is the synopsis.
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "tools for joints driven through tendons: identify, diagnose, run
The program capstan reads logs of a tendon-driven joint, identifies its law,
says what the law lacks, and puts the missing effect into a running board.
With the firmware for a real-time Linux, a simulated plant and drives.
/usr/share/capstan/demo shows all of it on a simulated joint, in a minute.")

set(CPACK_DEBIAN_MODEL_PACKAGE_NAME ${packages_model})
set(CPACK_DEBIAN_MODEL_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_MODEL_DESCRIPTION "laws of joints driven through tendons, as a C++ library
Laws of motion and force as C++ templates, for other controllers:
find_package(Capstan) and capstan::model, or pkg-config capstan-model.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME ${packages_python})
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${python_depends}, python3-numpy")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Python module for logs of joints driven through tendons
Python module that reads logs of such a joint, identifies and diagnoses it,
and runs its laws over arrays in double and in the arithmetic of the board.")

set(CPACK_DEBIAN_FIRMWARE_PACKAGE_NAME ${packages_firmware})
set(CPACK_DEBIAN_FIRMWARE_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_FIRMWARE_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_FIRMWARE_PACKAGE_RECOMMENDS capstan)
set(CPACK_COMPONENT_FIRMWARE_DESCRIPTION "control firmware for joints driven through tendons, as images
Images for the STM32F405 motor board: four axes, quadrature encoders, a
console on a serial line and a CAN bus. The program capstan flash writes them.")
include(CPack)
