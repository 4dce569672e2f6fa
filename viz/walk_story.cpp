// SPDX-License-Identifier: BSD-3-Clause
#include "viz/walk_story.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/draw/frame_details.h"
#include "viz/annotations.h"
#include "viz/layers.h"
#include "viz/style.h"

namespace glint::viz {
namespace {

constexpr int kPlaces = 25;  // of each walk: a second of animation at 25 pictures a second

/// What a walk of one kind starts from.
struct Start {
  const CanonicalContour* contour = nullptr;
  BrightestPoint brightest;
  std::shared_ptr<const Surface> surface;
  Light lamp;
};

Outcome<Start> forwards(const Explanation& e) {
  if (!e.view) return Failure{Reason::NoHighlight, ""};
  if (!e.view->seen) return e.view->seen.failure();
  if (!e.lightUsed) return Failure{Reason::NoLight, "the walk needs a light"};
  if (!e.view->canonical || !e.view->surface) return Failure{Reason::NoSurface, "nothing to walk on"};
  return Start{&*e.view->canonical, e.view->seen->brightest, e.view->surface, *e.lightUsed};
}

Outcome<Start> backwards(const Inspection& in, const Explanation& e) {
  const auto result = in.models.find(e.model);
  if (result == in.models.end()) return Failure{Reason::NoHighlight, "no model"};
  const Failure none{Reason::NotSupported, e.model + " predicts without a walk"};
  const PredictedHighlight* predicted = nullptr;
  for (const FrameComparison& comparison : result->second.frames) {
    if (comparison.frame != e.frame || comparison.light != e.light) continue;
    if (comparison.prediction.failure()) return *comparison.prediction.failure();
    for (const FrameComparison::Row& row : comparison.rows)
      if (row.predicted >= 0 && (!predicted || row.observed == e.highlight))
        predicted = &comparison.prediction.highlights()[static_cast<std::size_t>(row.predicted)];
  }
  if (!predicted || !predicted->canonical) return none;
  const ModelFit* fit = nullptr;
  const std::string key = in.surfaces ? in.surfaces->keyOf(e.frame) : "";
  for (const ModelResult::Fit& f : result->second.fits)
    if (f.fit && f.light == e.light && (!f.surface || *f.surface == key)) fit = &*f.fit;
  if (!fit || !in.surfaces) return none;
  const Outcome<std::shared_ptr<const Surface>> surface = surfaceFor(in, e.frame, e.light);
  if (!surface) return surface.failure();
  if (!fit->lightEstimate && !fit->ellipsoid()) return Failure{Reason::NoLight, ""};
  return Start{&*predicted->canonical, predicted->brightest, *surface,
               fit->lightEstimate ? *fit->lightEstimate : Light::at(fit->ellipsoid()->centre())};
}

}  // namespace

WalkStory::Moment WalkStory::at(int step) const {
  const int onS = static_cast<int>(trace.onSurface.size()), onT = static_cast<int>(trace.onPlane.size());
  const int at = std::clamp(step, 0, onS + onT - 1), first = inverse ? onT : onS, place = at < first ? at : at - first;
  Moment m;
  m.onSurface = (at < first) != inverse;
  m.place = place;
  (m.onSurface ? m.visitedOnSurface : m.visitedOnPlane) = place + 1;
  if (at >= first) (inverse ? m.visitedOnPlane : m.visitedOnSurface) = first;
  return m;
}

Eigen::Vector3d WalkStory::toEye(const WalkPlace& p) const { return (camera.centreInWorld() - p.position).normalized(); }
Eigen::Vector3d WalkStory::toLight(const WalkPlace& p) const { return lamp.directionFrom(p.position); }
Eigen::Vector3d WalkStory::half(const WalkPlace& p) const { return (toEye(p) + toLight(p)).normalized(); }

Outcome<WalkStory> walkStory(const Inspection& inspection, const Explanation& explanation, bool inverse,
                             std::optional<double> direction) {
  if (inspection.lightFrame.elsewhere.count(explanation.light))
    return Failure{Reason::NotSupported, "this lamp does not stand still in the scene that is shown: light.frame=" +
                                             std::string(nameOf(inspection.lightFrame.frameOf(explanation.light))) +
                                             " shows its walk"};
  const Outcome<Start> start = inverse ? backwards(inspection, explanation) : forwards(explanation);
  if (!start) return start.failure();
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(explanation.frame)].camera;
  const std::vector<Highlight>& observed = inspection.evidence[static_cast<std::size_t>(explanation.frame)].highlights;
  const Highlight* highlight = explanation.highlight >= 0 && explanation.highlight < static_cast<int>(observed.size())
                                   ? &observed[static_cast<std::size_t>(explanation.highlight)]
                                   : nullptr;
  const DirectionResult* best = nullptr;
  std::optional<double> bestDirection;
  std::optional<Failure> why;
  double least = std::numeric_limits<double>::infinity();
  for (const DirectionResult& d : start->contour->directions) {
    if (d.failure && !why) why = d.failure;
    if (d.failure || !d.limitAngle) continue;
    const std::optional<Pixel> end = camera.project(d.onSurface);
    if (!end) continue;
    std::optional<double> seen;
    if (highlight) seen = directionOf(camera, *highlight, *end);
    const double off = std::abs(std::remainder(seen.value_or(d.azimuth) - direction.value_or(0), 2 * std::numbers::pi));
    if (!(off < least)) continue;
    least = off;
    best = &d;
    bestDirection = seen;
  }
  if (!best) return why ? *why : Failure{Reason::NotReached, "no direction reached its end"};
  const TangentWalk walk(*start->surface, camera, start->brightest, start->lamp);
  Outcome<WalkTrace> trace = traceWalk(walk, *start->surface, *best, kPlaces);
  if (!trace) return trace.failure();
  WalkStory story;
  story.frame = explanation.frame;
  story.light = explanation.light;
  if (inverse) story.model = explanation.model;
  story.inverse = inverse;
  story.camera = camera;
  story.direction = bestDirection;
  story.lamp = start->lamp;
  story.along = walk.direction(best->azimuth);
  story.normal = walk.tangentPlane().normal;
  story.trace = *trace;
  return story;
}

void addWalk(const WalkStory& story, int step, FrameOverlay& overlay) {
  const WalkStory::Moment now = story.at(step);
  const auto add = [&](const std::vector<WalkPlace>& places, int visited, const Colour& colour, bool halo, const char* name) {
    OverlayLine line;
    line.role = OverlayRole::LimitDirections;
    line.colour = colour;
    line.width = 2.5;
    line.halo = halo;
    line.label = name;
    for (int i = 0; i < visited; ++i)
      if (const std::optional<Pixel> p = story.camera.project(places[static_cast<std::size_t>(i)].position))
        line.points.push_back(*p);
    line.points = toPhotograph(story.camera, line.points);
    if (line.points.size() > 1) overlay.lines.push_back(line);
  };
  // Where both walk over the same pixels, the shorter one lies on top.
  const bool planeFirst = story.trace.reachOnPlane > story.trace.reachOnSurface;
  const auto onSurface = [&] { add(story.trace.onSurface, now.visitedOnSurface, kObserved, true, "walk on S"); };
  const auto onPlane = [&] { add(story.trace.onPlane, now.visitedOnPlane, canonicalColour(), true, "walk on T"); };
  if (planeFirst) onPlane();
  onSurface();
  if (!planeFirst) onPlane();
  const std::optional<Pixel> at = story.camera.project(story.place(now).position);
  if (!at) return;
  OverlayMark mark;
  mark.role = OverlayRole::LimitDirections;
  mark.shape = MarkShape::Circle;
  mark.at = toPhotograph(story.camera, {*at}).front();
  mark.colour = now.onSurface ? kObserved : canonicalColour();
  mark.size = 5;
  mark.width = 2;
  mark.label = walkText(story, step);
  overlay.marks.push_back(mark);
}

std::string walkText(const WalkStory& story, int step) {
  const WalkStory::Moment m = story.at(step);
  return formatted("on %s: α %.2f° of %.2f°", m.onSurface ? "S" : "T", degrees(story.place(m).alpha),
                   degrees(story.trace.limitAngle));
}

std::string walkEnds(const WalkStory& story) {
  const auto end = [&](const std::vector<WalkPlace>& places) {
    if (places.empty()) return std::string("not reached");
    const WalkPlace& last = places.back();
    const Eigen::Vector3d from = last.onTangentPlane - last.distance * story.along;  // P_B
    return lengthText((last.position - from).norm()) + " from P_B";
  };
  return formatted("S: %s, T: %s, both at α = %.2f°", end(story.trace.onSurface).c_str(), end(story.trace.onPlane).c_str(),
                   degrees(story.trace.limitAngle));
}

}  // namespace glint::viz
