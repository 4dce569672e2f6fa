// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/command.h"
#include "core/app/session.h"

namespace glint::cli {

/// `predict --stream`: answers each pose of a file, or of standard input, by one line on standard output, until the end.
/// @param poses  "-" or "" = standard input
/// @throw InputError if the poses cannot be read; CannotAnswer if no model was fitted
int answerPoses(const OpenedSession& opened, const InspectionRequest& request, const std::string& poses, const Context& context);

}  // namespace glint::cli
