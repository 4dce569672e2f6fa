// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/unreadable_photographs.h"

#include <QAction>
#include <QDialog>
#include <QDialogButtonBox>
#include <QFileDialog>
#include <QLabel>
#include <QMenu>
#include <QPushButton>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <utility>

#include "core/scene/photographs.h"
#include "gui/base/text.h"
#include "gui/window/message_bar.h"

namespace glint::gui {

namespace {
constexpr int kNamed = 2;  // on the message bar; the list has all

/// Frames whose photograph the pipeline has decoded, so that nobody needs to look at their files again.
bool decoded(const Inspection& in, std::size_t frame) {
  const Frame& f = in.given->frames[frame];
  return f.highlights.empty() && !in.request.whatIf.synthesise &&
         (f.radiance.empty() || f.image.empty() || in.request.source == FrameSource::Image) && !in.evidence[frame].failure;
}
}  // namespace

UnreadablePhotographs::UnreadablePhotographs(Document& document, MessageBar& bar,
                                             std::function<void(const std::shared_ptr<const Opened>&)> reopen, QWidget* window)
    : QObject(window), document_(document), bar_(bar), reopen_(std::move(reopen)), window_(window) {
  connect(&document_, &Document::sceneOpened, this, &UnreadablePhotographs::forget);
  connect(&document_, &Document::inspectionChanged, this, &UnreadablePhotographs::check);
}

void UnreadablePhotographs::addActions(Actions& actions, QMenu* menu) {
  QAction* action = actions.add("file.unreadable-photographs", menu, tr("Photographs that cannot be &read…"),
                                [this] { showList(); }, {{}, {}, tr("Which frames have none, why, and where they are instead")});
  enable_ = [this, action] { action->setEnabled(!all_.isEmpty()); };
  connect(this, &UnreadablePhotographs::changed, action, enable_);
  enable_();
}

void UnreadablePhotographs::forget() {
  job_.drop();
  search_.drop();
  all_.clear();
  said_.clear();
  checked_.reset();
  delete list_;
  emit changed();
}

void UnreadablePhotographs::check() {
  const std::shared_ptr<const Inspection> in = document_.inspection();
  if (!in || in->given != document_.sharedScene()) return;
  std::map<int, std::string> found, known;
  for (std::size_t i = 0; i < in->evidence.size(); ++i) {
    const std::optional<Failure>& failure = in->evidence[i].failure;
    if (failure && failure->reason == Reason::FrameUnreadable) found[int(i)] = failure->detail;
    if (decoded(*in, i)) known[int(i)];
  }
  add(found);
  known.insert(found.begin(), found.end());
  if (checked_ == in->given) return;
  checked_ = in->given;
  // Not before the first results: both read the same disk.
  job_.run([this, scene = in->given, known] {
    std::map<int, std::string> more = photographProblems(*scene, known);
    return LatestJob::Deliver([this, scene, more] {
      if (scene == document_.sharedScene()) add(more);
    });
  });
}

void UnreadablePhotographs::note(int frame, const QString& reason) { add({{frame, reason.toStdString()}}); }

void UnreadablePhotographs::add(const std::map<int, std::string>& found) {
  const Scene* scene = document_.scene();
  if (!scene) return;
  const std::string named = std::string(nameOf(Reason::FrameUnreadable)) + ": ";
  const int before = all_.size();
  for (const auto& [frame, reason] : found) {
    if (frame < 0 || frame >= document_.frameCount() || all_.contains(frame)) continue;
    const Frame& f = scene->frames[std::size_t(frame)];
    if (f.image.empty() && f.radiance.empty()) continue;  // it has none, which is no fault
    all_[frame] = toQString(withoutFolder(reason.rfind(named, 0) == 0 ? reason.substr(named.size()) : reason, *scene));
  }
  if (all_.size() == before) return;
  emit changed();
  tell();
}

void UnreadablePhotographs::tell() {
  if (bar_.waits() && bar_.text() != said_) return;  // something else went wrong
  QStringList named;
  for (auto it = all_.begin(); it != all_.end() && named.size() < kNamed; ++it) named << it.value();
  said_ = tr("%n photograph(s) cannot be read: ", "", all_.size())
              .replace(QStringLiteral("(s)"), all_.size() == 1 ? QString() : QStringLiteral("s")) +
          named.join(QStringLiteral("; "));
  if (all_.size() > named.size()) said_ += tr("; and %1 more").arg(all_.size() - named.size());
  bar_.showError(said_, {{tr("List…"), [this] { showList(); }}, {tr("Locate…"), [this] { locate(); }}});
}

void UnreadablePhotographs::showList() {
  if (all_.isEmpty() || !document_.scene()) return;
  if (list_) return list_->raise();
  list_ = new QDialog(window_);
  list_->setObjectName(QStringLiteral("unreadablePhotographs"));
  list_->setAttribute(Qt::WA_DeleteOnClose);
  list_->setWindowTitle(tr("Photographs that cannot be read"));
  auto* column = new QVBoxLayout(list_);
  auto* rows = new QTreeWidget;
  rows->setHeaderLabels({tr("Frame"), tr("File and reason")});
  rows->setRootIsDecorated(false);
  rows->setAlternatingRowColors(true);
  for (auto it = all_.begin(); it != all_.end(); ++it) {
    auto* row = new QTreeWidgetItem(rows, {toQString(document_.scene()->frames[std::size_t(it.key())].id), it.value()});
    row->setData(0, Qt::UserRole, it.key());
    row->setToolTip(1, it.value());
  }
  rows->resizeColumnToContents(0);
  connect(rows, &QTreeWidget::itemClicked, this,
          [this](const QTreeWidgetItem* row) { document_.selectFrame(row->data(0, Qt::UserRole).toInt()); });
  column->addWidget(rows);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
  QPushButton* find = buttons->addButton(tr("Locate…"), QDialogButtonBox::ActionRole);
  find->setToolTip(tr("Looks for all photographs in another folder, by their names"));
  connect(find, &QPushButton::clicked, this, &UnreadablePhotographs::locate);
  connect(buttons, &QDialogButtonBox::rejected, list_.data(), &QDialog::close);
  column->addWidget(buttons);
  list_->resize(720, 320);
  list_->show();
}

void UnreadablePhotographs::locate() {
  if (!document_.scene()) return;
  const QString folder =
      QFileDialog::getExistingDirectory(window_, tr("Where are the photographs?"), toQString(document_.scene()->folder.string()));
  if (!folder.isEmpty()) locateIn(folder);
}

void UnreadablePhotographs::locateIn(const QString& folder) {
  const std::shared_ptr<const Scene> scene = document_.sharedScene();
  if (!scene) return;
  // A file system may be slow.
  search_.run([this, scene, folder, bad = all_.keys()] {
    int files = 0;
    auto moved = std::make_shared<const Scene>(withPhotographsIn(*scene, folder.toStdString(), &files));
    int mended = 0;
    for (const int frame : bad) mended += photographProblem(moved->frames[std::size_t(frame)]).empty();
    return LatestJob::Deliver([this, scene, moved, folder, files, mended] {
      if (scene != document_.sharedScene()) return;
      if (mended == 0)
        return void(emit problem(files == 0 ? tr("%1 holds no photograph of this scene").arg(folder)
                                            : tr("%1 holds none of the photographs that cannot be read").arg(folder)));
      auto state = std::make_shared<Opened>(document_.toSave());
      state->isSession = !state->path.empty();
      if (!state->isSession) state->path = document_.inputFile().toStdString();
      state->unsaved = true;
      state->scene = moved;
      const int bad = all_.size();
      reopen_(state);
      emit message(tr("%1 of %2 photographs that could not be read are in %3").arg(mended).arg(bad).arg(folder));
    });
  });
}

}  // namespace glint::gui
