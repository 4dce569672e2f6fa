// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/advise/conditioning.h"
#include "core/draw/frame_overlay.h"
#include "viz/annotations.h"
#include "viz/glyphs.h"
#include "viz/layers.h"
#include "viz/quadric_wire.h"

namespace glint::viz {
namespace {

std::string fitText(const ModelFit& fit, const EllipsoidFit& fitted) {
  std::string text = line("model", fit.model + (fit.poor.empty() ? "" : ", poor: " + fit.poor)) + line("light", fit.light) +
                     line("solver", fit.solver) + line("gap ratio", fitted.gapRatio) + line("condition", fit.condition);
  if (!fit.residualPx.empty())
    text += line("worst training residual", *std::max_element(fit.residualPx.begin(), fit.residualPx.end()), "px") +
            "(residual: " + residualMeaning(fit) + ")\n";
  return text;
}

std::vector<Segment> dashesOf(const std::vector<Points>& curves) {
  constexpr std::size_t kOn = 2, kOff = 2;  // of a circle's 96 pieces
  std::vector<Segment> dashes;
  for (const Points& curve : curves)
    for (std::size_t i = 0; i + 1 < curve.size(); ++i)
      if (i % (kOn + kOff) < kOn) dashes.emplace_back(curve[i], curve[i + 1]);
  return dashes;
}

/// A Q* that is no ellipsoid: a wire dashed in the colour of failures, named at its place and in the notes.
void addDegenerate(LayerContent& content, const LayerInput& in, const ModelFit& fit, const EllipsoidFit& fitted) {
  const Eigen::Vector3d centre = in.scale.sceneBox.center();
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.45 * in.scale.sceneSize);
  const QuadricWire wire = wireOf(fitted.quadric, Eigen::AlignedBox3d(centre - half, centre + half));
  Picked info;
  info.layer = "ellipsoids";
  info.model = fit.model;
  info.light = fit.light;
  info.text = fitText(fit, fitted) + line("Q*", wire.kind + ", not an ellipsoid");
  std::vector<Segment> dashes = wire.axes;
  for (const Points& curve : wire.curves) {
    for (std::size_t i = 0; i + 1 < curve.size(); i += 2) dashes.emplace_back(curve[i], curve[i + 1]);
  }
  const bool drawn = !dashes.empty();
  content.notes.push_back(fit.model + ": Q* is not an ellipsoid (" + wire.kind + (drawn ? ")" : "), outside the view"));
  if (!drawn) return;
  const double width = in.selection.model == fit.model ? 2.5 : 1.4;
  content.add(segmentActor(dashes, kFailed, width), info, width);
  content.labels.push_back({wire.anchor, fit.model + ": " + wire.kind, kFailed});
}

/// The corners of a polyhedron about it, so that "frame all" cuts none of its outline.
void addExtent(LayerContent& content, const Eigen::Affine3d& worldFromUnit) {
  constexpr double kAbout = 1.13;  // the hull of the 26 directions holds a ball of radius 0.887
  for (int i = 0; i < 27; ++i) {
    if (i == 13) continue;  // the centre of the cube of directions
    const Eigen::Vector3d d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    content.extent.push_back(worldFromUnit * Eigen::Vector3d(kAbout * d.normalized()));
  }
}

/// Whether the surface hides a point from the first camera that sees the surface: one that does not change with the selection.
bool hiddenBySurface(const LayerInput& in, const Eigen::Vector3d& point) {
  const int frames = int(in.inspection->scene->frames.size());
  int first = 0;
  while (first < frames && !in.onSurface(first)) ++first;
  if (!in.surface || first == frames) return false;
  const Eigen::Vector3d eye = in.frame(first).camera.centreInWorld();
  const double distance = (point - eye).norm();
  if (!(distance > 0)) return false;
  const Outcome<SurfacePoint> hit = in.surface->firstHit({eye, (point - eye) / distance});
  return hit && (hit->position - eye).norm() < distance;
}

}  // namespace

LayerContent ellipsoidsLayer(const LayerInput& in) {
  LayerContent content;
  std::vector<std::string> models = in.models;  // of two things in one place the last one shows: the selected model's
  std::stable_partition(models.begin(), models.end(), [&](const std::string& m) { return m != in.selection.model; });
  for (const std::string& model : models) {
    for (const ModelFit* fit : in.fits(model)) {
      const std::optional<SceneThing> thing = ellipsoidThing(*fit, in.scale);
      if (!thing) continue;
      const EllipsoidFit& fitted = *fit->as<EllipsoidFit>();
      if (!fitted.ellipsoid) {
        addDegenerate(content, in, *fit, fitted);
        continue;
      }
      if (!thing->problem.empty()) {
        content.notes.push_back(model + ": " + thing->problem);
        continue;
      }
      const Ellipsoid& e = *thing->body;
      Picked info;
      info.layer = "ellipsoids";
      info.model = model;
      info.light = fit->light;
      info.text = fitText(*fit, fitted) + line("centre", e.centre(), "m") + line("semi-axes", e.semiAxes(), "m");
      content.behindSurface = content.behindSurface || hiddenBySurface(in, e.centre());
      const bool poor = thing->poor;  // pale and dashed, as its contours
      const Colour colour = colourOf(*thing);
      // A vanishing axis would make the unit sphere's normals undefined: keep it thinner than a line.
      const Eigen::Affine3d worldFromUnit = ballOf(e, 1e-5);
      const bool selected = in.selection.model == model && (in.selection.light.empty() || in.selection.light == fit->light);
      content.add(ellipsoidActor(worldFromUnit, colour, (selected ? 0.4 : 0.15) * (poor ? 0.5 : 1)), info);
      const auto outline = [&](const Colour& c, double width) {
        content.add(poor ? segmentActor(dashesOf(thing->chains), c, width) : lineActor(thing->chains, c, width), info, width);
      };
      if (selected) outline(in.ink(), 5.0);  // ink about the model's colour
      outline(colour, selected ? 3.0 : 1.5);
      // A needle far across the scene must not shrink the rest: cameras, surface and lights frame the picture.
      if (2 * e.semiAxes().maxCoeff() > in.scale.sceneSize)
        content.remarks.push_back(model + ": ellipsoid " + lengthText(2 * e.semiAxes().maxCoeff()) +
                                  " long, may extend beyond the view");
      else
        addExtent(content, worldFromUnit);
    }
  }
  return content;
}

}  // namespace glint::viz
