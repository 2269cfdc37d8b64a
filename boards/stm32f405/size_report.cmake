# SPDX-License-Identifier: Apache-2.0
# Prints what an image takes: cmake -DSIZE=<arm-none-eabi-size> -DIMAGE=<elf> -DNAME=<name> -P size_report.cmake
execute_process(COMMAND ${SIZE} -A -d ${IMAGE} OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)

function(section name result)
  string(REGEX MATCH "\n\\.${name} +([0-9]+)" found "${table}")
  set(${result} 0 PARENT_SCOPE)
  if(found)
    set(${result} ${CMAKE_MATCH_1} PARENT_SCOPE)
  endif()
endfunction()

foreach(name vectors text data bss noinit stack)
  section(${name} ${name}_bytes)
endforeach()
math(EXPR flash "${vectors_bytes} + ${text_bytes} + ${data_bytes}")
math(EXPR ram "${data_bytes} + ${bss_bytes} + ${noinit_bytes} + ${stack_bytes}")
math(EXPR flash_permille "${flash} * 1000 / ((1024 - 32) * 1024)")
math(EXPR ram_permille "${ram} * 1000 / (128 * 1024)")
message("${NAME}: flash ${flash} bytes (${flash_permille} per thousand: vectors ${vectors_bytes}, text ${text_bytes}, data ${data_bytes}), "
  "RAM ${ram} bytes (${ram_permille} per thousand: data ${data_bytes}, bss ${bss_bytes}, kept ${noinit_bytes}, stack ${stack_bytes})")
