// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint::cli {

/// Warnings wait for the end of the command and then share one line, so that scripts and people find at most one line on standard error;
/// or each is printed at once, on its own.
void showEachWarning(bool each);
/// Prints what waits.
void showWarnings();
/// Forgets what waits: the command has failed, and its one line says why.
void dropWarnings();

/// Removes the progress line from the terminal, if there is one.
void clearProgressLine();

}  // namespace glint::cli
