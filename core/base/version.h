// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The version of Glint: here and nowhere else (CMakeLists.txt reads it).
#define GLINT_VERSION "0.1.0"
/// The version of the binary interface of libglint-io, libglint-core and libglint-codecs: a new number with every release that
/// changes a public header. It is their SONAME, and plugins are asked for it before anything of theirs runs.
#define GLINT_INTERFACE_VERSION 0

namespace glint {

/// GLINT_VERSION of the library that was loaded; a program that was compiled against other headers sees the difference.
const char* libraryVersion();
/// GLINT_INTERFACE_VERSION of the library that was loaded.
int libraryInterfaceVersion();

}  // namespace glint
