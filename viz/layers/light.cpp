// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "core/base/light_name.h"
#include "core/base/number_text.h"
#include "core/diagnostics/conditioning.h"
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

constexpr double kStar = 2.4, kRing = 3.2;  ///< radii of the light's rays and of the ring about a selected one, of its ball's
constexpr double kFarLight = 4;             ///< in scene sizes: beyond, an arrow shows the direction

std::string distanceText(double metres) { return formatted("%.3g m", metres); }

/// A far light as an arrow from the scene's centre.
void addDirection(LayerContent& content, const LayerInput& in, const Eigen::Vector3d& direction, const Colour& colour,
                  const std::string& label, const Picked& info) {
  const Eigen::Vector3d from = in.scale.surfaceBox.center() + 0.6 * in.scale.surfaceSize * direction;
  const Eigen::Vector3d to = from + 0.5 * in.scale.surfaceSize * direction;
  content.add(arrowActor({{from, to}}, 0.5 * in.scale.point, colour), info);
  content.labels.push_back({to, label, colour});
  content.extent.push_back(to);
}

/// Chains of a lamp's outline: an axis as a thick line, circles as thin ones.
void addBody(LayerContent& content, const Lamp& lamp, const Colour& colour, double width, const Picked& info) {
  std::vector<Points> circles;
  for (const Points& chain : outlineOf(lamp))
    if (chain.front() == chain.back())
      circles.push_back(chain);
    else
      content.add(lineActor({chain}, colour, 4), info, 4);
  if (!circles.empty()) content.add(lineActor(circles, colour, width), info, width);
}

std::string sizeText(const Lamp& lamp) {
  std::string text;
  for (const LampFact& fact : factsOf(lamp))
    text += fact.value.size() == 1 ? line(fact.name.c_str(), fact.value(0), "m")
                                   : line(fact.name.c_str(), Eigen::Vector3d(fact.value), "m");
  return text;
}

void addEstimate(LayerContent& content, const LayerInput& in, const Light& light, double size, const Colour& colour,
                 const std::string& label, Picked info) {
  const Eigen::Vector3d centre = in.scale.sceneBox.center();
  const double far = light.atInfinity() ? 0 : (light.position() - centre).norm();
  if (light.atInfinity()) {
    info.text += line("direction", light.directionFrom(centre));
    addDirection(content, in, light.directionFrom(centre), colour, label + ", at infinity", info);
    return;
  }
  info.text += line("position", light.position(), "m");
  if (far > kFarLight * in.scale.sceneSize) {
    addDirection(content, in, light.directionFrom(centre), colour, label + ", " + distanceText(far) + " away", info);
    return;
  }
  const double r = size * 1.6 * in.scale.point;
  const Eigen::Vector3d p = light.position();
  std::vector<Segment> rays;
  Points corners;
  for (int i = 0; i < 26; ++i) {  // a star: the neighbours of a cube's centre
    const int k = i < 13 ? i : i + 1;
    const Eigen::Vector3d d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    rays.emplace_back(p + 1.4 * r * d.normalized(), p + kStar * r * d.normalized());
    corners.push_back(rays.back().second);
  }
  content.add(sphereActor({p}, r, colour), info);
  const bool selected = !in.selection.light.empty() && in.selection.light == info.light && info.model.empty();
  if (selected) addBody(content, sphereLamp(light, kRing * r), in.ink(), 2, info);
  content.add(segmentActor(rays, colour, 1.5), info, 1.5);
  content.labels.push_back({p, label, colour, {}, (selected ? kRing : kStar) * r});
  content.glyphs.push_back(std::move(corners));
  content.extent.push_back(p);
}

/// The size of a lamp as a fitted lobe has it, drawn where the lamp is not far; its words go into `info`.
void addFittedSize(LayerContent& content, const LayerInput& in, const ModelFit& fit, Picked& info) {
  const std::optional<Lamp> lamp = fit.lamp();
  if (!lamp || lamp->atInfinity() || lamp->isPoint()) return;
  info.text += sizeText(*lamp);
  if ((fit.lightEstimate->position() - in.scale.sceneBox.center()).norm() > kFarLight * in.scale.sceneSize) return;
  addBody(content, *lamp, modelColour(info.model), 1.5, info);
}

/// How far the lamp is that a lobe explains: the noise of contours does not tell what one limit angle gets wrong.
std::string lampBeside(const LayerInput& in, const std::string& light, const Light& estimate) {
  if (estimate.atInfinity()) return "";
  for (const auto& [model, result] : in.inspection->models)
    for (const ModelResult::Fit& fit : result.fits) {
      if (fit.light != light || !fit.fit || !fit.fit->as<ReflectanceFit>() || !fit.fit->lightEstimate) continue;
      if (fit.fit->lightEstimate->atInfinity()) continue;
      const double apart = (fit.fit->lightEstimate->position() - estimate.position()).norm();
      return line("lamp by " + model,
                  distanceText(apart) + " away from here: this light explains the contours with one limit angle");
    }
  return "";
}

}  // namespace

LayerContent lightLayer(const LayerInput& in) {
  LayerContent content;
  for (const auto& [id, outcome] : in.inspection->lightsFor(in.selection.frame)) {
    if (!*outcome || in.hidden.lights.count(id)) continue;
    const LightEstimate& estimate = **outcome;
    Picked info;
    info.layer = "light";
    info.light = id;
    info.text = line("estimated light", id) + line("solver", estimate.solver) +
                line("limit angle", estimate.limitAngle * 180 / std::numbers::pi, "deg") + line("condition", estimate.condition);
    if (estimate.rmsPx > 0)  // 0: triangulated from rays alone
      info.text += line("residual", estimate.rmsPx, "px") + "(residual: " + residualMeaning(estimate) + ")\n";
    if (estimate.covariance && estimate.covariance->allFinite()) {
      info.text +=
          line("standard deviation, noise alone", Eigen::Vector3d(estimate.covariance->diagonal().cwiseMax(0).cwiseSqrt()), "m");
    }
    info.text += lampBeside(in, id, estimate.light);
    addEstimate(content, in, estimate.light, 1, kLightColour, lightName(id) + " (estimate)", info);
  }
  // A model may refine the light by itself: drawn smaller, in the model's colour, where it differs from the common one.
  for (const std::string& model : in.models) {
    for (const ModelFit* fit : in.fits(model)) {
      if (!fit->lightEstimate) continue;
      bool common = false;
      for (const auto& [key, estimate] : in.inspection->lights)
        common = common || (estimate && (estimate->light.homogeneous() - fit->lightEstimate->homogeneous()).norm() < 1e-9);
      if (common) continue;
      Picked info;
      info.layer = "light";
      info.model = model;
      info.light = fit->light;
      info.text = line("light of model", model);
      if (fit->limitAngle()) info.text += line("limit angle", *fit->limitAngle() * 180 / std::numbers::pi, "deg");
      addFittedSize(content, in, *fit, info);
      addEstimate(content, in, *fit->lightEstimate, 0.7, modelColour(model), model + " light", info);
    }
  }
  return content;
}

LayerContent trueLightLayer(const LayerInput& in) {
  LayerContent content;
  for (const TrueLight& light : in.inspection->scene->lights) {
    if (in.hidden.lights.count(light.id)) continue;
    Picked info;
    info.layer = "true-light";
    info.light = light.id;
    const Lamp& lamp = light.lamp;
    info.text =
        line("true light (not used by the method)", light.id) + (lamp.isPoint() ? line("radius", 0.0, "m") : sizeText(lamp));
    const std::string label = "truth: " + lightName(light.id);
    if (lamp.atInfinity()) {
      info.text += line("direction", Eigen::Vector3d(lamp.centre.head<3>()));
      addDirection(content, in, lamp.centre.head<3>(), kTruth, label + ", at infinity", info);
      continue;
    }
    const Eigen::Vector3d middle = lamp.position();
    if (!endsOf(lamp)) info.text += line("position", middle, "m");
    const double far = (middle - in.scale.sceneBox.center()).norm();
    if (far > kFarLight * in.scale.sceneSize) {
      addDirection(content, in, (middle - in.scale.sceneBox.center()).normalized(), kTruth,
                   label + ", " + distanceText(far) + " away", info);
      continue;
    }
    const double r = std::max(radiusOf(lamp), 4.2 * in.scale.point);
    addBody(content, withRadius(lamp, r), kTruth, 2.5, info);
    content.add(sphereActor({middle}, 0.5 * in.scale.point, kTruth), info);  // its middle: a full ball would hide the fits in it
    content.labels.push_back({middle, label, kTruth, {}, r});
    content.extent.push_back(middle);
  }
  return content;
}

}  // namespace glint::viz
