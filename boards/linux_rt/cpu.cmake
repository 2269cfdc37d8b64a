# SPDX-License-Identifier: Apache-2.0
# 64-bit ARM under Linux, no particular processor (Raspberry Pi CM4 and BeagleBone AI-64 are both Cortex-A72). On this machine
# the tests run through QEMU's user-mode emulator.
set(CAPSTAN_CPU_FLAGS "-march=armv8-a")
set(CAPSTAN_COMPILER_PREFIX "aarch64-linux-gnu-")
set(CAPSTAN_SYSTEM_NAME "Linux")
set(CAPSTAN_SYSTEM_PROCESSOR "aarch64")
set(CMAKE_CROSSCOMPILING_EMULATOR "qemu-aarch64-static")
