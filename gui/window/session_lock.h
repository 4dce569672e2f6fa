// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QLockFile>
#include <QString>
#include <memory>

namespace glint::gui {

/// Tells programs that have the same session open from each other. The lock lies in the program's folder, not beside the session,
/// and is for telling only: nothing is locked. What a program left behind that ended unexpectedly does not count, and is removed.
class SessionLock {
 public:
  SessionLock();
  /// This window has the session open from now on, and no other any more; "" = none.
  void hold(const QString& session);
  /// Another window or program that has the session open, in words; "" = none.
  QString otherHolder(const QString& session);

 private:
  QString session_;
  std::unique_ptr<QLockFile> lock_;  ///< of session_; null = none, or another one has it
};

}  // namespace glint::gui
