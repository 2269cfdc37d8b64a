# SPDX-License-Identifier: Apache-2.0
# Makes built_in_instruments.cpp in the including folder's build: the instrument files compiled in, so that a scenario finds them
# wherever the program runs.
set(CAPSTAN_INSTRUMENTS "")
foreach(name micro_forceps da_vinci_wrist raven2 robot_finger)
  set(file ${CMAKE_CURRENT_LIST_DIR}/instruments/${name}.toml)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(APPEND CAPSTAN_INSTRUMENTS "    {\"${name}\", R\"toml(${text})toml\"},\n")
endforeach()
configure_file(${CMAKE_CURRENT_LIST_DIR}/built_in_instruments.cpp.in built_in_instruments.cpp @ONLY)
