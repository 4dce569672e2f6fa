// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>
#include <filesystem>
#include <string>
#include <vector>

namespace glint::gui {

class Document;

/// What this program keeps for itself: autosaves and locks of sessions that are open. Both folders may not exist yet.
QString recoveryFolder();
QString locksFolder();
/// Lies in recoveryFolder(): only this program writes there, so that its content can be trusted.
bool isOwnRecovery(const QString& file);
/// Lessons and sessions that came with the program, installed or in its source tree: read-only, whatever the file system says.
bool isShipped(const QString& file);
/// The open session is a lesson as it came with the program: what is tried out in it is given up without a question.
bool isOpenLesson(const Document& document);
/// The files that the open scene is made of, its session, and the input as it was opened; none while nothing is open.
std::vector<std::filesystem::path> filesOfInput(const Document& document);
/// Whether a path is one of them.
bool isOfInput(const Document& document, const QString& file);
/// What a file holds, to see later whether it is still the same; "" if it is missing or cannot be read.
std::string stampOf(const QString& file);

}  // namespace glint::gui
