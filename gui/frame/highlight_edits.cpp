// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/highlight_edits.h"

#include <QAction>
#include <QMenu>
#include <algorithm>
#include <limits>

#include "gui/base/text.h"
#include "gui/frame/frame_canvas.h"

namespace glint::gui {

HighlightEdits::HighlightEdits(Document& document, FrameCanvas* canvas, QObject* parent) : QObject(parent), document_(document) {
  connect(canvas, &FrameCanvas::hovered, this, [this](double x, double y) {
    place_ = Pixel(x, y);
    placeFrame_ = document_.selection().frame;
  });
  connect(&document_, &Document::sceneOpened, this, [this] {
    queue_.drop();
    queue_.stop();
    place_.reset();
  });
}

void HighlightEdits::addActions(Actions& actions, QMenu* menu) {
  const auto add = [&](const char* id, const QString& title, Plan (HighlightEdits::*plan)(), const QString& tip) {
    QAction* action = actions.add(QLatin1String(id), menu, title, [this, plan] { carryOut((this->*plan)()); }, {{}, {}, tip});
    offered_.push_back({action, plan, tip});
  };
  add("frame.ignore-highlight", tr("&Ignore highlight"), &HighlightEdits::ignore,
      tr("The observed highlight under the pointer (else the selected one) neither trains nor is scored; once more: it does"));
  add("frame.merge-highlights", tr("&Merge highlights"), &HighlightEdits::merge,
      tr("The selected highlight and the one under the pointer become one, else that one and its nearest; what lies between is "
         "assumed, and the text says how much"));
  add("frame.split-highlight", tr("&Split highlight here"), &HighlightEdits::split,
      tr("Cuts the observed highlight under the pointer in two, by the shortest cut through that place"));
  add("frame.grow-highlight", tr("&Grow highlight here"), &HighlightEdits::grow,
      tr("Detects a highlight around the pixel under the pointer, at the contour level of its own peak"));
  add("frame.highlights-as-found", tr("&Undo highlight edits in this frame"), &HighlightEdits::undoAll,
      tr("Takes back all highlights ignored, merged, split or grown by hand in this frame: those from before your edits come "
         "back"));
  offerIn(menu);
}

void HighlightEdits::offerIn(QMenu* menu) {
  menu->setToolTipsVisible(true);
  connect(menu, &QMenu::aboutToShow, this, [this] {
    for (const Offered& o : offered_) {
      const QString whyNot = (this->*o.plan)().whyNot;
      o.action->setEnabled(whyNot.isEmpty());
      o.action->setToolTip(whyNot.isEmpty() ? o.tip : whyNot);
    }
  });
  // A key, the palette or a script is answered in words.
  connect(menu, &QMenu::aboutToHide, this, [this] {
    for (const Offered& o : offered_) {
      o.action->setEnabled(true);
      o.action->setToolTip(o.tip);
    }
  });
}

void HighlightEdits::carryOut(const Plan& plan) {
  if (!plan.whyNot.isEmpty()) return emit problem(plan.whyNot);
  plan.run();
}

HighlightEdits::Target HighlightEdits::target() const {
  Target t{document_.frameInspection(), nullptr, document_.selection().frame};
  if (t.inspection && std::size_t(t.frame) < t.inspection->evidence.size())
    t.evidence = &t.inspection->evidence[std::size_t(t.frame)];
  return t;
}

QString HighlightEdits::notKnown() const {
  return document_.scene() ? tr("The highlights of this frame are not known yet") : tr("No scene is open");
}

std::optional<Pixel> HighlightEdits::ideal() const {
  if (!place_ || placeFrame_ != document_.selection().frame) return std::nullopt;
  const auto inspection = document_.frameInspection();
  const Pixel p = inspection->scene->frames[std::size_t(placeFrame_)].camera.undistorted(*place_);
  return p.allFinite() ? std::optional(p) : std::nullopt;
}

/// The highlight under the mouse, the smallest if several overlap; -1 = none.
int HighlightEdits::under(const FrameEvidence& evidence) const {
  const std::optional<Pixel> at = ideal();
  int best = -1;
  for (int i = 0; at && i < int(evidence.highlights.size()); ++i) {
    const Highlight& h = evidence.highlights[std::size_t(i)];
    if (h.contour.points.size() > 2 && contains(h.contour, *at) &&
        (best < 0 || h.areaPx2 < evidence.highlights[std::size_t(best)].areaPx2))
      best = i;
  }
  return best;
}

void HighlightEdits::push(const HighlightEdit& edit, const QString& what) {
  WhatIf w = document_.request().whatIf;
  w.edits.push_back(edit);
  document_.setWhatIf(w, tr("%1 in frame %2").arg(what, nameText(document_.scene()->frames[std::size_t(edit.frame)].id)));
}

HighlightEdits::Plan HighlightEdits::ignore() {
  const Target t = target();
  if (!t.evidence) return {notKnown(), {}};
  const std::optional<Pixel> at = ideal();
  int i = under(*t.evidence);
  if (at && i < 0)
    for (const Highlight& h : t.evidence->ignored)
      if (contains(h.contour, *at)) return {{}, [this, h, frame = t.frame] { countAgain(h, frame); }};
  const int selected = document_.selection().highlight, count = int(t.evidence->highlights.size());
  if (i < 0 && selected >= 0 && selected < count && !t.evidence->againstTruth) i = selected;
  if (i < 0) return {tr("No observed highlight is under the pointer, and none is selected"), {}};
  return pushing(ignoreEdit(t.frame, t.evidence->highlights[std::size_t(i)]), tr("Highlight ignored"));
}

void HighlightEdits::countAgain(const Highlight& h, int frame) {
  WhatIf w = document_.request().whatIf;
  std::erase_if(w.edits, [&](const HighlightEdit& e) {
    return e.kind == HighlightEdit::Kind::Ignore && e.frame == frame && contains(h.contour, e.places[0]);
  });
  document_.setWhatIf(w,
                      tr("Highlight counts again in frame %1").arg(nameText(document_.scene()->frames[std::size_t(frame)].id)));
}

HighlightEdits::Plan HighlightEdits::merge() {
  const Target t = target();
  if (!t.evidence) return {notKnown(), {}};
  const std::vector<Highlight>& all = t.evidence->highlights;
  int first = document_.selection().highlight, second = under(*t.evidence);
  if (first < 0 || first >= int(all.size()) || t.evidence->againstTruth) first = -1;
  if (first < 0 || first == second) {
    first = std::max(first, second);
    second = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; first >= 0 && i < int(all.size()); ++i) {
      const double apart = (centroid(all[std::size_t(i)].contour) - centroid(all[std::size_t(first)].contour)).norm();
      if (i == first || all[std::size_t(i)].light != all[std::size_t(first)].light || apart >= least) continue;
      least = apart;
      second = i;
    }
    if (first < 0) return {tr("No observed highlight is under the pointer, and none is selected"), {}};
    if (second < 0) return {tr("This frame shows no other highlight of the same light"), {}};
  } else if (second < 0) {
    return {all.size() < 2 ? tr("This frame shows one highlight only")
                           : tr("Put the pointer on the highlight to merge with the selected one"),
            {}};
  }
  return pushing(mergeEdit(t.frame, all[std::size_t(first)], all[std::size_t(second)]), tr("Highlights merged"));
}

HighlightEdits::Plan HighlightEdits::split() {
  const Target t = target();
  if (!t.evidence) return {notKnown(), {}};
  const int i = under(*t.evidence);
  const std::optional<Pixel> at = ideal();
  if (i < 0 || !at) return {tr("Put the pointer on the observed highlight where it is to be cut"), {}};
  const Outcome<HighlightEdit> edit = splitEdit(t.frame, t.evidence->highlights[std::size_t(i)], *at);
  if (!edit) return {toQString(edit.failure().message()), {}};
  return pushing(*edit, tr("Highlight split"));
}

HighlightEdits::Plan HighlightEdits::grow() {
  const Target t = target();
  if (!t.evidence) return {notKnown(), {}};
  const std::optional<Pixel> at = ideal();
  if (!at) return {tr("Put the pointer on the place in the photograph where a highlight is to be grown"), {}};
  return {{}, [this, t, at = *at] { growAt(t, at); }};
}

void HighlightEdits::growAt(const Target& t, const Pixel& at) {
  // Whose it is: the frame's only light, else the selected one, else that of the nearest highlight.
  const std::vector<std::string>& on = t.inspection->scene->frames[std::size_t(t.frame)].lightsOn;
  std::string light = on.size() == 1 ? on.front() : document_.selection().light;
  double least = std::numeric_limits<double>::infinity();
  if (light.empty())
    for (const Highlight& h : t.evidence->highlights)
      if (const double apart = (centroid(h.contour) - at).norm(); apart < least && !h.light.empty())
        least = apart, light = h.light;
  if (light.empty()) light = on.empty() ? "light" : on.front();
  queue_.start([scene = t.inspection->scene, request = document_.request(), frame = t.frame, at,
                light](const JobToken&) { return seedEdit(*scene, request, frame, at, light); },
               [this, request = document_.request()](const JobResult<Outcome<HighlightEdit>>& result) {
                 if (result.overtaken || result.stopped) return;
                 if (!result.failure().isEmpty()) return emit problem(result.failure());
                 if (!result.value || document_.request() != request) return;  // something else was changed meanwhile
                 if (!*result.value)
                   return emit problem(tr("Nothing grown: %1").arg(toQString(result.value->failure().message())));
                 push(**result.value, tr("Highlight grown"));
               },
               Asks::Instead);
}

HighlightEdits::Plan HighlightEdits::undoAll() {
  WhatIf w = document_.request().whatIf;
  const int frame = document_.selection().frame;
  if (std::erase_if(w.edits, [&](const HighlightEdit& e) { return e.frame == frame; }) == 0)
    return {document_.scene() ? tr("No highlight of this frame was changed by hand") : tr("No scene is open"), {}};
  return {{}, [this, w, frame] {
            document_.setWhatIf(
                w, tr("Undo edits of highlights in frame %1").arg(nameText(document_.scene()->frames[std::size_t(frame)].id)));
          }};
}

HighlightEdits::Plan HighlightEdits::pushing(const HighlightEdit& edit, const QString& what) {
  return {{}, [this, edit, what] { push(edit, what); }};
}

}  // namespace glint::gui
