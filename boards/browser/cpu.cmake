# SPDX-License-Identifier: Apache-2.0
# WebAssembly, by Debian's emscripten. Exceptions of the plant are those of WebAssembly itself: every browser since 2022 has them, and the
# cycle, which has none, costs nothing by them.
set(CAPSTAN_TOOLCHAIN /usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
set(CAPSTAN_CPU_FLAGS "-fwasm-exceptions")
