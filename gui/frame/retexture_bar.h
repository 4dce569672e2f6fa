// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QLabel>
#include <QTimer>
#include <QWidget>
#include <set>
#include <string>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/frame/retexture_maker.h"

class QComboBox;
class QMenu;
class QSlider;
class QToolButton;

namespace glint::gui {

class FrameCanvas;
class NumberBox;
class PanelScroll;

/// Shows the plotted model's predicted highlight over a texture or a background, or the frame without its highlight, in place of
/// the photograph; what was captured stays left of a line. Follows results, frame, model and options. Options, all
/// "frame/retexture...": "" (off, texture, background, removed), "-texture", "-background" (files, relative to the scene's folder
/// if inside), "-mapping", "-repeat", "-shading", "-albedo" (0 = the texture's mean), "-margin", "-light" ("" = all), "-compare"
/// (share of the width on the left).
class RetextureBar : public QWidget {
  Q_OBJECT
 public:
  /// @param loader  tells whose photograph the canvas shows.
  RetextureBar(Document& document, FrameCanvas& canvas, PhotoLoader& loader, QWidget* parent = nullptr);
  void addActions(Actions& actions, QMenu* menu);
  bool on() const;
  /// Something is being computed or read for it.
  bool busy() const { return refresh_.isActive() || maker_.busy(); }
  /// The text about the picture; the owner places it below the bar.
  QWidget* words() const;
  void setMostWords(int height);  ///< px; the rest scrolls
  /// The picture of the state on screen; null without one, or while a newer one is on its way.
  std::shared_ptr<const Retextured> result() const { return busy() ? nullptr : answer_.result; }
  void setOn(bool on);

 signals:
  void saveRequested();

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void buildRow();
  void buildDetails();
  QComboBox* choice(const char* option, const QString& tip);
  NumberBox* number(const char* option, const QString& title, const QString& tip, const ParamSpec& range, double usual);
  QString chosen() const;  ///< option "frame/retexture"
  RetextureRequest request() const;
  void chooseFile(const QString& base);
  void allow();
  /// Absolute; OutsidePath if a session names it and the user did not allow it; InputError.
  std::string fileOf(const QString& base) const;
  void refresh();
  void showControls();
  void showLights(const std::string& model);
  void ask();
  void showPicture();
  void say(const QString& html);
  void sayAnswer();

  Document& document_;
  FrameCanvas& canvas_;
  PhotoLoader& loader_;
  QComboBox *base_, *mapping_, *shading_, *light_;
  QToolButton *file_, *save_, *more_;
  NumberBox *repeat_, *albedo_, *margin_;
  QSlider* compare_;
  QList<QWidget*> ofTexture_, ofMargin_;
  QLabel* words_;
  PanelScroll* scroll_;
  QAction* toggle_ = nullptr;
  std::set<std::string> picked_;  ///< files that the user chose in this program
  RetextureAnswer answer_;        ///< newest; of frame -1 = none
  int photographOf_ = -1;         ///< frame whose photograph the canvas shows
  bool late_ = false;             ///< the newest picture takes a moment
  int gesture_ = 0;
  QTimer refresh_, lateAfter_;
  RetextureMaker maker_;
};

}  // namespace glint::gui
