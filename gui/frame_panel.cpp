// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame_panel.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QToolButton>
#include <QVBoxLayout>
#include <QVariant>
#include <algorithm>

#include "core/geometry/polyline.h"
#include "gui/frame_canvas.h"
#include "gui/text.h"
#include "gui/theme.h"

namespace glint::gui {

FramePanel::FramePanel(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  canvas_ = new FrameCanvas;
  canvas_->setObjectName(QStringLiteral("frameCanvas"));
  buildToolbar(column);
  column->addWidget(canvas_, 1);
  captions_ = new QLabel;
  captions_->setObjectName(QStringLiteral("frameCaptions"));
  captions_->setTextFormat(Qt::RichText);
  captions_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  captions_->setMargin(5);
  captions_->setWordWrap(true);
  column->addWidget(captions_);

  connect(canvas_, &FrameCanvas::probed, this, &FramePanel::probed);
  connect(canvas_, &FrameCanvas::zoomChanged, this,
          [this](double z) { zoom_->setText(QStringLiteral("%1 %").arg(z * 100, 0, 'f', z < 0.1 ? 1 : 0)); });
  connect(canvas_, &FrameCanvas::clicked, this, &FramePanel::selectAt);
  connect(&loader_, &PhotoLoader::loaded, this, [this](int frame, const QImage& photograph) {
    if (frame == document_.selection().frame) canvas_->setPhotograph(photograph);
  });
  connect(&loader_, &PhotoLoader::failed, this, [this](int frame, const QString& reason) {
    if (frame == document_.selection().frame) canvas_->setMessage(reason);
  });
  connect(&document_, &Document::sceneOpened, this, &FramePanel::showScene);
  connect(&document_, &Document::selectionChanged, this, &FramePanel::showFrame);
  connect(&document_, &Document::layersChanged, this, &FramePanel::showOverlay);
  connect(&document_, &Document::requestChanged, this, &FramePanel::showFrame);
  connect(&document_, &Document::inspectionChanged, this, &FramePanel::showOverlay);
  connect(&document_, &Document::staleChanged, canvas_, &FrameCanvas::setStale);
  showScene();
}

void FramePanel::buildToolbar(QVBoxLayout* column) {
  auto* bar = new QWidget;
  auto* row = new QHBoxLayout(bar);
  row->setContentsMargins(8, 3, 4, 3);
  row->setSpacing(2);
  title_ = new QLabel;
  title_->setObjectName(QStringLiteral("frameTitle"));
  row->addWidget(title_);
  row->addStretch(1);
  auto* legend = new QHBoxLayout;
  legend->setContentsMargins(4, 0, 4, 3);
  legend->setSpacing(2);
  toggles_ = {{viz::OverlayRole::ObservedContour, "frame/observed", QT_TR_NOOP("Observed"), nullptr},
              {viz::OverlayRole::ObservedEllipse, "frame/observed-ellipse", QT_TR_NOOP("Obs. ellipse"), nullptr},
              {viz::OverlayRole::PredictedContour, "frame/predicted", QT_TR_NOOP("Predicted"), nullptr},
              {viz::OverlayRole::PredictedEllipse, "frame/predicted-ellipse", QT_TR_NOOP("Pred. ellipse"), nullptr},
              {viz::OverlayRole::ObservedPeak, "frame/peak", QT_TR_NOOP("Peaks"), nullptr}};
  for (Toggle& t : toggles_) {
    t.button = new QToolButton;
    t.button->setObjectName(QLatin1String(t.name));
    t.button->setText(tr(t.title));
    t.button->setCheckable(true);
    t.button->setAutoRaise(true);
    connect(t.button, &QToolButton::clicked, this,
            [this, name = t.name, title = t.title](bool on) { document_.setLayerVisible(name, title, on); });
    legend->addWidget(t.button);
  }
  legend->addStretch(1);
  const auto tool = [&](const char* iconName, const QString& tip) {
    auto* button = new QToolButton;
    button->setIcon(icon(QLatin1String(iconName)));
    button->setToolTip(tip);
    button->setAutoRaise(true);
    row->addWidget(button);
    return button;
  };
  zoom_ = new QLabel;
  zoom_->setProperty("role", "faded");
  zoom_->setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("51200 %")));
  zoom_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  row->addWidget(zoom_);
  connect(tool("highlight", tr("Go to the highlight (H)")), &QToolButton::clicked, this, &FramePanel::goToHighlight);
  connect(tool("pixels", tr("One screen pixel per photograph pixel (1)")), &QToolButton::clicked, canvas_,
          &FrameCanvas::onePixelPerPixel);
  connect(tool("fit", tr("Whole photograph (0, double click)")), &QToolButton::clicked, canvas_, &FrameCanvas::fit);
  column->addWidget(bar);
  column->addLayout(legend);
}

void FramePanel::showScene() {
  loader_.setScene(document_.sharedScene());
  canvas_->setPhotograph(QImage());
  canvas_->fit();
  showFrame();
}

void FramePanel::showFrame() {
  const int frame = document_.selection().frame;
  if (!document_.scene()) {
    title_->clear();
    canvas_->setMessage(QString());
  } else {
    static const char* const roles[] = {QT_TR_NOOP("training"), QT_TR_NOOP("held out"), QT_TR_NOOP("excluded")};
    title_->setText(QStringLiteral("<b>%1</b> &nbsp;%2")
                        .arg(toQString(document_.scene()->frames[std::size_t(frame)].id).toHtmlEscaped(),
                             tr(roles[int(document_.role(frame))])));
    loader_.want(frame);
  }
  showOverlay();
}

void FramePanel::showOverlay() {
  viz::OverlayOptions options;
  for (const Toggle& t : toggles_) {
    const bool on = document_.layerVisible(t.name);
    t.button->setChecked(on);
    if (!on) options.hidden.insert(t.role);
  }
  if (options.hidden.count(viz::OverlayRole::ObservedPeak)) options.hidden.insert(viz::OverlayRole::PredictedPeak);
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  const int frame = document_.selection().frame;
  viz::FrameOverlay overlay;
  if (inspection && frame < int(inspection->evidence.size())) overlay = viz::frameOverlay(*inspection, frame, options);
  showCaptions(overlay);
  canvas_->setOverlay(std::move(overlay));
}

void FramePanel::showCaptions(const viz::FrameOverlay& overlay) {
  QStringList lines;
  for (const viz::OverlayCaption& c : overlay.captions) {
    const QString square =
        c.model.empty() ? QString() : QStringLiteral("<span style='color:%1'>■</span>&nbsp;").arg(toQColor(c.colour).name());
    const QString text = toQString(c.text).toHtmlEscaped();
    lines << square + (c.problem ? QStringLiteral("<span style='color:%1'>%2</span>").arg(warningColour().name(), text) : text);
  }
  captions_->setText(lines.join(QStringLiteral("<br>")));
  captions_->setVisible(!lines.isEmpty());
}

void FramePanel::selectAt(double x, double y) {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  viz::Selection s = document_.selection();
  s.highlight = -1;
  if (inspection && s.frame < int(inspection->evidence.size())) {
    const std::vector<Highlight>& highlights = inspection->evidence[std::size_t(s.frame)].highlights;
    const Pixel ideal = document_.scene()->frames[std::size_t(s.frame)].camera.undistorted({x, y});
    for (int i = 0; i < int(highlights.size()) && s.highlight < 0; ++i)
      if (contains(highlights[std::size_t(i)].contour, ideal)) s.highlight = i;
  }
  document_.select(s);
}

void FramePanel::goToHighlight() {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  const int frame = document_.selection().frame;
  if (!inspection || frame >= int(inspection->evidence.size())) return;
  const std::vector<Highlight>& highlights = inspection->evidence[std::size_t(frame)].highlights;
  if (highlights.empty()) return;
  const int index = std::clamp(document_.selection().highlight, 0, int(highlights.size()) - 1);
  Eigen::AlignedBox2d box;
  for (const Pixel& p : highlights[std::size_t(index)].contour.points)
    box.extend(document_.scene()->frames[std::size_t(frame)].camera.distorted(p));
  if (box.isEmpty()) return;
  const Eigen::Vector2d size = box.sizes().cwiseMax(4.0);
  // The highlight fills half of the canvas, so that its surroundings show.
  canvas_->lookAt(box.center(), 0.5 * std::min(canvas_->width() / size.x(), canvas_->height() / size.y()));
}

}  // namespace glint::gui
