// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/label_shapes.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <system_error>

#include "core/geometry/polyline.h"
#include "core/pipeline/live_prediction.h"

namespace glint {
namespace {

constexpr double kBesidePx = 0.75;  // px from the contour: beyond its own error, and within the smallest highlights
constexpr double kJumpPx =
    5;  // footprints of a pixel: a surface seen at 80 degrees rises by less over the 1.5 px between both sides
constexpr double kLeastEdgeShare = 0.02;  // of the contour: less is a single sample at the crease of a mesh

/// The two points are neighbours on the surface: the tangent plane of the one leads to the other.
bool continues(const SurfacePoint& from, const SurfacePoint& to, const Ray& rayTo, const Camera& camera) {
  const double towards = from.normal.dot(rayTo.direction);
  if (towards == 0) return false;
  const double reached = from.normal.dot(from.position - rayTo.origin) / towards;
  const double footprint = camera.depth(from.position) / camera.pixelFromRay(0, 0);
  return std::abs((to.position - rayTo.origin).norm() - reached) <= kJumpPx * footprint;
}

bool isEdge(const Pixel& inside, const Pixel& outside, const Camera& camera, const Surface& surface) {
  const Ray in = camera.ray(inside), out = camera.ray(outside);
  const Outcome<SurfacePoint> a = surface.firstHit(in), b = surface.firstHit(out);
  if (!a || !b) return true;
  return !continues(*a, *b, out, camera) && !continues(*b, *a, in, camera);
}

bool hiddenDirections(const PredictedHighlight& h) {
  if (!h.canonical) return false;
  return std::any_of(h.canonical->directions.begin(), h.canonical->directions.end(), [](const DirectionResult& d) {
    return d.failure && (d.failure->reason == Reason::Occluded || d.failure->reason == Reason::SurfaceEnded);
  });
}

/// Half a pixel beyond the outermost pixel centres the image ends.
Eigen::AlignedBox2d imageBox(const Camera& camera) { return {Pixel(-0.5, -0.5), Pixel(camera.width - 0.5, camera.height - 0.5)}; }

/// The label of a highlight; without points where the image shows nothing of it.
LabelShape shapeOf(const PredictedHighlight& h, const Camera& camera, const Surface* surface) {
  LabelShape shape;
  Polyline drawn{{}, true};
  for (const Pixel& p : h.contour.points) {
    const Pixel measured = camera.distorted(p);
    if (measured.allFinite())
      drawn.points.push_back(measured);
    else
      shape.truncated = true;
  }
  const Eigen::AlignedBox2d box = imageBox(camera);
  for (const Pixel& p : drawn.points) shape.truncated = shape.truncated || !box.contains(p);
  shape.polygon = shape.truncated ? clippedTo(box, drawn) : drawn;
  shape.areaPx2 = std::abs(signedArea(shape.polygon));
  shape.coverage = h.coverage;
  if (surface) shape.edgeShare = edgeShareOf(h.contour, camera, *surface);
  shape.occluded = hiddenDirections(h) || shape.edgeShare >= kLeastEdgeShare;
  return shape;
}

}  // namespace

double edgeShareOf(const Polyline& contour, const Camera& camera, const Surface& surface) {
  const std::size_t n = contour.points.size();
  const double outwards = signedArea(contour) > 0 ? 1 : -1;
  double whole = 0, along = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Pixel &a = contour.points[i], &b = contour.points[(i + 1) % n];
    const double length = (b - a).norm();
    if (!(length > 0) || !std::isfinite(length)) continue;
    const Pixel middle = (a + b) / 2, normal = outwards * kBesidePx / length * Pixel(b.y() - a.y(), a.x() - b.x());
    whole += length;
    if (isEdge(middle - normal, middle + normal, camera, surface)) along += length;
  }
  return whole > 0 ? along / whole : 0;
}

std::string categoryOf(const std::string& light) { return "highlight " + light; }

std::string shownIn(const Inspection& inspection, const Frame& frame) {
  const std::filesystem::path file = frame.image.empty() ? frame.radiance : frame.image;
  std::error_code ignored;  // unreadable counts as missing
  if (file.empty() || frame.ofVideo || inspection.request.whatIf.synthesise || !std::filesystem::exists(file, ignored)) return {};
  return file.lexically_relative(inspection.scene->folder).generic_string();
}

LabelSet labelsOf(const Inspection& inspection, const std::string& model, const std::vector<int>& frames) {
  const std::set<int> wanted(frames.begin(), frames.end());
  const HighlightModel& m = modelByName(model);
  LabelSet labels;
  std::map<std::string, int> indices;
  for (const ModelResult::Fit& fit : inspection.models.at(model).fits)
    if (indices.emplace(fit.light, static_cast<int>(labels.lights.size())).second) labels.lights.push_back(fit.light);
  for (const int frame : frames) labels.reasons[frame] = "no fitted light is on";
  std::set<int> shown;
  for (const FrameComparison& c : inspection.models.at(model).frames) {
    if (!wanted.count(c.frame)) continue;
    if (const Failure* const why = c.prediction.failure()) labels.reasons[c.frame] = why->message();
    const Camera camera = inspection.cameraFor(c.frame, c.light);
    const std::shared_ptr<const Surface> surface =
        c.prediction.highlights().empty() ? nullptr : surfaceOfModel(inspection, m, c.frame, c.light);
    for (const PredictedHighlight& h : c.prediction.highlights()) {
      LabelShape shape = shapeOf(h, camera, surface.get());
      shape.frame = c.frame;
      shape.light = indices.at(c.light);
      shape.level = inspection.request.settings.number("detect.level");
      if (shape.areaPx2 > 0) {
        shown.insert(c.frame);
        labels.shapes.push_back(std::move(shape));
      } else {
        labels.reasons[c.frame] = Failure{Reason::OutsideImage, "the whole highlight"}.message();
      }
    }
  }
  for (const int frame : shown) labels.reasons.erase(frame);
  return labels;
}

}  // namespace glint
