// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/camera_glide.h"

#include <QApplication>
#include <QStyle>
#include <utility>

#include "viz/view_camera.h"

namespace glint::gui {

namespace {
const char* const kWanted = "glint.animations";
}

void setAnimationsWanted(bool wanted) { qApp->setProperty(kWanted, wanted); }

bool animationsWanted() {
  return qApp->property(kWanted).toBool() && QApplication::style()->styleHint(QStyle::SH_Widget_Animation_Duration) > 0;
}

CameraGlide::CameraGlide(QObject* parent) : QObject(parent) {
  animation_.setStartValue(0.0);
  animation_.setEndValue(1.0);
  animation_.setDuration(kMs);
  animation_.setEasingCurve(QEasingCurve::InOutCubic);
  connect(&animation_, &QVariantAnimation::valueChanged, this, [this](const QVariant& t) {
    if (show_ && running()) show_(viz::between(from_, to_, t.toDouble()));
  });
}

void CameraGlide::start(const viz::ViewPoint& from, const viz::ViewPoint& to, std::function<void(const viz::ViewPoint&)> show) {
  stop();
  if (!animationsWanted()) return show(to);
  from_ = from;
  to_ = to;
  show_ = std::move(show);
  show_(from);
  animation_.start();
}

}  // namespace glint::gui
