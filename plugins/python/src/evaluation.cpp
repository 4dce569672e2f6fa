// SPDX-License-Identifier: BSD-3-Clause
#include "plugins/python/src/evaluation.h"

#include <algorithm>
#include <cmath>

#include "core/pipeline/level_choice.h"
#include "core/report/evaluation.h"
#include "core/scene/frame_name.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/progress.h"

namespace glint::python {
namespace {

constexpr const char* kAutoLevel = "auto";

void requireModels(const std::vector<std::string>& models) {
  std::string all;
  for (const std::string& m : models) all += (all.empty() ? "" : ",") + m;
  for (auto m = models.begin(); m != models.end(); ++m) {
    modelByName(*m);
    if (std::find(models.begin(), m, *m) != m) throw InputError("", "--models " + all, "'" + *m + "' is named twice");
  }
}

void setLevel(const std::string& level, Settings& settings) {
  try {
    settings.setFromText("detect.level", level);
  } catch (const InputError&) {
    throw InputError("", "--level " + level, "must be a fraction of the peak, more than 0 and less than 1");
  }
}

bool asksForWalks(py::handle settings) {
  if (!settings || settings.is_none()) return false;
  const auto dictionary = py::reinterpret_borrow<py::dict>(settings);
  return dictionary.contains("predict.query") || dictionary.contains("predict_query");
}

}  // namespace

InspectionRequest requestAsAsked(const SceneHandle& scene, const RequestHandle* request,
                                 const std::optional<std::vector<std::string>>& models, const std::optional<std::string>& train,
                                 const std::optional<std::string>& exclude, const std::optional<std::string>& level,
                                 const std::optional<std::string>& source, py::handle settings) {
  InspectionRequest r = request ? request->request : InspectionRequest{};
  if (models) r.models = *models;
  requireModels(r.models);
  if (train) r.train = *train;
  if (source && *source != "radiance" && *source != "image")
    throw py::value_error("source: expected \"radiance\" or \"image\", not \"" + *source + "\"");
  if (source) r.source = *source == "image" ? FrameSource::Image : FrameSource::Radiance;
  applySettings(settings, r.settings);
  if (exclude) {
    r.excluded = parseFrames(*exclude, *scene.scene, "--exclude");
    if (r.excluded.size() == scene.scene->frames.size()) throw InputError("", "--exclude " + *exclude, "excludes every frame");
  }
  if (level && *level != kAutoLevel) setLevel(*level, r.settings);
  return r;
}

std::string chooseLevelIfAsked(const Scene& scene, const std::optional<std::string>& level, InspectionRequest& request,
                               const ProgressFn& progress) {
  if (!level || *level != kAutoLevel) return "";
  std::vector<int> frames = parseTrainSpec(request.train, scene).frames;
  std::erase_if(frames,
                [&](int f) { return std::find(request.excluded.begin(), request.excluded.end(), f) != request.excluded.end(); });
  if (frames.empty()) throw InputError("", "--level auto", "no training frame is left to choose a level by");
  const LevelChoice choice = valueOf(chooseLevel(scene, frames, request.source, request.settings, progress));
  request.settings.set("detect.level", choice.level);
  return choice.reason;
}

InspectionHandle inspectAsAsked(const SceneHandle& scene, const RequestHandle* request,
                                const std::optional<std::vector<std::string>>& models, bool choose,
                                std::optional<double> goodEnoughPct, const std::optional<std::string>& train,
                                const std::optional<std::string>& exclude, const std::optional<std::string>& level,
                                const std::optional<std::string>& source, double noisePx, unsigned seed, const std::string& truth,
                                py::handle settings, const InspectionHandle* previous, py::object progress) {
  InspectionRequest r = requestAsAsked(scene, request, models, train, exclude, level, source, settings);
  if (!(noisePx >= 0 && std::isfinite(noisePx))) throw InputError("", "--noise-px", "must be finite and not negative");
  if (noisePx > 0) {
    r.noisePx = noisePx;
    r.seed = seed;
  }
  if (!truth.empty()) r.truthFolder = truth;
  if (goodEnoughPct && !(*goodEnoughPct > 0 && std::isfinite(*goodEnoughPct)))
    throw InputError("", "--good-enough-pct", "expected a positive number, in percent");
  const EvaluationQuestion question{choose, goodEnoughPct, asksForWalks(settings)};
  Evaluation e = withProgress(std::move(progress), [&](const ProgressFn& report) {
    ReportContext context;
    context.input = scene.input;
    context.levelReason = chooseLevelIfAsked(*scene.scene, level, r, report);
    return evaluate(scene.scene, std::move(r), std::move(context), question, report,
                    previous ? previous->inspection.get() : nullptr);
  });
  return {std::make_shared<const Inspection>(std::move(e.inspection)), std::move(e.report), std::move(e.failure)};
}

}  // namespace glint::python
