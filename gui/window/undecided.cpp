// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/undecided.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QInputDialog>
#include <QObject>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr int kMostButtons = 4;  // as many as a line has room for; a dialog offers the others

using Question = UndecidedInput::Question;
using Open = std::function<void(const QString& path, const Relinked&)>;

/// The options of the command line check and keep what a person says.
void answer(const UndecidedPtr& undecided, const std::string& value, const Open& open) {
  Relinked with = undecided->instead;
  if (undecided->option.empty()) return open(exactQString(value), with);
  for (const ChoiceOption& option : choiceOptions())
    if (undecided->option == option.flag) option.set(with.choices, value);
  open(undecided->path, with);
}

QString titleOf(const UndecidedInput::Answer& answer, Question question) {
  const QString words = toQString(answer.words.empty() ? answer.value : answer.words);
  return question == Question::Reading ? QObject::tr("Open %1").arg(words) : words;
}

// Each asks for an answer and opens with it; false if the user gives none.

/// @param filter  as QFileDialog takes it
bool chooseFile(const UndecidedPtr& undecided, QWidget* window, const QString& title, const QString& filter, const Open& open) {
  const QFileInfo input(undecided->path);
  const QString file = QFileDialog::getOpenFileName(window, title, input.isDir() ? undecided->path : input.path(), filter);
  if (file.isEmpty()) return false;
  answer(undecided, file.toStdString(), open);
  return true;
}

bool chooseMesh(const UndecidedPtr& undecided, QWidget* window, const Open& open) {
  return chooseFile(undecided, window, QObject::tr("Mesh of the object"),
                    QObject::tr("Meshes (*.ply *.obj *.stl *.gltf *.glb);;All files (*)"), open);
}

bool choosePoses(const UndecidedPtr& undecided, QWidget* window, const Open& open) {
  return chooseFile(undecided, window, QObject::tr("Poses of the cameras: TUM lines, or JSON lines with camera_from_world"),
                    QObject::tr("Poses (*.txt *.tum *.json *.jsonl);;All files (*)"), open);
}

bool enterCamera(const UndecidedPtr& undecided, QWidget* window, const Open& open) {
  QString text;
  for (;;) {
    bool entered = false;
    text = QInputDialog::getText(window, QObject::tr("Intrinsics of the camera"),
                                 QObject::tr("fx,fy,cx,cy or fx,fy,cx,cy,k1,k2,p1,p2,k3 in pixels;\n"
                                             "(0,0) is the centre of the first pixel"),
                                 QLineEdit::Normal, text, &entered);
    if (!entered) return false;
    try {
      answer(undecided, text.remove(' ').toStdString(), open);
      return true;
    } catch (const InputError&) {
      continue;  // the text stays, to be corrected
    }
  }
}

bool chooseAnswer(const UndecidedPtr& undecided, QWidget* window, const Open& open) {
  QStringList titles;
  for (const UndecidedInput::Answer& a : undecided->answers) titles << titleOf(a, undecided->question);
  bool chosen = false;
  const QString title = QInputDialog::getItem(window, QObject::tr("Open"), QObject::tr("Which one?"), titles, 0, false, &chosen);
  if (!chosen) return false;
  answer(undecided, undecided->answers[std::size_t(titles.indexOf(title))].value, open);
  return true;
}

/// @param cancelled  called where the user gives none
MessageBar::Answers answersTo(const UndecidedPtr& undecided, QWidget* window, const Open& open,
                              const std::function<void()>& cancelled) {
  MessageBar::Answers answers;
  const auto ask = [=](bool (*question)(const UndecidedPtr&, QWidget*, const Open&)) {
    return [=] {
      if (!question(undecided, window, open)) cancelled();
    };
  };
  if (undecided->answers.size() > kMostButtons) {
    answers << std::pair(QObject::tr("Choose…"), ask(chooseAnswer));
  } else {
    for (const UndecidedInput::Answer& a : undecided->answers)
      answers << std::pair(titleOf(a, undecided->question), [=, value = a.value] { answer(undecided, value, open); });
  }
  if (undecided->question == Question::Surface) answers << std::pair(QObject::tr("Choose mesh…"), ask(chooseMesh));
  if (undecided->question == Question::Poses) answers << std::pair(QObject::tr("Choose poses…"), ask(choosePoses));
  if (undecided->question == Question::Camera) answers << std::pair(QObject::tr("Enter intrinsics…"), ask(enterCamera));
  return answers;
}
}  // namespace

void askIn(MessageBar& bar, const QString& oneLine, const UndecidedPtr& undecided, QWidget* window, const Open& open) {
  const auto again = [&bar, oneLine, undecided, window, open] { askIn(bar, oneLine, undecided, window, open); };
  bar.showError(oneLine, answersTo(undecided, window, open, again));
}

}  // namespace glint::gui
