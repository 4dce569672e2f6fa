// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "viz/develop.h"

class QComboBox;
class QLabel;
class QSlider;
class QToolButton;

namespace glint::gui {

/// How the frame view shows the picture: photograph or radiance, exposure, gamma, false colour, clipped pixels. All of it is kept
/// as options "frame/source", "frame/exposure", "frame/gamma", "frame/false-colour", "frame/clipped".
class DevelopBar : public QWidget {
  Q_OBJECT
 public:
  explicit DevelopBar(Document& document, QWidget* parent = nullptr);
  void addActions(Actions& actions, QMenu* menu);
  static FrameSource source(const Document& document);
  static viz::Development development(const Document& document);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
  void changeEvent(QEvent* e) override;

 private:
  QSlider* addSlider(const char* option, const QString& title, const QString& tip, int low, int high, double step, double usual,
                     QLabel** label);
  QToolButton* addToggle(const char* option, const QString& icon, const QString& title, const QString& tip);
  void fitLabels();
  void refresh();

  Document& document_;
  QComboBox* source_;
  QSlider *exposure_ = nullptr, *gamma_ = nullptr;
  QLabel *exposureLabel_ = nullptr, *gammaLabel_ = nullptr;
  QToolButton *falseColour_, *clipped_;
  QList<QAction*> checks_;  ///< source, false colour, clipped
  int gesture_ = 0;
};

}  // namespace glint::gui
