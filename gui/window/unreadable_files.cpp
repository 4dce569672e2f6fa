// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/unreadable_files.h"

#include <QAction>
#include <QDialog>
#include <QDialogButtonBox>
#include <QFileDialog>
#include <QMenu>
#include <QMessageBox>
#include <QPushButton>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <optional>

#include "core/app/session.h"
#include "gui/base/text.h"
#include "gui/base/tips.h"
#include "gui/window/file_actions.h"
#include "gui/window/message_bar.h"

namespace glint::gui {

namespace {
constexpr int kNamed = 2;  // on the message bar; the list has all

/// Frames whose photograph and mask the pipeline has decoded, so that their files need not be read again.
bool decoded(const Inspection& in, std::size_t frame) {
  const Frame& f = in.given->frames[frame];
  return f.highlights.empty() && !in.request.whatIf.synthesise && (f.radiance.empty() || f.image.empty()) &&
         !in.evidence[frame].failure;
}

QString counted(FrameFile kind, int n) {
  const QString number = QString::number(n) + QLatin1Char(' ');
  switch (kind) {
    case FrameFile::Photograph: return number + (n == 1 ? UnreadableFiles::tr("photograph") : UnreadableFiles::tr("photographs"));
    case FrameFile::Depth: return number + (n == 1 ? UnreadableFiles::tr("depth map") : UnreadableFiles::tr("depth maps"));
    case FrameFile::Normals: return number + (n == 1 ? UnreadableFiles::tr("normal map") : UnreadableFiles::tr("normal maps"));
    case FrameFile::Mask: return number + (n == 1 ? UnreadableFiles::tr("mask") : UnreadableFiles::tr("masks"));
  }
  return number;
}

QString named(FrameFile kind) { return counted(kind, 2).mid(2); }

/// "photographs, depth maps and masks".
QString listed(QStringList parts, const QString& last) {
  if (parts.size() < 2) return parts.join(QString());
  const QString end = parts.takeLast();
  return parts.join(QStringLiteral(", ")) + last + end;
}
}  // namespace

UnreadableFiles::UnreadableFiles(Document& document, MessageBar& bar,
                                 std::function<void(const std::shared_ptr<const Opened>&)> reopen, QWidget* window)
    : QObject(window), document_(document), bar_(bar), reopen_(std::move(reopen)), window_(window) {
  connect(&document_, &Document::sceneOpened, this, &UnreadableFiles::forget);
  connect(&document_, &Document::inspectionChanged, this, &UnreadableFiles::check);
}

QMap<int, QString> UnreadableFiles::all(FrameFile kind) const {
  const auto it = all_.find(kind);
  return it == all_.end() ? QMap<int, QString>() : it->second;
}

int UnreadableFiles::count() const {
  int n = 0;
  for (const auto& [kind, lines] : all_) n += lines.size();
  return n;
}

std::set<FrameFile> UnreadableFiles::kinds() const {
  std::set<FrameFile> kinds;
  for (const auto& [kind, lines] : all_) kinds.insert(kind);
  return kinds;
}

void UnreadableFiles::addActions(Actions& actions, QMenu* menu) {
  // Its id is from when there were only photographs: the user's own shortcuts go by it.
  QAction* action = actions.add(
      "file.unreadable-photographs", menu, tr("&Unreadable files…"), [this] { showList(); },
      {{}, {}, tr("Photographs, depth maps, normal maps and masks that cannot be read, with reasons; locates them elsewhere")});
  enable_ = [this, action] { action->setEnabled(!all_.empty()); };
  connect(this, &UnreadableFiles::changed, action, enable_);
  enable_();
}

void UnreadableFiles::forget() {
  job_.drop();
  search_.drop();
  all_.clear();
  said_.clear();
  checked_.reset();
  tried_.clear();
  delete list_;
  emit changed();
}

void UnreadableFiles::check() {
  const std::shared_ptr<const Inspection> in = document_.inspection();
  if (!in || in->given != document_.sharedScene()) return;
  FrameFileProblems found;
  const auto look = [&](int frame, const Failure* failure, std::optional<FrameFile> usual) {
    if (!failure || failure->reason != Reason::FrameUnreadable) return;
    if (const auto kind = fileNamedIn(failure->detail, in->given->frames[std::size_t(frame)]); kind || usual)
      found[kind ? *kind : *usual].emplace(frame, failure->detail);
  };
  for (std::size_t i = 0; i < in->evidence.size(); ++i) {
    const std::optional<Failure>& failure = in->evidence[i].failure;
    look(int(i), failure ? &*failure : nullptr, FrameFile::Photograph);
  }
  for (const TrainingView& view : in->views) look(view.frame, view.seen ? nullptr : &view.seen.failure(), {});
  for (const auto& [name, model] : in->models)
    for (const FrameComparison& c : model.frames) look(c.frame, c.prediction.failure(), {});
  add(found);
  if (checked_ == in->given) return;
  checked_ = in->given;
  FrameFileProblems known = found;
  for (std::size_t i = 0; i < in->evidence.size(); ++i)
    if (decoded(*in, i))
      for (const FrameFile kind : {FrameFile::Photograph, FrameFile::Mask}) known[kind].emplace(int(i), "");
  // Not before the first results: both read the same disk.
  job_.run([this, scene = in->given, known] {
    FrameFileProblems more = frameFileProblems(*scene, known);
    return LatestJob::Deliver([this, scene, more] {
      if (scene == document_.sharedScene()) add(more);
    });
  });
}

void UnreadableFiles::note(int frame, const QString& reason) { add({{FrameFile::Photograph, {{frame, reason.toStdString()}}}}); }

void UnreadableFiles::add(const FrameFileProblems& found) {
  const Scene* scene = document_.scene();
  if (!scene) return;
  const std::string prefix = std::string(nameOf(Reason::FrameUnreadable)) + ": ";
  const int before = count();
  for (const auto& [kind, lines] : found)
    for (const auto& [frame, reason] : lines) {
      if (frame < 0 || frame >= document_.frameCount() || all(kind).contains(frame)) continue;
      const Frame& f = scene->frames[std::size_t(frame)];
      if (kind == FrameFile::Photograph && f.image.empty() && f.radiance.empty()) continue;  // it has none, which is no fault
      all_[kind][frame] = toQString(withoutFolder(reason.rfind(prefix, 0) == 0 ? reason.substr(prefix.size()) : reason, *scene));
    }
  if (count() == before) return;
  emit changed();
  tell();
}

void UnreadableFiles::tell() {
  if (bar_.failed() && bar_.text() != said_) return;  // something else went wrong
  QStringList counts, first;
  for (const auto& [kind, lines] : all_) {
    counts << counted(kind, lines.size());
    for (auto it = lines.begin(); it != lines.end() && first.size() < kNamed; ++it) first << it.value();
  }
  said_ = tr("Cannot read %1: %2").arg(listed(counts, tr(" and ")), first.join(QStringLiteral("; ")));
  if (count() > first.size()) said_ += tr("; and %1 more").arg(count() - first.size());
  bar_.showError(said_, {{tr("List…"), [this] { showList(); }}, {tr("Locate…"), [this] { locate(); }}});
}

void UnreadableFiles::showList() {
  if (all_.empty() || !document_.scene()) return;
  if (list_) return list_->raise();
  list_ = new QDialog(window_);
  list_->setObjectName(QStringLiteral("unreadableFiles"));
  list_->setAttribute(Qt::WA_DeleteOnClose);
  list_->setWindowTitle(tr("Unreadable files"));
  auto* column = new QVBoxLayout(list_);
  auto* rows = new QTreeWidget;
  rows->setAccessibleName(tr("Unreadable files"));
  rows->setHeaderLabels({tr("Frame"), tr("File and reason")});
  rows->setRootIsDecorated(false);
  rows->setAlternatingRowColors(true);
  for (const auto& [kind, lines] : all_)
    for (auto it = lines.begin(); it != lines.end(); ++it) {
      auto* row = new QTreeWidgetItem(rows, {nameText(document_.scene()->frames[std::size_t(it.key())].id), it.value()});
      row->setData(0, Qt::UserRole, it.key());
      row->setToolTip(1, plainTip(it.value()));
    }
  rows->resizeColumnToContents(0);
  connect(rows, &QTreeWidget::itemClicked, this,
          [this](const QTreeWidgetItem* row) { document_.selectFrame(row->data(0, Qt::UserRole).toInt()); });
  column->addWidget(rows);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
  QPushButton* find = buttons->addButton(tr("Locate…"), QDialogButtonBox::ActionRole);
  find->setToolTip(tr("Looks in another folder for all files of these kinds, by name"));
  connect(find, &QPushButton::clicked, this, &UnreadableFiles::locate);
  connect(buttons, &QDialogButtonBox::rejected, list_.data(), &QDialog::close);
  column->addWidget(buttons);
  list_->resize(720, 320);
  list_->show();
}

void UnreadableFiles::locate() {
  if (!document_.scene() || all_.empty()) return;
  QStringList kinds;
  for (const auto& [kind, lines] : all_) kinds << named(kind);
  const QString folder = QFileDialog::getExistingDirectory(window_, tr("Where are the %1?").arg(listed(kinds, tr(" and "))),
                                                           exactQString(document_.scene()->folder.string()));
  if (!folder.isEmpty()) locateIn(folder);
}

void UnreadableFiles::locateIn(const QString& folder) { locateIn(folder, kinds()); }

void UnreadableFiles::locateIn(const QString& folder, const std::set<FrameFile>& kinds) {
  const std::shared_ptr<const Scene> scene = document_.sharedScene();
  if (!scene) return;
  ByKind bad;
  for (const FrameFile kind : kinds) bad[kind] = all(kind);
  // A file system may be slow.
  search_.run([this, scene, folder, kinds, bad] {
    const std::filesystem::path there = folder.toStdString();
    if (const std::set<FrameFile> either = ambiguousIn(*scene, kinds, there); !either.empty())
      return LatestJob::Deliver([this, scene, folder, either] {
        if (scene == document_.sharedScene()) askWhich(folder, either);
      });
    auto moved = std::make_shared<Scene>(*scene);
    int files = 0, mended = 0, wanted = 0;
    for (const auto& [kind, lines] : bad) {
      int found = 0;
      *moved = withFilesIn(std::move(*moved), kind, there, &found);
      files += found;
      wanted += lines.size();
      for (const int frame : lines.keys()) mended += frameFileProblem(moved->frames[std::size_t(frame)], kind).empty();
    }
    return LatestJob::Deliver([this, scene, moved, folder, files, mended, wanted, kinds] {
      if (scene != document_.sharedScene()) return;
      QStringList names;
      for (const FrameFile kind : kinds) names << named(kind);
      const QString what = listed(names, tr(" and "));
      if (mended == 0)
        return void(emit problem(files == 0 ? tr("%1 contains no %2 of this scene").arg(folder, listed(names, tr(" or ")))
                                            : tr("%1 contains none of the unreadable %2").arg(folder, what)));
      reopen(moved, document_.toSave().session, "");
      emit message(tr("Found %1 of %2 unreadable %3 in %4").arg(mended).arg(wanted).arg(what, folder));
    });
  });
}

void UnreadableFiles::reopen(const std::shared_ptr<const Scene>& scene, const std::shared_ptr<const Session>& session,
                             const std::string& warning) {
  auto state = std::make_shared<Opened>(document_.toSave());
  state->isSession = !state->path.empty();
  if (!state->isSession) state->path = document_.inputFile().toStdString();
  state->unsaved = true;
  state->scene = scene;
  state->session = session;
  state->warning = warning;
  reopen_(state);
}

bool UnreadableFiles::offerMesh(const QString& oneLine) {
  if (!document_.scene()) return false;
  std::string named = meshNamedIn(oneLine.toStdString(), *document_.scene());
  if (!tried_.isEmpty() && oneLine.startsWith(tried_ + QStringLiteral(": "))) named = triedFor_;  // it was not the right file
  if (!named.empty()) offerMesh(oneLine, named);
  return !named.empty();
}

void UnreadableFiles::offerMesh(const QString& oneLine, const std::string& named) {
  bar_.showError(oneLine, {{tr("Locate…"), [this, oneLine, named] {
                              const QString folder =
                                  document_.scene() ? exactQString(document_.scene()->folder.string()) : QString();
                              const QString now = FileActions::whereIs(exactQString(named), true, folder, window_);
                              if (now.isEmpty())
                                offerMesh(oneLine, named);
                              else
                                locateMesh(named, now.toStdString());
                            }}});
}

void UnreadableFiles::locateMesh(const std::string& named, const std::filesystem::path& now) {
  const std::shared_ptr<const Scene> scene = document_.sharedScene();
  if (!scene) return;
  tried_ = exactQString(now.string());
  triedFor_ = named;
  const auto work = [this, scene, named, now, session = document_.toSave().session] {
    readMesh(now);  // what is no mesh must not take the place of what is open
    const auto moved = std::make_shared<const Scene>(withMeshAt(*scene, named, now));
    const auto knows = session ? std::make_shared<Session>(*session) : nullptr;
    const std::string warning = knows ? relinkMeshes(*knows, *moved) : "";
    return LatestJob::Deliver([this, scene, moved, knows, warning] {
      if (scene == document_.sharedScene()) reopen(moved, knows, warning);
    });
  };
  search_.run(work, [this](const QString& failure) { emit problem(failure); });
}

void UnreadableFiles::askWhich(const QString& folder, const std::set<FrameFile>& kinds) {
  QStringList names;
  for (const FrameFile kind : kinds) names << named(kind);
  auto* question =
      new QMessageBox(QMessageBox::Question, tr("Which kind of file?"),
                      tr("%1 contains files that could be %2: they have the same names.").arg(folder, listed(names, tr(" or "))),
                      QMessageBox::Cancel, window_);
  question->setObjectName(QStringLiteral("whichFiles"));
  question->setAttribute(Qt::WA_DeleteOnClose);
  for (const FrameFile kind : kinds) {
    QString title = named(kind);
    title[0] = title[0].toUpper();
    connect(question->addButton(title, QMessageBox::AcceptRole), &QPushButton::clicked, this,
            [this, folder, kind] { locateIn(folder, {kind}); });
  }
  question->open();
}

}  // namespace glint::gui
