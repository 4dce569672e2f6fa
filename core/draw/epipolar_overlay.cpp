// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/epipolar_overlay.h"

#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/draw/frame_details.h"

namespace glint::draw {
namespace {

struct PairView {
  Projection projection;
  Ellipse ellipse;
};

const TrainingView* trainingViewOf(const Inspection& inspection, int frame, const std::string& light) {
  for (const TrainingView& view : inspection.views)
    if (view.frame == frame && view.highlight.light == light && view.seen) return &view;
  return nullptr;
}

/// The tangent plane that a model predicts with for an observed highlight.
const Plane* predictedPlane(const Inspection& inspection, int frame, int highlight) {
  for (const std::string& model : modelsInOrder(inspection)) {
    for (const FrameComparison& comparison : inspection.models.at(model).frames) {
      if (comparison.frame != frame) continue;
      for (std::size_t i = 0; i < comparison.prediction.highlights().size(); ++i) {
        const PredictedHighlight& h = comparison.prediction.highlights()[i];
        if (h.tangentPlane && observedOf(comparison, static_cast<int>(i)) == highlight) return &*h.tangentPlane;
      }
    }
  }
  return nullptr;
}

Outcome<PairView> viewOf(const Inspection& inspection, int frame, int highlight, const PairRequest& request) {
  const Frame& f = inspection.scene->frames[static_cast<std::size_t>(frame)];
  const Highlight& h = inspection.evidence[static_cast<std::size_t>(frame)].highlights[static_cast<std::size_t>(highlight)];
  const TrainingView* training = trainingViewOf(inspection, frame, h.light);
  const Camera camera = inspection.cameraFor(frame, h.light);
  PairView view{camera.projection(), {}};
  if (request.ellipse == PairEllipse::Canonical) {
    if (!training || !training->canonical || !training->canonical->ellipse)
      return Failure{Reason::NotSupported,
                     "frame " + f.id + " has no canonical ellipse; only training frames of a model with walks have one"};
    view.ellipse = *training->canonical->ellipse;
  } else if (h.ellipse) {
    view.ellipse = *h.ellipse;
  } else {
    return Failure{Reason::TooFewPoints, "frame " + f.id + ": no ellipse fits the observed contour"};
  }
  if (request.cameras == PairCameras::Virtual) {
    if (training && training->seen) {
      view.projection = training->seen->virtualCamera;
    } else if (const Plane* plane = predictedPlane(inspection, frame, highlight)) {
      view.projection = virtualCamera(camera, *plane);
    } else {
      return Failure{Reason::NotSupported, "frame " + f.id + ": no virtual camera because the tangent plane is unknown"};
    }
  }
  return view;
}

/// The part of a line inside a box; empty if it passes by. Liang and Barsky 1984.
std::vector<Pixel> clipped(const Eigen::Vector3d& line, const Eigen::AlignedBox2d& box) {
  const Pixel normal = line.head<2>(), along(-normal.y(), normal.x()), middle = box.center();
  const Pixel start = middle - (normal.dot(middle) + line.z()) * normal;
  double from = -box.diagonal().norm(), to = -from;
  for (int axis = 0; axis < 2; ++axis) {
    if (along[axis] == 0) {
      if (start[axis] < box.min()[axis] || start[axis] > box.max()[axis]) return {};
      continue;
    }
    double a = (box.min()[axis] - start[axis]) / along[axis], b = (box.max()[axis] - start[axis]) / along[axis];
    if (a > b) std::swap(a, b);
    from = std::max(from, a);
    to = std::min(to, b);
  }
  if (!(from < to)) return {};
  return {start + from * along, start + to * along};
}

/// An epipolar line over a photograph. Without lens distortion it goes on beyond the photograph, where one may pan to.
std::vector<Pixel> overPhotograph(const Eigen::Vector3d& line, const Camera& camera) {
  const Pixel size(camera.width, camera.height);
  Eigen::AlignedBox2d box(Pixel(-0.5, -0.5), size - Pixel(0.5, 0.5));
  if (!camera.hasDistortion()) {
    box = Eigen::AlignedBox2d(Pixel(box.min() - size), Pixel(box.max() + size));
    return clipped(line, box);
  }
  const std::vector<Pixel> ends = clipped(line, box);
  if (ends.empty()) return {};
  constexpr int kSteps = 64;
  std::vector<Pixel> ideal;
  for (int i = 0; i <= kSteps; ++i) ideal.push_back(ends[0] + (ends[1] - ends[0]) * (static_cast<double>(i) / kSteps));
  return toPhotograph(camera, ideal);
}

}  // namespace

EpipolarPicture epipolarPicture(const Inspection& inspection, const PairRequest& request) {
  EpipolarPicture picture;
  const auto fail = [&](const Failure& failure) {
    picture.failure = failure;
    return picture;
  };
  std::array<int, 2> highlights{std::max(0, request.highlight), -1};
  for (const int frame : request.frames)
    require(inspection.scene && frame >= 0 && frame < static_cast<int>(inspection.scene->frames.size()),
            "epipolarPicture: no such frame");
  const auto highlightsOf = [&](int frame) -> const std::vector<Highlight>& {
    static const std::vector<Highlight> none;
    return static_cast<std::size_t>(frame) < inspection.evidence.size()
               ? inspection.evidence[static_cast<std::size_t>(frame)].highlights
               : none;
  };
  const std::vector<Highlight>&first = highlightsOf(request.frames[0]), &second = highlightsOf(request.frames[1]);
  if (static_cast<std::size_t>(highlights[0]) >= first.size()) return fail({Reason::NoHighlight, "none in the first frame"});
  const std::string light = first[static_cast<std::size_t>(highlights[0])].light;
  for (std::size_t i = 0; i < second.size() && highlights[1] < 0; ++i)
    if (second[i].light == light) highlights[1] = static_cast<int>(i);
  if (highlights[1] < 0) return fail({Reason::NoHighlight, "none of this light in the second frame"});
  if (request.frames[0] == request.frames[1])
    return fail({Reason::RankDeficient, "both frames are the same; choose another frame"});

  std::array<PairView, 2> views;
  for (std::size_t i = 0; i < 2; ++i) {
    const Outcome<PairView> view = viewOf(inspection, request.frames[i], highlights[i], request);
    if (!view) return fail(view.failure());
    views[i] = *view;
  }
  const Outcome<EpipolarTangents> tangents =
      epipolarTangents(views[0].projection, views[0].ellipse, views[1].projection, views[1].ellipse);
  if (!tangents) return fail(tangents.failure());
  picture.tangents = *tangents;
  const bool real = request.cameras == PairCameras::Real;
  for (std::size_t i = 0; i < 2; ++i) {
    const EpipolarView& view = i == 0 ? tangents->first : tangents->second;
    const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(request.frames[i])].camera;
    OverlayLine line;
    line.role = OverlayRole::EpipolarLine;
    line.colour = real ? kRealEpipolar : kVirtualCamera;
    line.light = light;
    line.width = 1.25;
    line.halo = true;
    const std::string which = real ? "real cameras" : "virtual cameras";
    for (std::size_t k = 0; k < 2; ++k) {
      line.points = overPhotograph(view.tangents[k], camera);
      line.dash = Dash::Solid;
      line.label = "tangent epipolar line, " + which;
      if (!line.points.empty()) picture.frames[i].lines.push_back(line);
      line.points = overPhotograph(view.transferred[k], camera);
      line.dash = Dash::Dashed;
      line.label = "tangent from the other image, " + which + formatted(": misses by %.2f px", view.missPx[k]);
      if (!line.points.empty()) picture.frames[i].lines.push_back(line);
      OverlayMark mark;
      mark.role = OverlayRole::EpipolarLine;
      mark.at = toPhotograph(camera, {view.contacts[k]}).front();
      mark.shape = MarkShape::Circle;
      mark.colour = line.colour;
      mark.size = 3;
      mark.light = light;
      mark.label = "point of contact, " + which;
      picture.frames[i].marks.push_back(mark);
    }
  }
  return picture;
}

}  // namespace glint::draw
