// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

constexpr double kWalkPx = 4.5;  // see Drawn::nearerPx: above the tangent plane

void addWalks(LayerContent& content, const LayerInput& in, const Plane& plane, const Eigen::Vector3d& at,
              const CanonicalContour& canonical, int frame, const std::string& model) {
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(plane.normal);
  std::vector<Segment> onPlane, between, failed;
  Points planeEnds, surfaceEnds;
  std::vector<double> lengths;
  std::map<std::string, int> reasons;
  for (const DirectionResult& d : canonical.directions) {
    if (!d.limitAngle || d.failure) continue;
    onPlane.emplace_back(at, d.onTangentPlane);
    between.emplace_back(d.onTangentPlane, d.onSurface);
    planeEnds.push_back(d.onTangentPlane);
    surfaceEnds.push_back(d.onSurface);
    lengths.push_back((d.onTangentPlane - at).norm());
  }
  double reach = 0.05 * in.scale.surfaceSize;
  if (!lengths.empty()) {
    std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2), lengths.end());
    reach = lengths[lengths.size() / 2];
  }
  for (const DirectionResult& d : canonical.directions) {
    if (d.limitAngle && !d.failure) continue;
    const Eigen::Vector3d along = std::cos(d.azimuth) * basis.col(0) + std::sin(d.azimuth) * basis.col(1);
    failed.emplace_back(at, at + reach * along);
    if (d.failure) ++reasons[nameOf(d.failure->reason)];
  }
  Picked info;
  info.layer = "directions";
  info.frame = frame;
  info.model = model;
  info.text =
      line(model.empty() ? "directions of frame" : model + " directions of frame", in.frame(frame).id) +
      line("reached an end point", std::to_string(planeEnds.size()) + " of " + std::to_string(canonical.directions.size()));
  for (const auto& [reason, count] : reasons) info.text += line(reason, std::to_string(count));
  const Colour colour = canonicalColour();
  const double dot = std::min(0.35 * in.scale.point, 0.08 * reach);
  if (!onPlane.empty()) {
    content.addOnSurface(segmentActor(onPlane, colour, 1.2), info, 1.2, kWalkPx);
    content.addOnSurface(segmentActor(between, in.ink(), 1.0), info, 1.0, kWalkPx);
    content.addOnSurface(sphereActor(planeEnds, dot, colour), info, 0, kWalkPx);
    content.addOnSurface(sphereActor(surfaceEnds, dot, kObserved), info, 0, kWalkPx);
  }
  if (!failed.empty()) content.addOnSurface(segmentActor(failed, kFailed, 2.0), info, 2.0, kWalkPx);
}

}  // namespace

LayerContent directionsLayer(const LayerInput& in) {
  LayerContent content;
  for (const TrainingView* view : in.views()) {
    if (view->frame != in.selection.frame || !view->seen || !view->canonical) continue;
    addWalks(content, in, view->seen->tangentPlane, view->seen->brightest.point.position, *view->canonical, view->frame, "");
  }
  if (in.solo)  // what was observed, though the frame has not trained
    for (const TrainingView& view : in.ownViews(true))
      addWalks(content, in, view.seen->tangentPlane, view.seen->brightest.point.position, *view.canonical, view.frame, "");
  if (!content.drawn.empty()) return content;  // the predicted walks would lie on the observed ones
  for (const std::string& model : in.models) {
    for (const FrameComparison* comparison : in.comparisons(model)) {
      for (const PredictedHighlight& h : comparison->prediction.highlights()) {
        if (!h.tangentPlane || !h.canonical) continue;
        addWalks(content, in, *h.tangentPlane, h.brightest.point.position, *h.canonical, in.selection.frame, model);
      }
    }
  }
  return content;
}

}  // namespace glint::viz
