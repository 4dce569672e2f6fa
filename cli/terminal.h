// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint::cli {

/// Warnings wait for the end of the command and then share one line, so that scripts and people find at most one line on standard
/// error; or each is printed at once, on its own.
void showEachWarning(bool each);
/// Prints what waits.
void showWarnings();
/// Forgets what waits: the command has failed, and its one line says why.
void dropWarnings();

/// What a line on standard error is about.
enum class Tone { Error, Warning, Info };
/// "glint:", which begins every line; on a terminal in red or yellow, unless NO_COLOR is set (no-color.org) or the terminal is
/// dumb. A pipe or file never gets a colour.
std::string programName(Tone tone);

/// Removes the progress line from the terminal, if there is one.
void clearProgressLine();

}  // namespace glint::cli
