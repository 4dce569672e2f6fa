// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/app/lamp_answer.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

constexpr double kFarLamp = 4;       ///< in scene sizes, as for estimates: beyond, an arrow shows the direction
constexpr double kWideCone = 0.25;   ///< radians: a wider one is drawn by its rim alone, or it would cover the scene
constexpr int kConeLines = 12;       ///< along a cone: it reads as one, and what lies inside stays visible
constexpr double kLeastAxis = 1e-3;  ///< of the longest: a thinner ellipsoid has no normals to be lit by

Picked infoOf(const LampAnswer& lamp) {
  Picked info;
  info.layer = "measured-lamps";
  info.light = lamp.id;
  info.text = line("measured lamp", lamp.id);
  if (lamp.position) info.text += line("position", *lamp.position, "m");
  if (const Outcome<Ellipsoid> region = positionRegion(lamp))
    info.text += line("95 % region, semi-axes", region->semiAxes(), "m");
  info.text += line("direction", lamp.direction) + line("95 % cone, half angle", degrees(directionRegion(lamp)), "deg") +
               line("residual", lamp.residualPx, "px") + line("degrees of freedom", lamp.degreesOfFreedom) +
               line("highlights", static_cast<double>(lamp.highlights));
  if (!lamp.position) info.text += line("no position", lamp.withoutPosition);
  return info;
}

/// The region of 95 % about the place, as the ellipsoids of models are drawn.
void addRegion(LayerContent& content, const LampAnswer& lamp, const Picked& info, double width) {
  const Outcome<Ellipsoid> region = positionRegion(lamp);
  if (!region || !(region->semiAxes().maxCoeff() > 0)) return;
  const Eigen::Affine3d ball = ballOf(*region, kLeastAxis);
  content.add(ellipsoidActor(ball, kMeasuredLamp, 0.25), info);
  content.add(lineActor(principalEllipses(ball), kMeasuredLamp, width), info, width);
  for (int i = 0; i < 3; ++i)
    for (const double side : {-1.0, 1.0}) content.extent.push_back(region->centre() + side * ball.linear().col(i));
}

/// An arrow from the object towards the lamp, and the cone that holds the true direction with 95 %, if wider than the arrow.
void addArrow(LayerContent& content, const LayerInput& in, const LampAnswer& lamp, const std::string& label, const Picked& info,
              double width) {
  const Eigen::Vector3d middle = in.scale.surfaceBox.center();
  const Eigen::Vector3d from = middle + 0.6 * in.scale.surfaceSize * lamp.direction;
  const double length = 0.6 * in.scale.surfaceSize, radius = 0.5 * in.scale.point;
  const Eigen::Vector3d to = from + length * lamp.direction;
  content.add(arrowActor({{from, to}}, radius, kMeasuredLamp), info);
  content.labels.push_back({to, label, kMeasuredLamp});
  content.extent.push_back(to);
  const double angle = directionRegion(lamp);
  const double rim = length * std::tan(std::min(angle, kWideCone));
  if (!(rim > radius)) return;
  const Eigen::Vector3d u = lamp.direction.unitOrthogonal(), v = lamp.direction.cross(u);
  content.add(lineActor({circle(to, rim * u, rim * v)}, kMeasuredLamp, width), info, width);
  if (angle > kWideCone) {
    content.remarks.push_back(
        "lamp " + lamp.id +
        formatted(": its direction is known to %.3g degrees only (95 %%); the cone is drawn narrower", degrees(angle)));
    return;
  }
  std::vector<Segment> sides;
  for (int i = 0; i < kConeLines; ++i) {
    const double t = 2 * std::numbers::pi * i / kConeLines;
    sides.emplace_back(from, to + rim * (std::cos(t) * u + std::sin(t) * v));
  }
  content.add(segmentActor(sides, kMeasuredLamp, 1), info, 1);
}

}  // namespace

LayerContent measuredLampsLayer(const LayerInput& in) {
  LayerContent content;
  if (!in.lamps) return content;
  std::size_t without = 0, elsewhere = 0;
  for (const LampAnswer& lamp : *in.lamps) {
    if (in.hidden.lights.count(lamp.id)) continue;
    if (lamp.failure) {
      ++without;
      continue;
    }
    if (lamp.frame && *lamp.frame != in.inspection->lightFrame.frame) {
      ++elsewhere;
      continue;
    }
    const Picked info = infoOf(lamp);
    const bool selected = !in.selection.light.empty() && in.selection.light == lamp.id && in.selection.model.empty();
    const double width = selected ? 3.5 : 2;
    const std::string label = "lamp " + lamp.id + " (measured)";
    const double far = lamp.position ? (*lamp.position - in.scale.sceneBox.center()).norm() : 0;
    if (!lamp.position || far > kFarLamp * in.scale.sceneSize) {
      addArrow(content, in, lamp, lamp.position ? label + formatted(", %.3g m away", far) : label, info, width);
      continue;
    }
    content.add(sphereActor({*lamp.position}, (selected ? 1.5 : 1.1) * in.scale.point, kMeasuredLamp), info);
    content.labels.push_back({*lamp.position, label, kMeasuredLamp});
    content.extent.push_back(*lamp.position);
    addRegion(content, lamp, info, width);
  }
  if (elsewhere > 0)  // its numbers are of other coordinates than the picture's
    content.remarks.push_back(std::to_string(elsewhere) + " measured " + (elsewhere == 1 ? "lamp stands" : "lamps stand") +
                              " still in other coordinates than this picture's (light.frame)");
  if (without > 0)
    content.remarks.push_back(std::to_string(without) + " of " + std::to_string(in.lamps->size()) +
                              " measured lamps have no answer (panel Lamps)");
  return content;
}

}  // namespace glint::viz
