// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "viz/annotations.h"
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

std::string fitText(const ModelFit& fit) {
  std::string text = line("model", fit.model) + line("light", fit.light) + line("solver", fit.solver) +
                     line("gap ratio", fit.gapRatio) + line("condition", fit.condition);
  if (!fit.residualPx.empty())
    text += line("worst training residual", *std::max_element(fit.residualPx.begin(), fit.residualPx.end()), "px");
  return text;
}

}  // namespace

LayerContent ellipsoidsLayer(const LayerInput& in) {
  LayerContent content;
  for (const std::string& model : in.models) {
    for (const ModelFit* fit : in.fits(model)) {
      if (!fit->quadric) continue;
      if (!fit->ellipsoid) {
        content.notes.push_back(model + ": Q* is no ellipsoid (" + describe(*fit->quadric) + "), not drawn");
        continue;
      }
      const Ellipsoid& e = *fit->ellipsoid;
      if (!e.centre().allFinite() || !e.semiAxes().allFinite()) continue;
      if (e.semiAxes().maxCoeff() > 20 * in.scale.sceneSize ||
          (e.centre() - in.scale.sceneBox.center()).norm() > 50 * in.scale.sceneSize) {
        content.notes.push_back(model + ": the ellipsoid is far larger or farther than the scene, not drawn");
        continue;
      }
      Picked info;
      info.layer = "ellipsoids";
      info.model = model;
      info.text = fitText(*fit) + line("centre", e.centre(), "m") + line("semi-axes", e.semiAxes(), "m");
      const Colour colour = modelColour(model);
      // A vanishing axis would make the unit sphere's normals undefined: keep it thinner than a line.
      const Eigen::Vector3d axes = e.semiAxes().cwiseMax(1e-5 * std::max(e.semiAxes().maxCoeff(), 1e-300));
      const Eigen::Affine3d worldFromUnit = Eigen::Affine3d(e.worldFromBody()) * Eigen::Scaling(axes);
      content.add(ellipsoidActor(worldFromUnit, colour, 0.15), info);
      const Eigen::Matrix3d a = worldFromUnit.linear();
      const Eigen::Vector3d c = e.centre();
      content.add(
          lineActor({circle(c, a.col(0), a.col(1)), circle(c, a.col(1), a.col(2)), circle(c, a.col(2), a.col(0))}, colour, 1.5),
          info, 1.5);
      // A needle far across the scene must not shrink the rest: cameras, surface and lights frame the picture.
      if (2 * e.semiAxes().maxCoeff() > in.scale.sceneSize)
        content.remarks.push_back(model + ": ellipsoid " + lengthText(2 * e.semiAxes().maxCoeff()) +
                                  " long, may leave the picture");
    }
  }
  return content;
}

}  // namespace glint::viz
