// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QHBoxLayout>
#include <QLabel>
#include <QMenu>
#include <QSlider>
#include <QWidgetAction>
#include <functional>
#include <utility>

namespace glint::gui {

/// The bar has its slider; the menu of what does not fit into the bar gets one of its own, with its name.
class SizeAction : public QWidgetAction {
 public:
  SizeAction(std::function<QSlider*()> make, QObject* parent) : QWidgetAction(parent), make_(std::move(make)) {}

 protected:
  QWidget* createWidget(QWidget* parent) override {
    QSlider* slider = make_();
    if (!qobject_cast<QMenu*>(parent)) {
      slider->setFixedWidth(80);
      slider->setParent(parent);
      return slider;
    }
    auto* named = new QWidget(parent);
    auto* row = new QHBoxLayout(named);
    row->setContentsMargins(10, 4, 10, 4);
    row->addWidget(new QLabel(slider->toolTip()));
    slider->setFixedWidth(120);
    row->addWidget(slider);
    return named;
  }

 private:
  std::function<QSlider*()> make_;
};

}  // namespace glint::gui
