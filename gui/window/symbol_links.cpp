// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/symbol_links.h"

#include <QMouseEvent>
#include <algorithm>

#include "core/draw/colours.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/vtk_canvas.h"
#include "gui/explain/duality_window.h"
#include "gui/explain/equation_browser.h"
#include "gui/explain/equations.h"
#include "gui/scene/scene_views.h"

namespace glint::gui {

namespace {
constexpr int kRestMs = 60;  // a pointer that crosses the picture lights nothing

const draw::Colour& litIn3d() { return currentTheme() == Theme::Dark ? draw::kLitOnDark : draw::kLitOnLight; }
}  // namespace

SymbolLinks::SymbolLinks(EquationBrowser& text, SceneViews& views, QObject* parent)
    : QObject(parent), text_(text), views_(views) {
  for (int i = 0; i < kMostSceneViews; ++i) lit_.push_back(std::make_unique<viz::LitParts>(views.view(i).renderer()));
  rest_.setSingleShot(true);
  rest_.setInterval(kRestMs);
  connect(&rest_, &QTimer::timeout, this, [this] { pointAt(pointer_); });
  connect(&text, &EquationBrowser::symbolPointed, this,
          [this](const QString& symbol) { light(symbol.isEmpty() ? QSet<QString>() : QSet<QString>{symbol}); });
  connect(&text, &EquationBrowser::pageShown, this, [this] { light(text_.lit()); });
  views.widget()->installEventFilter(this);
}

void SymbolLinks::follow(DualityWindow& duality) {
  if (duality_ == &duality) return;
  duality_ = &duality;
  connect(&duality, &DualityWindow::litChanged, this, &SymbolLinks::showPlane);
  connect(&views_, &SceneViews::picked, &duality, &DualityWindow::showPicked);  // after what is picked was selected
}

void SymbolLinks::light(const QSet<QString>& symbols) {
  std::set<std::string> names;
  for (const QString& id : symbols)
    if (const EquationSymbol* const symbol = symbolById(id))
      for (const QString& shown : symbol->shows) names.insert(shown.toStdString());
  for (const auto& view : lit_) view->light(names, litIn3d());
  views_.scheduleRender();
}

void SymbolLinks::pointAt(const QPoint& place) {
  const double w = views_.widget()->width(), h = views_.widget()->height(), ratio = views_.widget()->devicePixelRatioF();
  QString name;
  for (int i = 0; i < views_.viewCount() && name.isEmpty(); ++i) {
    const std::array<double, 4> part = views_.placeOf(i);  // left, bottom, right, top
    const double x = place.x() / w, y = 1 - place.y() / h;
    if (x >= part[0] && x < part[2] && y >= part[1] && y < part[3])
      name = toQString(lit_[std::size_t(i)]->nameAt(int(place.x() * ratio), int((h - place.y()) * ratio) - 1));
  }
  const QSet<QString> symbols = name.isEmpty() ? QSet<QString>() : text_.shownBy(name.section('/', 0, 0), name.section('/', 1));
  if (symbols == text_.lit()) return;
  text_.setLit(symbols);
  light(symbols);
}

/// Only a text with symbols has something to light.
bool SymbolLinks::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() == QEvent::MouseMove) {
    const auto* e = static_cast<QMouseEvent*>(event);
    pointer_ = e->pos();
    if (e->buttons() == Qt::NoButton && text_.isVisible() && text_.hasEquations())
      rest_.start();
    else
      rest_.stop();
  }
  if (event->type() == QEvent::Leave) {
    rest_.stop();
    if (!text_.lit().isEmpty()) {
      text_.setLit({});
      light({});
    }
  }
  return QObject::eventFilter(watched, event);
}

void SymbolLinks::showPlane() {
  const viz::DualityPlane at = duality_->lit();
  const Duality* const duality = duality_->duality();
  for (const auto& view : lit_) {
    view->clearPlane();
    if (!duality || at.view < 0 || !duality_->isVisible()) continue;
    const Duality::View& cone = duality->views[std::size_t(at.view)];
    const Duality::Touch& plane = cone.planes[std::size_t(at.plane)];
    view->lightPlane(cone.apex, plane.at, plane.cone.plane.normal, duality->ellipsoid.semiAxes().maxCoeff(), litIn3d());
  }
  views_.scheduleRender();
}

}  // namespace glint::gui
