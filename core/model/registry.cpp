// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/base/words.h"
#include "core/model/models.h"

namespace glint {

namespace {
std::vector<std::unique_ptr<HighlightModel>>& registered() {
  static std::vector<std::unique_ptr<HighlightModel>> models = [] {
    std::vector<std::unique_ptr<HighlightModel>> m;
    m.push_back(makePrimal());
    m.push_back(makeDual());
    m.push_back(makeCanonical());
    m.push_back(makeLimitAngle());
    m.push_back(makeReflectance());
    return m;
  }();
  return models;
}
}  // namespace

const std::vector<std::unique_ptr<HighlightModel>>& allModels() { return registered(); }

void addModel(std::unique_ptr<HighlightModel> model) {
  require(model && !findModel(model->id()), "addModel: a model needs its own name");
  registered().push_back(std::move(model));
}

const HighlightModel* findModel(const std::string& id) {
  for (const auto& m : allModels())
    if (m->id() == id) return m.get();
  return nullptr;
}

const HighlightModel& modelByName(const std::string& id) {
  if (const HighlightModel* const found = findModel(id)) return *found;
  std::string known;
  for (const std::string& name : modelIds()) known += (known.empty() ? "" : ", ") + name;
  const std::string meant = didYouMean(id, modelIds());
  throw InputError("", "model '" + id + "'",
                   "unknown model" + meant + (meant.empty() ? "; known: " : " Known: ") + known + kPluginHint);
}

std::vector<std::string> modelIds() {
  std::vector<std::string> ids;
  for (const auto& m : allModels()) ids.push_back(m->id());
  return ids;
}

const HighlightModel& canonicalModel() { return modelByName("canonical"); }
const HighlightModel& levelSetModel() { return modelByName("limit-angle"); }
const HighlightModel& radianceModel() { return modelByName("reflectance"); }

Outcome<std::vector<BrightestPoint>> brightestPointsFor(const Surface& surface, const Camera& camera, const Light& light,
                                                        const Settings& settings, const std::vector<SurfacePoint>& hints) {
  BrightestPointOptions options;
  if (!hints.empty() && settings.text("predict.search") == "hints") {
    // The hint that is already closest to the reflection law; its own normal is close enough to judge that.
    const Eigen::Vector3d eye = camera.centreInWorld();
    const SurfacePoint* best = nullptr;
    double highest = -1;  // cosine of alpha: no inverse function is needed to compare
    for (const SurfacePoint& p : hints) {
      const Eigen::Vector3d h = light.directionFrom(p.position) + (eye - p.position).normalized();
      const double cosine = p.normal.dot(h) / h.norm();
      if (cosine > highest) highest = cosine, best = &p;
    }
    if (best) {
      options.hints = {best->position};
      options.hintsOnly = true;
      Outcome<std::vector<BrightestPoint>> found = predictedBrightestPoints(surface, camera, light, options);
      if (found) return found;
      options.hints.clear();
      options.hintsOnly = false;
    }
  }
  options.seedStepPx = settings.number("predict.seed_step");
  Outcome<std::vector<BrightestPoint>> found = predictedBrightestPoints(surface, camera, light, options);
  if (found) return found;
  options.marginFraction = kMarginFraction;  // rarely needed, and five times the rays
  Outcome<std::vector<BrightestPoint>> beyond = predictedBrightestPoints(surface, camera, light, options);
  return beyond ? beyond : found;
}

std::vector<SurfacePoint> hintsOf(const FitInput& input) {
  std::vector<SurfacePoint> hints;
  std::vector<int> frames;
  for (const TrainingView& v : input.views) {
    if (std::find(frames.begin(), frames.end(), v.frame) != frames.end())
      return {};  // several highlights: one start does not find all
    frames.push_back(v.frame);
    if (v.seen) hints.push_back(v.seen->brightest.point);
  }
  return hints;
}

void dropEnclosed(std::vector<PredictedHighlight>& highlights) {
  if (highlights.size() < 2) return;
  std::stable_sort(highlights.begin(), highlights.end(), [](const PredictedHighlight& a, const PredictedHighlight& b) {
    return std::abs(signedArea(a.contour)) > std::abs(signedArea(b.contour));
  });
  std::vector<PredictedHighlight> kept;
  for (PredictedHighlight& h : highlights) {
    const bool enclosed = std::any_of(kept.begin(), kept.end(),
                                      [&](const PredictedHighlight& k) { return contains(k.contour, h.brightest.pixel); });
    if (!enclosed) kept.push_back(std::move(h));
  }
  highlights = std::move(kept);
}

}  // namespace glint
