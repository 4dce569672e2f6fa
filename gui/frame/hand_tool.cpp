// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/hand_tool.h"

#include "gui/base/text.h"
#include "viz/frame_pick.h"

namespace glint::gui {

HandTool::HandTool(Document& document, QObject* parent) : QObject(parent), document_(document) {
  // What was held may be gone.
  connect(&document_, &Document::sceneOpened, this, &HandTool::release);
  connect(&document_, &Document::selectionChanged, this, [this] {
    if (drag_ && drag_->frame != document_.selection().frame) release();
  });
}

void HandTool::setOn(bool on) {
  if (on == on_) return;
  on_ = on;
  release();
  emit onChanged(on);
}

bool HandTool::wouldTake(const Pixel& at, double nearPx, Qt::KeyboardModifiers modifiers) const {
  const auto inspection = document_.frameInspection();
  if (!on_ || !inspection) return false;
  return modifiers.testFlag(Qt::ControlModifier) || viz::gripAt(*inspection, document_.selection().frame, at, nearPx).has_value();
}

bool HandTool::take(const Pixel& at, double nearPx, Qt::KeyboardModifiers modifiers) {
  const auto inspection = document_.frameInspection();
  if (!on_ || !inspection) return false;
  Drag drag{Held::Camera, document_.selection().frame, -1, document_.newGesture(), {}, document_.request().whatIf, {}, {}};
  if (std::size_t(drag.frame) >= inspection->scene->frames.size()) return false;
  drag.camera = inspection->scene->frames[std::size_t(drag.frame)].camera;
  drag.from = drag.camera.undistorted(at);
  if (!modifiers.testFlag(Qt::ControlModifier)) {
    const std::optional<viz::Grip> grip = viz::gripAt(*inspection, drag.frame, at, nearPx);
    if (!grip) return false;
    const FrameEvidence& evidence = inspection->evidence[std::size_t(drag.frame)];
    drag.highlight = evidence.asFound(grip->highlight);
    drag.now = evidence.highlights[std::size_t(grip->highlight)];
    drag.held = grip->peak ? Held::Peak : modifiers.testFlag(Qt::ShiftModifier) ? Held::ContourSize : Held::Contour;
  }
  drag_ = drag;
  return true;
}

void HandTool::carry(const Pixel& to) {
  if (!drag_) return;
  const WhatIf w = dragged(drag_->start, drag_->held, drag_->frame, drag_->camera, drag_->highlight, drag_->now, drag_->from,
                           drag_->camera.undistorted(to));
  static const char* const names[] = {QT_TR_NOOP("contour moved"), QT_TR_NOOP("contour resized"), QT_TR_NOOP("peak moved"),
                                      QT_TR_NOOP("camera turned")};
  const QString frame = nameText(document_.scene()->frames[std::size_t(drag_->frame)].id);
  document_.setWhatIf(w, tr("What-if: %1 in frame %2").arg(tr(names[int(drag_->held)]), frame),
                      QStringLiteral("hand#%1").arg(drag_->gesture));
  if (drag_->held == Held::Camera) return;  // what it shows stays where it is
  const WhatIf alone = dragged({}, drag_->held, drag_->frame, drag_->camera, drag_->highlight, drag_->now, drag_->from,
                               drag_->camera.undistorted(to));
  const auto by = alone.highlights.find({drag_->frame, drag_->highlight});
  const Highlight h = by == alone.highlights.end() ? drag_->now : changed(drag_->now, by->second);
  if (drag_->held == Held::Peak) return emit carried({}, drag_->camera.distorted(h.peak));
  std::vector<Pixel> line;
  for (const Pixel& p : h.contour.points) line.push_back(drag_->camera.distorted(p));
  emit carried(line, std::nullopt);
}

}  // namespace glint::gui
