// SPDX-License-Identifier: Apache-2.0
// Nothing: the headers that precompiled.cmake names are all that is compiled here.
