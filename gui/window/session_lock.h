// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QLockFile>
#include <QString>
#include <memory>

namespace glint::gui {

/// Tells programs that have the same session open from each other. The lock lies in the program's folder, not beside the session,
/// and only informs: nothing is locked. The lock of a program that ended unexpectedly does not count, and is removed.
class SessionLock {
 public:
  SessionLock();
  /// From now on this window has this session open, and no other; "" = none.
  void hold(const QString& session);
  /// Another window or program that has the session open, in words; "" = none.
  QString otherHolder(const QString& session);

 private:
  QString session_;
  std::unique_ptr<QLockFile> lock_;  ///< of session_; null = none, or another one has it
};

}  // namespace glint::gui
