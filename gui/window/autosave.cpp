// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/autosave.h"

#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QUuid>
#include <exception>
#include <utility>

#include "core/app/session.h"
#include "core/base/temporary_path.h"
#include "gui/base/text.h"

namespace glint::gui {

namespace {
QString lockOf(const QString& file) { return file + QStringLiteral(".lock"); }

/// Remains of killed programs that cannot be recovered: a half-written file, the lock of a program that had nothing unsaved.
void removeAbandoned(const QString& folder) {
  removeAbandonedTemporaries(folder.toStdString());
  for (const QFileInfo& info : QDir(folder).entryInfoList({lockOf(QStringLiteral("*.glint"))}, QDir::Files)) {
    const QString file = info.absoluteFilePath();
    if (QFile::exists(info.absoluteDir().filePath(info.completeBaseName()))) continue;
    QLockFile lock(file);
    lock.setStaleLockTime(0);
    if (lock.tryLock(0)) lock.unlock();  // which removes it
  }
}
}  // namespace

Autosave::Autosave(const Engine& engine, Document& document, std::function<Opened()> snapshot, const QString& folder,
                   QObject* parent)
    : QObject(parent), engine_(engine), document_(document), snapshot_(std::move(snapshot)), folder_(folder) {
  QDir().mkpath(folder_);
  removeAbandoned(folder_);
  file_ = QDir(folder_).filePath(QUuid::createUuid().toString(QUuid::WithoutBraces) + QStringLiteral(".glint"));
  lock_ = std::make_unique<QLockFile>(lockOf(file_));
  lock_->setStaleLockTime(0);  // held for as long as the program runs
  lock_->tryLock(0);
  connect(&document_, &Document::savedStateChanged, this, &Autosave::schedule);
  connect(&document_, &Document::sceneOpened, this, &Autosave::schedule);
  connect(&document_, &Document::tradeoffChanged, this, &Autosave::schedule);
}

Autosave::~Autosave() {
  jobs_.close();
  QFile::remove(file_);  // ended in order: what is not saved was given up
}

void Autosave::schedule() {
  if (!engine_.autosave) return;
  std::shared_ptr<const Opened> state;
  if (document_.hasUnsavedChanges()) state = std::make_shared<const Opened>(snapshot_());
  const auto work = [this, state](const JobToken&) {
    state ? engine_.autosave(*state, file_.toStdString()) : void(QFile::remove(file_));
  };
  const auto done = [this](const JobResult<void>& result) {
    if (!result.failure().isEmpty() && !std::exchange(reported_, true))
      emit problem(tr("Changes cannot be recovered after a crash: %1").arg(result.failure()));
  };
  jobs_.start(work, done, Asks::Newest);
}

std::optional<Autosave::Found> Autosave::leftBehind() const {
  // The newest first; what another running program holds is its own.
  for (const QFileInfo& info : QDir(folder_).entryInfoList({QStringLiteral("*.glint")}, QDir::Files, QDir::Time)) {
    if (info.absoluteFilePath() == QFileInfo(file_).absoluteFilePath()) continue;
    QLockFile lock(lockOf(info.absoluteFilePath()));
    lock.setStaleLockTime(0);
    if (!lock.tryLock(0)) continue;
    Found found{info.absoluteFilePath(), {}, info.lastModified()};
    try {
      if (const Session session = readSession(found.file.toStdString()); session.recovery)
        found.of = exactQString(session.recovery->of.string());
    } catch (const std::exception&) {
      continue;  // not ours, or cut: nothing to offer
    }
    return found;
  }
  return std::nullopt;
}

void Autosave::discard(const Found& found) {
  QFile::remove(found.file);
  QFile::remove(lockOf(found.file));
}

}  // namespace glint::gui
