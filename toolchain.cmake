# SPDX-License-Identifier: Apache-2.0
# Cross compilers only. CAPSTAN_TARGET chooses the board; what its processor needs comes from boards/<board>/cpu.cmake, which sets
#   CAPSTAN_COMPILER_PREFIX  CAPSTAN_CPU_FLAGS  CAPSTAN_SYSTEM_NAME  CAPSTAN_SYSTEM_PROCESSOR
set(CAPSTAN_TARGET "stm32f405" CACHE STRING "stm32f405, linux_rt_aarch64 or browser")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CAPSTAN_TARGET)

if(CAPSTAN_TARGET STREQUAL "browser")  # emscripten brings a description of its own
  include(${CMAKE_CURRENT_LIST_DIR}/boards/browser/cpu.cmake)
  if(NOT EXISTS ${CAPSTAN_EMSCRIPTEN})
    message(FATAL_ERROR "emscripten is not installed; run tools/setup.")
  endif()
  include(${CAPSTAN_EMSCRIPTEN})
  foreach(language C CXX)
    set(CMAKE_${language}_FLAGS_INIT "${CAPSTAN_CPU_FLAGS}")
  endforeach()
  set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
  return()
endif()

if(CAPSTAN_TARGET STREQUAL "stm32f405")
  set(capstan_board "stm32f405")
elseif(CAPSTAN_TARGET STREQUAL "linux_rt_aarch64")
  set(capstan_board "linux_rt")
else()
  message(FATAL_ERROR "CAPSTAN_TARGET is '${CAPSTAN_TARGET}', which toolchain.cmake does not know; use stm32f405, linux_rt_aarch64 or browser.")
endif()
include(${CMAKE_CURRENT_LIST_DIR}/boards/${capstan_board}/cpu.cmake)

set(CMAKE_SYSTEM_NAME ${CAPSTAN_SYSTEM_NAME})
set(CMAKE_SYSTEM_PROCESSOR ${CAPSTAN_SYSTEM_PROCESSOR})
foreach(language C CXX)
  set(CMAKE_${language}_FLAGS_INIT "${CAPSTAN_CPU_FLAGS}")
endforeach()
set(CMAKE_ASM_FLAGS_INIT "${CAPSTAN_CPU_FLAGS}")
find_program(CMAKE_C_COMPILER ${CAPSTAN_COMPILER_PREFIX}gcc)
find_program(CMAKE_CXX_COMPILER ${CAPSTAN_COMPILER_PREFIX}g++)
if(NOT CMAKE_CXX_COMPILER)
  message(FATAL_ERROR "${CAPSTAN_COMPILER_PREFIX}g++ is not installed; run tools/setup.")
endif()
find_program(CMAKE_OBJCOPY ${CAPSTAN_COMPILER_PREFIX}objcopy)
find_program(CMAKE_SIZE ${CAPSTAN_COMPILER_PREFIX}size)
find_program(CMAKE_NM ${CAPSTAN_COMPILER_PREFIX}nm)

# Programs come from this machine, everything else only from the compiler's own tree.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
if(CAPSTAN_SYSTEM_NAME STREQUAL "Generic")
  set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # a program would need the board's start-up code
endif()
