// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/highlight_edits.h"

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
  actions.add(
      "frame.ignore-highlight", menu, tr("&Ignore highlight"), [this] { ignore(); },
      {{},
       {},
       tr("The observed highlight under the pointer (else the selected one) neither trains nor is scored; once more: it does")});
  actions.add(
      "frame.merge-highlights", menu, tr("&Merge highlights"), [this] { merge(); },
      {{},
       {},
       tr("The selected highlight and the one under the pointer become one, else that one and its nearest; what lies between is "
          "assumed, and the text says how much")});
  actions.add("frame.split-highlight", menu, tr("&Split highlight here"), [this] { split(); },
              {{}, {}, tr("Cuts the observed highlight under the pointer in two, by the shortest cut through that place")});
  actions.add("frame.grow-highlight", menu, tr("&Grow highlight here"), [this] { grow(); },
              {{}, {}, tr("Detects a highlight around the pixel under the pointer, at the contour level of its own peak")});
  actions.add("frame.highlights-as-found", menu, tr("Highlights as &found"), [this] { asFound(); },
              {{}, {}, tr("Takes back all highlights ignored, merged, split or grown by hand in this frame")});
}

std::optional<HighlightEdits::Target> HighlightEdits::target() {
  Target t{document_.frameInspection(), nullptr, document_.selection().frame};
  if (!t.inspection || std::size_t(t.frame) >= t.inspection->evidence.size()) {
    emit problem(document_.scene() ? tr("The highlights of this frame are not known yet") : tr("No scene is open"));
    return std::nullopt;
  }
  t.evidence = &t.inspection->evidence[std::size_t(t.frame)];
  return t;
}

std::optional<Pixel> HighlightEdits::ideal() const {
  if (!place_ || placeFrame_ != document_.selection().frame) return std::nullopt;
  const auto inspection = document_.frameInspection();
  const Pixel p = inspection->scene->frames[std::size_t(placeFrame_)].camera.undistorted(*place_);
  return p.allFinite() ? std::optional(p) : std::nullopt;
}

/// Of overlapping ones the smallest; -1 = none.
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

void HighlightEdits::ignore() {
  const std::optional<Target> t = target();
  if (!t) return;
  const std::optional<Pixel> at = ideal();
  int i = under(*t->evidence);
  if (at && i < 0)
    for (const Highlight& h : t->evidence->ignored) {
      if (!contains(h.contour, *at)) continue;
      WhatIf w = document_.request().whatIf;
      std::erase_if(w.edits, [&](const HighlightEdit& e) {
        return e.kind == HighlightEdit::Kind::Ignore && e.frame == t->frame && contains(h.contour, e.places[0]);
      });
      document_.setWhatIf(
          w, tr("Highlight counts again in frame %1").arg(nameText(t->inspection->scene->frames[std::size_t(t->frame)].id)));
      return;
    }
  const int selected = document_.selection().highlight, count = int(t->evidence->highlights.size());
  if (i < 0 && selected >= 0 && selected < count && !t->evidence->againstTruth) i = selected;
  if (i < 0) return emit problem(tr("No observed highlight is under the pointer, and none is selected"));
  push(ignoreEdit(t->frame, t->evidence->highlights[std::size_t(i)]), tr("Highlight ignored"));
}

void HighlightEdits::merge() {
  const std::optional<Target> t = target();
  if (!t) return;
  const std::vector<Highlight>& all = t->evidence->highlights;
  int first = document_.selection().highlight, second = under(*t->evidence);
  if (first < 0 || first >= int(all.size()) || t->evidence->againstTruth) first = -1;
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
  } else if (second < 0) {
    return emit problem(tr("Put the pointer on the highlight to merge with the selected one"));
  }
  if (first < 0) return emit problem(tr("No observed highlight is under the pointer, and none is selected"));
  if (second < 0) return emit problem(tr("This frame shows no other highlight of the same light"));
  push(mergeEdit(t->frame, all[std::size_t(first)], all[std::size_t(second)]), tr("Highlights merged"));
}

void HighlightEdits::split() {
  const std::optional<Target> t = target();
  if (!t) return;
  const int i = under(*t->evidence);
  const std::optional<Pixel> at = ideal();
  if (i < 0 || !at) return emit problem(tr("Put the pointer on the observed highlight where it is to be cut"));
  const Outcome<HighlightEdit> edit = splitEdit(t->frame, t->evidence->highlights[std::size_t(i)], *at);
  if (!edit) return emit problem(toQString(edit.failure().message()));
  push(*edit, tr("Highlight split"));
}

void HighlightEdits::grow() {
  const std::optional<Target> t = target();
  if (!t) return;
  const std::optional<Pixel> at = ideal();
  if (!at) return emit problem(tr("Put the pointer on the place in the photograph where a highlight is to be grown"));
  // Whose it is: the frame's only light, else the selected one, else that of the nearest highlight.
  const std::vector<std::string>& on = t->inspection->scene->frames[std::size_t(t->frame)].lightsOn;
  std::string light = on.size() == 1 ? on.front() : document_.selection().light;
  double least = std::numeric_limits<double>::infinity();
  if (light.empty())
    for (const Highlight& h : t->evidence->highlights)
      if (const double apart = (centroid(h.contour) - *at).norm(); apart < least && !h.light.empty())
        least = apart, light = h.light;
  if (light.empty()) light = on.empty() ? "light" : on.front();
  queue_.start([scene = t->inspection->scene, request = document_.request(), frame = t->frame, at = *at,
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

void HighlightEdits::asFound() {
  WhatIf w = document_.request().whatIf;
  const int frame = document_.selection().frame;
  if (std::erase_if(w.edits, [&](const HighlightEdit& e) { return e.frame == frame; }) == 0)
    return emit problem(tr("No highlight of this frame was changed by hand"));
  document_.setWhatIf(w, tr("Highlights as found in frame %1").arg(nameText(document_.scene()->frames[std::size_t(frame)].id)));
}

}  // namespace glint::gui
