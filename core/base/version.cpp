// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/version.h"

namespace glint {

const char* libraryVersion() { return GLINT_VERSION; }
int libraryInterfaceVersion() { return GLINT_INTERFACE_VERSION; }

}  // namespace glint
