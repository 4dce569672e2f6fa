// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/changed_inputs.h"

#include <exception>
#include <set>
#include <string>

#include "core/app/session.h"
#include "core/scene/scene_files.h"
#include "gui/base/text.h"
#include "gui/window/message_bar.h"

namespace glint::gui {

namespace {
constexpr int kNamed = 2;  // on the message bar; the log has all
}

ChangedInputs::ChangedInputs(Document& document, MessageBar& bar, QObject* parent)
    : QObject(parent), document_(document), bar_(bar) {
  connect(&document_, &Document::sceneOpened, this, &ChangedInputs::forget);
  connect(&document_, &Document::inspectionChanged, this, &ChangedInputs::check);
}

void ChangedInputs::forget() {
  job_.drop();
  all_.clear();
  checked_ = false;
}

void ChangedInputs::check() {
  // Not before the first results: both read the same disk.
  if (checked_ || !document_.inspection()) return;
  checked_ = true;
  const std::shared_ptr<const Session> session = document_.toSave().session;
  if (!session || session->files.empty()) return;
  job_.run([this, session, scene = document_.sharedScene()](const JobToken& token) {
    QStringList lines;
    // Files that are missing or were found elsewhere are reported by what needs them.
    std::set<std::string> changed;
    int outside = 0;
    for (const std::filesystem::path& p : filesOf(*scene)) changed.insert(p.string() + ": changed");
    try {
      for (const std::string& line : changedFiles(*session, {}, [&](const StageEvent&) { return token.wanted(); }))
        if (changed.count(line))
          lines << toQString(withoutFolder(line, *scene));
        else if (line.find(": lies outside the folders ") != std::string::npos)
          ++outside;  // neither whether it is there nor what it holds: a session from others must not find out
    } catch (const std::exception& e) {
      lines << toQString(e.what());
    }
    return LatestJob::Deliver([this, lines, outside] {
      if (outside > 0)
        emit message(tr("%1 files outside the folders of the session and its scene are not checked for changes").arg(outside));
      tell(lines);
    });
  });
}

void ChangedInputs::tell(const QStringList& lines) {
  all_ = lines;
  if (all_.isEmpty()) return;
  for (const QString& line : all_) emit message(tr("Since this session was saved: %1").arg(line));
  if (bar_.waits()) return;
  QString named = QStringList(all_.mid(0, kNamed)).join(QStringLiteral("; "));
  if (all_.size() > kNamed) named += tr("; %1 more in the log").arg(all_.size() - kNamed);
  bar_.showNotice(tr("Input files changed since this session was saved; results may differ: %1").arg(named));
}

}  // namespace glint::gui
