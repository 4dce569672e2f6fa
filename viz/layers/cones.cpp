// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/geometry/ellipsoid.h"
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

constexpr std::size_t kMostCones = 8;  // translucent sheets over each other: more are fog
constexpr int kAround = 72;            // generators of a cone; every kLinesEvery-th of the selected frame's is a line
constexpr int kLinesEvery = 9;
constexpr double kStrongSheet = 0.24,
                 kSheet = 0.10;  // opacity, of the selected frame and the others: eight of these still let the ellipsoid through

/// The cone of one view: from its (virtual) camera through its ellipse.
struct Cone {
  const TrainingView* view;
  Ellipse ellipse;
  Eigen::Vector3d apex;
  bool mirrored;  ///< the apex is a virtual camera's
};

/// The cone that a model takes from a view: from its mirror image, or from the camera itself where the model knows no mirror.
std::optional<Cone> coneOf(const TrainingView& view, const HighlightModel& model) {
  const std::optional<ConicView> outline = model.outlineIn(view);
  if (!outline || !view.seen) return {};
  const Eigen::Vector3d eye = view.camera.centreInWorld();
  const bool mirrored = model.traits().mirrored;
  return Cone{&view, outline->ellipse, mirrored ? view.seen->tangentPlane.reflected(eye) : eye, mirrored};
}

void addCone(LayerContent& content, const LayerInput& in, const Cone& cone, const Ellipsoid& target, const Colour& colour,
             bool strong, const Picked& info) {
  // A cone runs from the tangent plane, where both cameras see the same ellipse, to a little beyond the ellipsoid; a camera's
  // own cone from halfway, because its ellipsoid lies about the tangent planes.
  std::vector<Pixel> pixels = cone.ellipse.sample(kAround);
  const Eigen::Vector3d axis = (target.centre() - cone.apex).normalized();
  const Eigen::Matrix3d body = target.worldFromBody().linear() * target.semiAxes().asDiagonal();
  const double end = (target.centre() - cone.apex).dot(axis) + 1.15 * (body.transpose() * axis).norm();
  TriangleMesh sheet;
  Points near, far;
  for (const Pixel& pixel : pixels) {
    const std::optional<Eigen::Vector3d> onPlane = intersection(cone.view->camera.ray(pixel), cone.view->seen->tangentPlane);
    if (!onPlane) return;  // T is seen edge-on
    const Eigen::Vector3d along = *onPlane - cone.apex;
    const double forward = along.dot(axis);
    const double begin = cone.mirrored ? forward : 0.5 * end;
    if (!(forward > 0) || !(end > begin)) return;  // the ellipsoid is not in front of this camera
    near.push_back(cone.apex + (begin / forward) * along);
    far.push_back(cone.apex + (end / forward) * along);
  }
  for (std::size_t i = 0; i < near.size(); ++i) {
    sheet.vertices.push_back(near[i]);
    sheet.vertices.push_back(far[i]);
    const int a = static_cast<int>(2 * i), b = static_cast<int>(2 * ((i + 1) % near.size()));
    sheet.triangles.push_back({a, a + 1, b});
    sheet.triangles.push_back({b, a + 1, b + 1});
  }
  std::vector<Segment> lines;
  for (std::size_t i = 0; strong && i < near.size(); i += kLinesEvery) lines.emplace_back(near[i], far[i]);
  near.push_back(near.front());
  far.push_back(far.front());
  const double width = strong ? 1.8 : 1.2;
  content.drawn.push_back({sheetActor(sheet, colour, strong ? kStrongSheet : kSheet), info, 0, false});
  if (strong) content.add(segmentActor(lines, colour, width), info, width);
  content.add(lineActor({near, far}, colour, 1.5 * width), info, 1.5 * width);
  if (strong) {  // back to the camera that it comes from
    const std::vector<Segment> back = dashed(cone.apex, near.front(), 0.02 * in.scale.sceneSize);
    content.add(segmentActor(back, kVirtualCamera, 1.0), info, 1.0);
  }
}

}  // namespace

LayerContent conesLayer(const LayerInput& in) {
  LayerContent content;
  std::string model;  // the selected one, else the richest with an ellipsoid
  for (const std::string& name : in.models)
    for (const ModelFit* fit : in.fits(name))
      if (fit->ellipsoid() && (model.empty() || model != in.selection.model)) model = name;
  if (model.empty()) {
    content.remarks.push_back(in.hidden.ellipsoids.empty() ? "cones: no model has an ellipsoid" : "cones: no ellipsoid is shown");
    return content;
  }
  for (const ModelFit* fit : in.fits(model)) {
    if (!fit->ellipsoid() || (!in.selection.light.empty() && in.selection.light != fit->light)) continue;
    const Ellipsoid& target = *fit->ellipsoid();
    if (!target.centre().allFinite() || (target.centre() - in.scale.sceneBox.center()).norm() > 20 * in.scale.sceneSize) {
      content.remarks.push_back("cones: the ellipsoid is too far away to draw");
      continue;
    }
    std::vector<Cone> cones;
    bool elsewhere = false;
    for (const TrainingView* view : in.viewsOf(*fit)) {
      const std::optional<Cone> cone = coneOf(*view, modelByName(model));
      if (!cone) continue;
      elsewhere = elsewhere || !in.onSurface(view->frame);
      cones.push_back(*cone);
    }
    if (elsewhere)
      content.remarks.push_back(std::string("cones: from the training frames, which saw ") +
                                (standsStill(*in.inspection->scene) ? "another surface" : "the surface elsewhere"));
    const std::size_t every = std::max<std::size_t>(1, (cones.size() + kMostCones - 1) / kMostCones);
    if (every > 1) content.remarks.push_back("cones: one in " + std::to_string(every) + " drawn");
    for (std::size_t i = 0; i < cones.size(); ++i) {
      const bool strong = cones[i].view->frame == in.selection.frame;
      if (!strong && i % every != 0) continue;
      Picked info;
      info.layer = "cones";
      info.frame = cones[i].view->frame;
      info.model = model;
      info.light = fit->light;
      info.text = line(model + " cone of frame", in.frame(cones[i].view->frame).id) + line("apex", cones[i].apex, "m");
      addCone(content, in, cones[i], target, modelColour(model, !fit->poor.empty()), strong, info);
    }
  }
  return content;
}

}  // namespace glint::viz
