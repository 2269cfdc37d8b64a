# SPDX-License-Identifier: Apache-2.0
# Cortex-M4. The chip has a single-precision FPU, but it stays switched off: all maths of the firmware is fixed point, so no
# floating-point instruction may appear. With the soft ABI the compiler cannot emit one, an interrupt stacks 8 words instead of
# 26, and the link fails when a floating-point routine is pulled in (forbidden.ld).
set(CAPSTAN_CPU_FLAGS "-mcpu=cortex-m4 -mthumb -mfloat-abi=soft")
set(CAPSTAN_COMPILER_PREFIX "arm-none-eabi-")
set(CAPSTAN_SYSTEM_NAME "Generic")
set(CAPSTAN_SYSTEM_PROCESSOR "cortex-m4")
