// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QRect>
#include <QString>
#include <functional>

class QWidget;

namespace glint::gui {

/// Things in a picture that can be chosen one by one, such as the frames of a strip. Only screen readers ask for them.
struct PictureParts {
  std::function<int()> count;
  std::function<QString(int part)> name;
  std::function<QRect(int part)> place;  ///< in the widget's coordinates; empty if it is out of sight
  std::function<int()> selected;         ///< -1 = none
  std::function<void(int part)> choose;
};

/// Makes a painted widget tell screen readers what it is and shows, in words; else they report an empty area.
/// @param name   what it is, unless the widget has an accessible name of its own
/// @param words  what it shows by now; asked for only while a screen reader listens
void describePicture(QWidget* picture, const QString& name, std::function<QString()> words, PictureParts parts = {});

/// Another part of the picture is selected: said if a screen reader listens and the picture has the keyboard.
void announceSelection(QWidget* picture);

}  // namespace glint::gui
