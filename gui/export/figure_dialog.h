// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDialog>
#include <QSize>
#include <QString>

class QCheckBox;
class QComboBox;
class QFormLayout;
class QLineEdit;
class QPushButton;

namespace glint::gui {

class NumberBox;

/// How a picture leaves the program.
struct FigureLook {
  QSize size{1600, 1000};  ///< px
  bool transparent = false;
  bool dark = true;      ///< bright lines and texts, for a dark background or page
  int dpi = 96;          ///< px per inch of paper
  QString caption = {};  ///< below the figure, within `size`; "" = none
};

/// Asks for the size (px, or mm at a resolution) and the background of a picture or plot. Remembers the last answer of each kind,
/// with a typed size in the shape of what is shown now. Colours start for a light page, whatever the window's are: figures are
/// mostly printed.
class FigureDialog : public QDialog {
  Q_OBJECT
 public:
  /// @param kind      "scene": under this name the answer is remembered.
  /// @param onScreen  device px of what is shown.
  FigureDialog(const QString& title, const QString& kind, const QSize& onScreen, QWidget* parent);
  FigureLook look() const;
  /// Serves pictures that cannot have a transparent background.
  void setOpaque();
  /// Offers a caption; the field stays empty.
  void proposeCaption(const QString& caption);
  void accept() override;

 private:
  void choose(int preset);
  void setSize(const QSize& size);
  QSize typedSizeFor(const QSize& picture) const;
  void followWidth();
  void followHeight();
  void followBackground();
  void addPrinted(QFormLayout* form);
  void addCaption(QFormLayout* form);
  void showPrinted();

  QString kind_;
  QSize onScreen_;
  double aspect_ = 1.6;
  QComboBox *preset_, *colours_;
  NumberBox *width_, *height_, *printed_, *dpi_;
  QCheckBox *keepShape_, *transparent_;
  QLineEdit* caption_;
  QPushButton* propose_;
};

}  // namespace glint::gui
