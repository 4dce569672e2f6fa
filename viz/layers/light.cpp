// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "core/advise/conditioning.h"
#include "core/base/number_text.h"
#include "core/base/words.h"
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

constexpr double kStar = 2.4, kRing = 3.2;  ///< radii of the light's rays and of the ring about a selected one, of its ball's

/// What stands for a lamp that is far away.
void addArrow(LayerContent& content, const LayerInput& in, const SceneThing& lamp, const Picked& info) {
  content.add(arrowActor({*lamp.arrow}, 0.5 * in.scale.point, colourOf(lamp)), info);
  content.labels.push_back({lamp.arrow->second, lamp.label, colourOf(lamp)});
  content.extent.push_back(lamp.arrow->second);
}

/// Chains of a lamp's outline: an axis as a thick line, circles as thin ones.
void addBody(LayerContent& content, const std::vector<Points>& outline, const Colour& colour, double width, const Picked& info) {
  std::vector<Points> circles;
  for (const Points& chain : outline)
    if (chain.front() == chain.back())
      circles.push_back(chain);
    else
      content.add(lineActor({chain}, colour, 4), info, 4);
  if (!circles.empty()) content.add(lineActor(circles, colour, width), info, width);
}

std::string placeText(const LayerInput& in, const SceneThing& lamp) {
  const LightFrameChoice& choice = in.inspection->lightFrame;
  const std::string own = nameOf(choice.frameOf(lamp.light));
  const std::string of = choice.elsewhere.count(lamp.light)   ? "of the scene in this frame; it stands still in the " + own
                         : choice.frame == LightFrame::Camera ? "of the camera, with which it moves"
                                                              : "";
  return (lamp.place->w() == 0 ? line("direction", Eigen::Vector3d(lamp.place->head<3>().normalized()))
                               : line("position", lamp.position(), "m")) +
         (of.empty() ? "" : line("coordinates", of));
}

std::string sizeText(const Lamp& lamp) {
  std::string text;
  for (const LampFact& fact : factsOf(lamp))
    text += fact.value.size() == 1 ? line(fact.name.c_str(), fact.value(0), "m")
                                   : line(fact.name.c_str(), Eigen::Vector3d(fact.value), "m");
  return text;
}

void addEstimate(LayerContent& content, const LayerInput& in, const SceneThing& lamp, double size, Picked info) {
  const Colour colour = colourOf(lamp);
  info.text += placeText(in, lamp);
  if (lamp.arrow) return addArrow(content, in, lamp, info);
  addBody(content, lamp.chains, colour, 1.5, info);
  const double r = size * 1.6 * in.scale.point;
  const Eigen::Vector3d p = lamp.position();
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
  if (selected) addBody(content, outlineOf(sphereLamp(Light::at(p), kRing * r)), in.ink(), 2, info);
  content.add(segmentActor(rays, colour, 1.5), info, 1.5);
  content.labels.push_back({p, lamp.label, colour, {}, (selected ? kRing : kStar) * r});
  content.glyphs.push_back(std::move(corners));
  content.extent.push_back(p);
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
                  formatted("%.3g m", apart) + " away from here: this light explains the contours with one limit angle");
    }
  return "";
}

}  // namespace

LayerContent lightLayer(const LayerInput& in) {
  LayerContent content;
  for (const auto& [id, outcome] : in.inspection->lightsFor(in.selection.frame)) {
    if (!*outcome || (**outcome).known || in.hidden.lights.count(id)) continue;  // a known one is drawn as the scene's own
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
    addEstimate(content, in, estimateThing(id, estimate.light, in.scale), 1, info);
  }
  // A model may refine the light by itself: drawn smaller, in the model's colour, where it differs from the common one.
  for (const std::string& model : in.models) {
    for (const ModelFit* fit : in.fits(model)) {
      const std::optional<SceneThing> lamp = fittedLampThing(*in.inspection, *fit, in.scale);
      if (!lamp || lamp->shared) continue;
      Picked info;
      info.layer = "light";
      info.model = model;
      info.light = fit->light;
      info.text = line("light of model", model);
      if (fit->limitAngle()) info.text += line("limit angle", *fit->limitAngle() * 180 / std::numbers::pi, "deg");
      if (const std::optional<Lamp> shape = fit->lamp(); shape && !shape->atInfinity()) info.text += sizeText(*shape);
      addEstimate(content, in, *lamp, 0.7, info);
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
    info.text = line(light.known ? "known light (fits keep it)" : "true light (not used by the method)", light.id) +
                (lamp.isPoint() ? line("radius", 0.0, "m") : sizeText(lamp));
    const double r = std::max(radiusOf(lamp), 4.2 * in.scale.point);
    const SceneThing drawn = trueLampThing(light, r, in.scale);
    if (!endsOf(lamp)) info.text += placeText(in, drawn);
    if (drawn.arrow) {
      addArrow(content, in, drawn, info);
      continue;
    }
    const Eigen::Vector3d middle = drawn.position();
    addBody(content, drawn.chains, kTruth, 2.5, info);
    content.add(sphereActor({middle}, 0.5 * in.scale.point, kTruth), info);  // its middle: a full ball would hide the fits in it
    content.labels.push_back({middle, drawn.label, kTruth, {}, r});
    content.extent.push_back(middle);
  }
  return content;
}

}  // namespace glint::viz
