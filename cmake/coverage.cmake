# SPDX-License-Identifier: Apache-2.0
# For tools/coverage: counters in what decides (which law is delivered, whether there is torque, what storage holds), and nowhere else, so
# that everything else comes out of the compiler's cache.
file(GLOB safety ${PROJECT_SOURCE_DIR}/firmware/safety/*.cpp)
file(GLOB select ${PROJECT_SOURCE_DIR}/tools/select/*.cpp)
set(counted COMPILE_FLAGS "--coverage -O1" SKIP_PRECOMPILE_HEADERS ON)
# Inlined, the saturation of every sum would count as a branch of the line that adds. Eigen is too slow without.
set_source_files_properties(${safety} ${PROJECT_SOURCE_DIR}/firmware/parameters/storage.cpp TARGET_DIRECTORY capstan_firmware
  PROPERTIES COMPILE_FLAGS "--coverage -O1 -fno-inline")
set_source_files_properties(${select} TARGET_DIRECTORY capstan_tools PROPERTIES ${counted})
foreach(library capstan_firmware capstan_tools)
  target_link_options(${library} INTERFACE --coverage)
endforeach()
