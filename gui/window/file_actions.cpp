// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/file_actions.h"

#include <QDir>
#include <QEventLoop>
#include <QFileDialog>
#include <QFileInfo>
#include <QMenu>
#include <QMessageBox>
#include <QMimeData>
#include <QPushButton>
#include <QSettings>
#include <QStandardPaths>
#include <QUrl>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/permitted.h"
#include "core/scene/scene_files.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/document/allowed_folders.h"
#include "gui/document/figure.h"
#include "gui/document/own_files.h"

namespace glint::gui {

namespace {
constexpr int kRecent = 8;
const QString kRecentKey = QStringLiteral("recent");
constexpr int kFoldersAbove = 3;  // a photograph lies that deep in its scene's folder at most

/// The frame whose picture (photograph, radiance, depth, normals or mask) a file is; -1 = none.
int frameOfPicture(const Scene& scene, const QString& file) {
  std::error_code ignored;
  const std::filesystem::path wanted = std::filesystem::weakly_canonical(file.toStdString(), ignored);
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const Frame& f = scene.frames[i];
    for (const std::filesystem::path* path : {&f.image, &f.radiance, &f.depth, &f.normals, &f.mask})
      if (path->filename() == wanted.filename() && std::filesystem::weakly_canonical(*path, ignored) == wanted) return int(i);
  }
  return -1;
}

bool isPicture(const QString& path) {
  static const QStringList endings{"png", "jpg", "jpeg", "tif", "tiff", "exr", "bmp"};
  return QFileInfo(path).isFile() && endings.contains(QFileInfo(path).suffix().toLower());
}
}  // namespace

FileActions::FileActions(const Engine& engine, Document& document, Runner& runner, QWidget* window)
    : QObject(window), engine_(engine), document_(document), runner_(runner), window_(window), rules_(document, window) {
  connect(&runner_, &Runner::opened, this, &FileActions::finishOpen);
  connect(&runner_, &Runner::saved, this, &FileActions::finishSave);
}

void FileActions::addActions(Actions& actions, QMenu* menu) {
  actions.add("file.open", menu, tr("&Open…"), [this] { openDialog(); }, {{QKeySequence::Open}, "open"});
  actions.add("file.open-folder", menu, tr("Open &folder…"), [this] { openFolderDialog(); });
  QMenu* recentMenu = menu->addMenu(tr("Open &recent"));
  connect(recentMenu, &QMenu::aboutToShow, this, [this, recentMenu] {
    recentMenu->clear();
    for (const QString& path : recent()) recentMenu->addAction(menuText(shownText(path)), this, [this, path] { open(path); });
    if (recentMenu->isEmpty()) recentMenu->addAction(tr("none"))->setEnabled(false);
  });
  menu->addSeparator();
  QAction* save = actions.add("file.save", menu, tr("&Save session"), [this] { this->save(); }, {{QKeySequence::Save}, "save"});
  QAction* saveAs = actions.add("file.save-as", menu, tr("Save session &as…"), [this] { this->saveAs(); },
                                {{QKeySequence(Qt::CTRL | Qt::SHIFT | Qt::Key_S)}});
  const auto enable = [=, this] {
    save->setEnabled(document_.scene() && engine_.save);
    saveAs->setEnabled(document_.scene() && engine_.save);
  };
  connect(&document_, &Document::sceneOpened, save, enable);
  enable();
}

QStringList FileActions::recent() const { return QSettings().value(kRecentKey).toStringList(); }

void FileActions::remember(const QString& path) {
  QStringList all = recent();
  const QString absolute = QFileInfo(path).absoluteFilePath();
  all.removeAll(absolute);
  all.prepend(absolute);
  QSettings().setValue(kRecentKey, QStringList(all.mid(0, kRecent)));
  emit recentChanged();
}

QString FileActions::dropped(const QMimeData* data) {
  for (const QUrl& url : data->urls())
    if (url.isLocalFile()) return url.toLocalFile();
  return {};
}

void FileActions::drop(const QString& path) {
  if (path.isEmpty()) return;
  if (!isPicture(path) || !sessionInFigure(path).isEmpty()) return open(path);
  if (document_.scene())
    if (const int frame = frameOfPicture(*document_.scene(), path); frame >= 0) return document_.selectFrame(frame);
  QDir folder = QFileInfo(path).absoluteDir();
  for (int up = 0; up < kFoldersAbove; ++up) {
    const QString scene = folder.filePath(QStringLiteral("scene.json"));
    if (QFileInfo::exists(scene) && document_.inputFile() != scene) {
      photographToSelect_ = path;
      return open(scene);
    }
    if (!folder.cdUp()) break;
  }
  emit problem(
      tr("%1 is neither a photograph of a frame nor a figure with a session").arg(shownText(QFileInfo(path).fileName())));
}

bool FileActions::mayDiscard() {
  waitForSave();
  if (!document_.hasUnsavedChanges() || isOpenLesson(document_)) return true;
  QMessageBox question(QMessageBox::Question, tr("Unsaved changes"), tr("This session has unsaved changes."),
                       QMessageBox::Discard | QMessageBox::Cancel, window_);
  question.setObjectName(QStringLiteral("unsavedQuestion"));
  if (engine_.save) question.addButton(QMessageBox::Save);
  // What came with the program is never written: this leads to the question for a name.
  if (engine_.save && (document_.sessionFile().isEmpty() || isShipped(document_.sessionFile())))
    question.button(QMessageBox::Save)->setText(tr("Save as…"));
  question.setDefaultButton(engine_.save ? QMessageBox::Save : QMessageBox::Cancel);
  const int answer = question.exec();
  if (answer == QMessageBox::Save) return save() && waitForSave();
  return answer == QMessageBox::Discard;
}

void FileActions::openDialog() {
  const QString path = QFileDialog::getOpenFileName(window_, tr("Open scene or session"), document_.inputFile(),
                                                    tr("Scenes, sessions and figures (*.json *.glint *.png);;All files (*)"));
  if (!path.isEmpty()) open(path);
}

void FileActions::openFolderDialog() {
  // The dialog would take a file's name for that of a folder, which does not exist.
  const QString now = document_.inputFile();
  const QString path = QFileDialog::getExistingDirectory(window_, tr("Open scene folder"),
                                                         now.isEmpty() ? QString() : QFileInfo(now).absolutePath());
  if (!path.isEmpty()) open(path);
}

void FileActions::open(const QString& path) {
  if (!mayDiscard()) return;
  allowedFor_.clear();
  run(path, {});
}

void FileActions::openWritten(const QString& file) {
  rememberFoldersOf(file);
  open(file);
}

void FileActions::openRecovered(const QString& file, const QString& of) {
  if (!mayDiscard()) return;
  allowedFor_ = of;
  run(file, {});
}

void FileActions::allow(const OutsidePtr& outside) {
  if (!mayDiscard()) return;
  allowFolder(allowedFor_.isEmpty() ? outside->path : allowedFor_, exactQString(outside->folder));
  run(outside->path, outside->instead);
}

void FileActions::run(const QString& path, Relinked instead) {
  for (const QString& folder : allowedFolders(allowedFor_.isEmpty() ? path : allowedFor_))
    instead.folders.emplace_back(folder.toStdString());
  runner_.open(path.toStdString(), instead);
}

bool FileActions::openRelinked(const QString& path, const Relinked& instead) {
  if (!mayDiscard()) return false;
  run(path, instead);
  return true;
}

void FileActions::reopen(const OpenedPtr& opened) {
  auto state = std::make_shared<Opened>(*opened);
  state->stamp = stamp_;
  if (addView_) addView_(*state);
  finishOpen(state);
}

QString FileActions::whereIs(const QString& file, bool mesh, const QString& folder, QWidget* window) {
  const QString name = QFileInfo(file).fileName();
  QFileDialog dialog(window, tr("Where is %1?").arg(name), folder,
                     (mesh ? tr("Same name (%1);;Meshes (*.ply *.obj *.stl *.gltf *.glb);;All files (*)")
                           : tr("Same name (%1);;Scenes (*.json);;All files (*)"))
                         .arg(name));
  dialog.setFileMode(QFileDialog::ExistingFile);
  if (dialog.exec() != QDialog::Accepted || dialog.selectedFiles().isEmpty()) return {};
  return dialog.selectedFiles().first();
}

bool FileActions::locate(const MissingPtr& missing) {
  const bool mesh = !missing->named.empty();
  const QFileInfo opened(missing->path);
  const QString answer = whereIs(missing->file, mesh, opened.isDir() ? missing->path : opened.path(), window_);
  if (answer.isEmpty()) return false;
  const std::filesystem::path found = answer.toStdString();
  Relinked instead = missing->instead;
  if (mesh) {
    instead.meshes[missing->named] = found;
    instead.meshFolders.push_back(folderOfMove(missing->file.toStdString(), found));
  } else {
    instead.scene = found;
  }
  return openRelinked(missing->path, instead);
}

void FileActions::finishOpen(const OpenedPtr& opened) {
  try {
    document_.open(*opened);
  } catch (const std::exception& e) {
    emit problem(toQString(e.what()));
    return;
  }
  emit viewOpened(opened);
  stamp_ = opened->stamp;
  rules_.follow(document_.sessionFile(), stamp_);
  remember(exactQString(opened->path));
  if (const QString other = rules_.otherHolder(); !other.isEmpty())
    emit notice(tr("%1 is also open in %2; saving here asks before it overwrites what is saved there")
                    .arg(shownText(QFileInfo(document_.sessionFile()).fileName()), other));
  if (!opened->notice.empty()) emit notice(toQString(opened->notice));
  if (!opened->warning.empty()) emit problem(toQString(opened->warning));
  for (const auto& [named, mesh] : opened->scene->meshes)
    emit message(tr("Using %2 for the mesh %1").arg(toQString(named), toQString(mesh.string())));
  for (const std::string& warning : opened->scene->warnings) emit message(toQString(warning));
  if (const QString picture = std::exchange(photographToSelect_, {}); !picture.isEmpty()) {
    const int frame = frameOfPicture(*opened->scene, picture);
    if (frame >= 0) return document_.selectFrame(frame);
    emit problem(
        tr("%1 is not a photograph of a frame of %2").arg(shownText(QFileInfo(picture).fileName()), toQString(opened->path)));
  }
  if (frameToSelect_.isEmpty()) return;
  const std::string wanted = frameToSelect_.toStdString();
  frameToSelect_.clear();
  const std::vector<Frame>& frames = opened->scene->frames;
  for (int i = 0; i < int(frames.size()); ++i)
    if (frames[std::size_t(i)].id == wanted) return document_.selectFrame(i);
  bool isNumber = false;
  const int number = toQString(wanted).toInt(&isNumber);
  if (isNumber && number >= 0 && number < int(frames.size()))
    document_.selectFrame(number);
  else
    emit problem(toQString(InputError(opened->path, "--frame", "no frame '" + wanted + "'").what()));
}

bool FileActions::save() {
  if (!document_.scene()) return false;
  QString refusal;
  const SaveRules::Answer answer = rules_.toOwnFile(refusal);
  if (!refusal.isEmpty()) emit problem(refusal);
  if (answer == SaveRules::Answer::SaveAs) return saveAs();
  return answer == SaveRules::Answer::Write && saveTo(document_.sessionFile());
}

bool FileActions::saveAs() {
  if (!document_.scene()) return false;
  const QFileInfo now(document_.sessionFile().isEmpty() ? document_.inputFile() : document_.sessionFile());
  // Beside the scene, unless that came with the program.
  const QString folder = isShipped(now.absoluteFilePath()) ? QStandardPaths::writableLocation(QStandardPaths::DocumentsLocation)
                                                           : now.absolutePath();
  const QString base = now.fileName() == QLatin1String("scene.json") ? now.dir().dirName() : now.completeBaseName();
  const QString path =
      QFileDialog::getSaveFileName(window_, tr("Save session"), QDir(folder).filePath(base + QStringLiteral(".glint")),
                                   tr("Sessions (*.glint)"), nullptr, QFileDialog::DontConfirmOverwrite);
  return !path.isEmpty() && saveAsTo(path);
}

bool FileActions::saveAsTo(QString path) {
  if (!document_.scene()) return false;
  if (QFileInfo(path).suffix().isEmpty()) path += QStringLiteral(".glint");
  QString refusal;
  const SaveRules::Answer answer = rules_.toChosenFile(path, refusal);
  if (!refusal.isEmpty()) emit problem(refusal);
  if (answer == SaveRules::Answer::SaveAs) return saveAs();
  return answer == SaveRules::Answer::Write && saveTo(path);
}

/// A written session or scene names what is on screen, which a person opened or pointed at: it opens again without a question.
void FileActions::rememberFoldersOf(const QString& session) {
  const Scene& scene = *document_.scene();
  std::vector<std::filesystem::path> named;
  for (const FilesFolder& f : scene.folders) named.push_back(f.folder);
  for (const auto& [name, mesh] : scene.meshes) named.push_back(mesh.parent_path());
  if (!document_.request().truthFolder.empty()) named.emplace_back(document_.request().truthFolder);
  for (const std::filesystem::path& file : filesOf(scene)) named.push_back(file.parent_path());
  const std::vector<std::filesystem::path> own{QFileInfo(session).absolutePath().toStdString(), scene.folder};
  std::set<std::filesystem::path> outside;
  for (const std::filesystem::path& folder : std::set<std::filesystem::path>(named.begin(), named.end()))
    if (!liesIn(own, folder)) outside.insert(realPath(folder));
  for (const std::filesystem::path& folder : outside) allowFolder(session, exactQString(folder.string()));
}

bool FileActions::saveTo(const QString& path) {
  if (savingScene_) return false;  // one after the other
  const InspectionPtr results = document_.stale() ? nullptr : document_.computed();
  auto opened = std::make_shared<Opened>(document_.toSave());
  if (addView_) addView_(*opened);
  savingScene_ = document_.sharedScene();
  saving_ = document_.state();
  savingTradeoff_ = document_.tradeoff();
  savingResults_ = results != nullptr;
  runner_.save(opened, results, path.toStdString());
  return true;
}

void FileActions::finishSave(const QString& path, const QString& problem) {
  saveWorked_ = problem.isEmpty();
  if (saveWorked_) {
    if (savingScene_ == document_.sharedScene()) {  // else another scene was opened meanwhile
      document_.markSaved(path, saving_, savingTradeoff_);
      stamp_ = stampOf(path);
      rules_.follow(path, stamp_);
      rememberFoldersOf(path);
    }
    remember(path);
    emit message(
        (savingResults_ ? tr("Saved %1") : tr("Saved %1 without results: results are out of date")).arg(shownText(path)));
  } else {
    emit this->problem(problem);
  }
  savingScene_.reset();
  emit saveEnded();
}

bool FileActions::waitForSave() {
  if (!savingScene_) return saveWorked_;
  QEventLoop loop;  // the window keeps painting and shows the progress
  connect(this, &FileActions::saveEnded, &loop, &QEventLoop::quit);
  window_->setEnabled(false);
  loop.exec(QEventLoop::ExcludeUserInputEvents);
  window_->setEnabled(true);
  return saveWorked_;
}

}  // namespace glint::gui
