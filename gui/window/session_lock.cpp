// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/session_lock.h"

#include <QCoreApplication>
#include <QCryptographicHash>
#include <QDir>
#include <QFileInfo>

#include "gui/document/own_files.h"

namespace glint::gui {

namespace {
constexpr int kTryMs = 100;  // another program may be looking for leftovers just now

QString canonical(const QString& session) {
  const QFileInfo info(session);
  return info.exists() ? info.canonicalFilePath() : info.absoluteFilePath();
}

std::unique_ptr<QLockFile> lockOf(const QString& file) {
  auto lock = std::make_unique<QLockFile>(file);
  lock->setStaleLockTime(0);  // held for as long as the session is open; of a process that ended it is stale at once
  return lock;
}

QString lockFile(const QString& session) {
  const QByteArray name = QCryptographicHash::hash(canonical(session).toUtf8(), QCryptographicHash::Sha256).toHex();
  return QDir(locksFolder()).filePath(QString::fromLatin1(name.left(32)) + QStringLiteral(".lock"));
}
}  // namespace

SessionLock::SessionLock() {
  for (const QFileInfo& left : QDir(locksFolder()).entryInfoList({QStringLiteral("*.lock")}, QDir::Files))
    lockOf(left.absoluteFilePath())->tryLock(0);  // one of a dead program is taken, and removed when it is given back at once
}

void SessionLock::hold(const QString& session) {
  const QString now = session.isEmpty() ? QString() : canonical(session);
  if (now == session_ && (lock_ || now.isEmpty())) return;
  lock_.reset();
  session_ = now;
  if (session_.isEmpty() || !QDir().mkpath(locksFolder())) return;
  lock_ = lockOf(lockFile(session_));
  if (!lock_->tryLock(kTryMs)) lock_.reset();
}

QString SessionLock::otherHolder(const QString& session) {
  if (session.isEmpty() || (lock_ && canonical(session) == session_)) return {};
  const std::unique_ptr<QLockFile> tried = lockOf(lockFile(session));
  if (tried->tryLock(0)) {
    tried->unlock();
    if (canonical(session) == session_) hold(session);  // the other one has closed it
    return {};
  }
  if (tried->error() != QLockFile::LockFailedError) return {};  // no folder for locks: nothing can be told
  qint64 process = 0;
  QString host, program;
  if (!tried->getLockInfo(&process, &host, &program)) return QCoreApplication::translate("SessionLock", "another program");
  if (process == QCoreApplication::applicationPid())
    return QCoreApplication::translate("SessionLock", "another window of this program");
  return QCoreApplication::translate("SessionLock", "another program (process %1)").arg(process);
}

}  // namespace glint::gui
