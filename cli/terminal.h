// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint::cli {

/// Removes the progress line from the terminal, if there is one.
void clearProgressLine();

}  // namespace glint::cli
