// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnose/mismatch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/angle.h"
#include "core/base/number_text.h"
#include "core/model/plausible.h"
#include "core/score/metrics.h"
#include "core/surface/occlusion.h"

namespace glint {
namespace {

constexpr double kGrazing =
    75;  // degrees from the normal: four times as many highlight pixels per surface as seen frontally, and a weak lobe
constexpr double kNear = 1.5;  // radii of the highlight within which a candidate of detection is the same spot

/// "outside of the image", where most of the contour is not in it.
bool isOutside(const Camera& camera, const Polyline& contour) {
  const auto inside = std::count_if(contour.points.begin(), contour.points.end(), [&](const Pixel& p) {
    const Pixel m = camera.distorted(p);
    return m.x() > -0.5 && m.y() > -0.5 && m.x() < camera.width - 0.5 && m.y() < camera.height - 0.5;
  });
  return 2 * inside < static_cast<long>(contour.points.size());
}

/// What hides the lamp from the middle of the contour on the surface, or how flat it is seen; "" if neither does, or where
/// that misses the surface. A brightest point would not do: `primal` predicts outlines that no point of the surface made.
std::string geometryAgainst(const Inspection& inspection, const FrameComparison& c, const PredictedHighlight& h) {
  const Camera& camera = inspection.scene->frames[std::size_t(c.frame)].camera;
  const Eigen::Vector3d eye = camera.centreInWorld();
  const LightEstimate* const light = inspection.lightFor(c.frame, c.light);
  const Outcome<std::shared_ptr<const Surface>> surface = surfaceFor(inspection, c.frame, c.light);
  if (!surface || !*surface) return "";
  const Outcome<SurfacePoint> hit = (*surface)->firstHit(camera.ray(centroid(h.contour)));
  if (!hit) return "";
  const SurfacePoint at = facing(*hit, eye);
  if (light && (*surface)->occluded(at, occlusionTarget(**surface, at.position, light->light, (eye - at.position).norm())))
    return "in the shadow of the object itself";
  const double cosine = at.normal.dot((eye - at.position).normalized());
  if (const double angle = degrees(std::acos(std::clamp(cosine, -1.0, 1.0))); angle > kGrazing)
    return formatted("at grazing incidence: seen %.0f\u00b0 from the normal", angle);
  return "";
}

/// What detection said of a spot there; "" if it saw none.
std::string detectionAgainst(const FrameEvidence& seen, const Camera& camera, const PredictedHighlight& h) {
  const double radius = kNear * std::max(2.0, radiusPx(h.contour));
  const Pixel middle = camera.distorted(centroid(h.contour));
  for (const RejectedCandidate& r : seen.rejected)
    if ((r.place - middle).norm() < radius) return "detection saw a spot there and did not take it: " + r.reason;
  return "";
}

template <class Highlights, class PlaceOf>
std::string nearest(const Highlights& others, const Pixel& place, const char* what, const PlaceOf& placeOf) {
  double distance = std::numeric_limits<double>::infinity();
  for (const auto& other : others) distance = std::min(distance, (placeOf(other) - place).norm());
  return std::isfinite(distance) ? formatted("the nearest %s is %.3g px away", what, distance)
                                 : std::string("there is no ") + what;
}

}  // namespace

std::string whyUnmatched(const Inspection& inspection, const FrameComparison& c, const FrameComparison::Row& row) {
  if (row.metrics) return "";
  // That nothing overlaps is what is to be explained.
  const bool unanswered = row.observed >= 0 && row.predicted < 0 && !c.prediction.failure();
  if (row.failure && !unanswered) return row.failure->message();
  const Frame& frame = inspection.scene->frames[std::size_t(c.frame)];
  const FrameEvidence& seen = inspection.evidence[std::size_t(c.frame)];
  const std::vector<Highlight>& observed = seen.scored();
  if (row.predicted >= 0 && row.predicted < static_cast<int>(c.prediction.highlights().size())) {
    const PredictedHighlight& h = c.prediction.highlights()[std::size_t(row.predicted)];
    if (isOutside(frame.camera, h.contour)) return "outside of the image";
    if (std::string why = geometryAgainst(inspection, c, h); !why.empty()) return why;
    if (std::string why = detectionAgainst(seen, frame.camera, h); !why.empty()) return why;
    const double area = std::abs(signedArea(h.contour)), least = inspection.request.settings.number("detect.min_area");
    if (area < least)
      return formatted("smaller than the smallest highlight that detection takes: %.2g of %.3g px^2", area, least);
    if (seen.scoringFailure()) return seen.scoringFailure()->message();
    return nearest(observed, centroid(h.contour), "observed highlight", [](const Highlight& o) { return centroid(o.contour); });
  }
  if (row.observed < 0 || row.observed >= static_cast<int>(observed.size())) return "";
  if (c.prediction.failure()) return c.prediction.failure()->message();
  const Highlight& missed = observed[std::size_t(row.observed)];
  for (const FilteredHighlight& f : c.prediction.filtered)
    if (regionIou({missed.contour}, {f.highlight.contour}) > 0) return "its prediction is filtered: " + f.reason;
  std::string why = nearest(c.prediction.highlights(), centroid(missed.contour), "predicted highlight",
                            [](const PredictedHighlight& p) { return centroid(p.contour); });
  if (missed.touchesBorder) why += "; it is cut by the image's border";
  return why;
}

}  // namespace glint
