# SPDX-License-Identifier: Apache-2.0
# Cross compilers only. CAPSTAN_TARGET is the board, a folder of boards/; what its processor needs comes from its cpu.cmake, which sets
#   CAPSTAN_COMPILER_PREFIX  CAPSTAN_CPU_FLAGS  CAPSTAN_SYSTEM_NAME  CAPSTAN_SYSTEM_PROCESSOR
# or, where the compiler brings a description of its own for CMake, CAPSTAN_TOOLCHAIN and CAPSTAN_CPU_FLAGS.
set(CAPSTAN_TARGET "stm32f405" CACHE STRING "a folder of boards/ that has a cpu.cmake")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CAPSTAN_TARGET)
set(capstan_cpu ${CMAKE_CURRENT_LIST_DIR}/boards/${CAPSTAN_TARGET}/cpu.cmake)
if(NOT EXISTS ${capstan_cpu})
  message(FATAL_ERROR "CAPSTAN_TARGET is '${CAPSTAN_TARGET}', and there is no boards/${CAPSTAN_TARGET}/cpu.cmake; name the folder of a board that has one.")
endif()
include(${capstan_cpu})

if(DEFINED CAPSTAN_TOOLCHAIN)
  if(NOT EXISTS ${CAPSTAN_TOOLCHAIN})
    message(FATAL_ERROR "${CAPSTAN_TOOLCHAIN} is not installed; run tools/setup.")
  endif()
  include(${CAPSTAN_TOOLCHAIN})
  foreach(language C CXX)
    set(CMAKE_${language}_FLAGS_INIT "${CAPSTAN_CPU_FLAGS}")
  endforeach()
  set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
  return()
endif()

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
