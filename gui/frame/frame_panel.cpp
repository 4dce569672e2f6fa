// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/frame_panel.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>
#include <QVariant>
#include <algorithm>

#include "core/geometry/polyline.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/frame/frame_canvas.h"

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
  role_ = new QLabel;
  role_->setObjectName(QStringLiteral("frameRole"));
  role_->setSizePolicy(QSizePolicy::Maximum, QSizePolicy::Maximum);
  row->addSpacing(6);
  row->addWidget(role_);
  row->addStretch(1);
  auto* legend = new QHBoxLayout;
  legend->setContentsMargins(4, 0, 4, 3);
  legend->setSpacing(2);
  toggles_ = {{viz::OverlayRole::ObservedContour, "frame/observed", QT_TR_NOOP("Observed"), nullptr},
              {viz::OverlayRole::ObservedEllipse, "frame/observed-ellipse", QT_TR_NOOP("Obs. ellipse"), nullptr},
              {viz::OverlayRole::PredictedContour, "frame/predicted", QT_TR_NOOP("Predicted"), nullptr},
              {viz::OverlayRole::PredictedEllipse, "frame/predicted-ellipse", QT_TR_NOOP("Pred. ellipse"), nullptr},
              {viz::OverlayRole::CanonicalEllipse, "frame/canonical", QT_TR_NOOP("Canonical"), nullptr},
              {viz::OverlayRole::ObservedPeak, "frame/peak", QT_TR_NOOP("Peaks"), nullptr}};
  const char* const tips[] = {QT_TR_NOOP("Contour found in the photograph, at the contour level: white"),
                              QT_TR_NOOP("Ellipse fitted to the observed contour: grey, dashed"),
                              QT_TR_NOOP("Contour that each model predicts, in its colour; dotted where directions failed"),
                              QT_TR_NOOP("Ellipse fitted to each predicted contour, dashed"),
                              QT_TR_NOOP("Ellipse of the canonical contour on the tangent plane: dotted, training frames only"),
                              QT_TR_NOOP("Observed peak: cross; predicted brightest points: circles")};
  for (Toggle& t : toggles_) {
    t.button = new QToolButton;
    t.button->setObjectName(QLatin1String(t.name));
    t.button->setText(tr(t.title));
    t.button->setToolTip(tr(tips[&t - toggles_.data()]));
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
  auto* sun = new QLabel(tr("Exposure"));
  sun->setProperty("role", "faded");
  row->addWidget(sun);
  exposure_ = new QSlider(Qt::Horizontal);
  exposure_->setObjectName(QStringLiteral("exposure"));
  exposure_->setRange(-8, 24);  // quarters of a stop
  exposure_->setPageStep(4);
  exposure_->setFixedWidth(72);
  exposure_->setFocusPolicy(Qt::NoFocus);  // arrow keys step through the frames
  exposure_->setToolTip(tr("Brightness of the photograph on screen, -2 to +6 stops; changes no result"));
  connect(exposure_, &QSlider::valueChanged, this, [this, sun](int quarters) {
    canvas_->setExposure(quarters / 4.0);
    sun->setText(quarters == 0 ? tr("Exposure") : tr("%1%2 stops").arg(quarters > 0 ? "+" : "").arg(quarters / 4.0));
  });
  row->addWidget(exposure_);
  zoom_ = new QLabel;
  zoom_->setProperty("role", "faded");
  zoom_->setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("51200 %")));
  zoom_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  row->addWidget(zoom_);
  connect(tool("highlight", tr("Zoom to the highlight (F or H)")), &QToolButton::clicked, this, &FramePanel::goToHighlight);
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
    role_->hide();
    canvas_->setMessage(QString());
  } else {
    static const char* const roles[] = {QT_TR_NOOP("training"), QT_TR_NOOP("held out"), QT_TR_NOOP("excluded")};
    const viz::Colour colours[] = {viz::kTraining, {0.38, 0.38, 0.38}, viz::kFailed};
    const int role = int(document_.role(frame));
    title_->setText(QStringLiteral("<b>%1</b>").arg(toQString(document_.scene()->frames[std::size_t(frame)].id).toHtmlEscaped()));
    role_->setText(tr(roles[role]));
    role_->setStyleSheet(
        QStringLiteral("background: %1; color: white; border-radius: 3px; padding: 1px 6px").arg(toQColor(colours[role]).name()));
    role_->show();
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
  const QString faded = palette().color(QPalette::PlaceholderText).name(), warning = warningColour().name();
  const auto cell = [](const QString& text, const char* align = "right") {
    return QStringLiteral("<td align='%1' style='padding-right:16px'>%2</td>").arg(QLatin1String(align), text);
  };
  const auto number = [&](const std::optional<double>& value, int digits) {
    return cell(value ? QString::number(*value, 'f', digits) : QStringLiteral("–"));
  };
  QString rows;
  QStringList notes;
  for (const viz::OverlayCaption& c : overlay.captions) {
    if (c.model.empty()) {
      notes << toQString(c.text).toHtmlEscaped();
      continue;
    }
    QStringList said;
    if (!c.score.reason.empty()) said << toQString(c.score.reason);
    if (c.score.missed > 0 && c.score.reason.empty()) said << tr("%1 missed").arg(c.score.missed);
    if (c.score.spurious > 0) said << tr("%1 spurious").arg(c.score.spurious);
    const bool any = c.score.matched > 0;
    rows += QStringLiteral("<tr>") +
            cell(QStringLiteral("<span style='color:%1'>■</span>&nbsp;%2")
                     .arg(toQColor(c.colour).name(), toQString(c.model).toHtmlEscaped()),
                 "left") +
            number(c.score.errorPct, 2) + number(c.score.errorPx, 2) + number(any ? c.score.iou : std::nullopt, 3) +
            QStringLiteral("<td style='color:%1'>%2</td></tr>").arg(warning, said.join(QStringLiteral(", ")).toHtmlEscaped());
  }
  QString html;
  for (const QString& note : notes) html += QStringLiteral("<div style='color:%1'>%2</div>").arg(warning, note);
  if (!rows.isEmpty())
    html += QStringLiteral("<table cellspacing='0' cellpadding='0'><tr style='color:%1'>").arg(faded) +
            cell(tr("this frame"), "left") + cell(tr("error %")) + cell(tr("px")) + cell(tr("IoU")) +
            QStringLiteral("<td></td></tr>") + rows + QStringLiteral("</table>");
  captions_->setText(html);
  captions_->setVisible(!html.isEmpty());
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

void FramePanel::addActions(Actions& actions, QMenu* menu) {
  actions.add("frame.highlight", menu, tr("&Zoom to the highlight"), [this] { goToHighlight(); },
              {{Qt::Key_F, Qt::Key_H}, "highlight"});
  actions.add("frame.fit", menu, tr("&Whole photograph"), [this] { canvas_->fit(); }, {{Qt::Key_0}, "fit"});
  actions.add("frame.pixels", menu, tr("Screen pixel per pixel"), [this] { canvas_->onePixelPerPixel(); },
              {{Qt::Key_1}, "pixels"});
}

}  // namespace glint::gui
