// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/session/session.h"

namespace glint {

/// OutsidePath if the truth folder that the session's request names lies in no folder that the session may name, and the
/// session has no right to others (`allowOutsidePaths`).
void requirePermittedTruth(const Session& session, const Relinked& instead);

}  // namespace glint
