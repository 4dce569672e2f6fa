// SPDX-License-Identifier: BSD-3-Clause
#include "cli/inspection_arguments.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>

#include "core/app/session.h"
#include "core/choice/tradeoff.h"
#include "core/model/model.h"
#include "core/pipeline/level_choice.h"
#include "core/report/evaluation.h"
#include "core/scene/frame_name.h"

namespace glint::cli {

std::string modelNames() {
  std::string names;
  for (const std::string& id : modelIds()) names += (names.empty() ? "" : ", ") + id;
  return names;
}

std::vector<std::string> splitList(const std::string& text, const std::string& flag) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  std::string part;
  while (std::getline(stream, part, ',')) {
    if (part.empty()) throw InputError("", flag + " " + text, "empty entry");
    parts.push_back(part);
  }
  if (parts.empty()) throw InputError("", flag, "expected at least one name");
  return parts;
}

void applyPreset(const Session& session, const std::string& preset, InspectionRequest& request) {
  if (!session.tradeoff)
    throw InputError("", "--preset " + preset,
                     "the session has no trade-off; run `glint tradeoff " + session.file.string() + "` first");
  const TradeoffPoint& point = pointOfPreset(*session.tradeoff, preset);
  request.models = {point.model};
  request.settings = point.settings;
}

void InspectionArguments::declare(Options& o, const std::string& modelsHelp) {
  o.positional(input, "INPUT",
               "Scene file, capture of another program (COLMAP, nerfstudio ...), folder that contains one, or session");
  o.option(models, "--models,--model", "NAME[,NAME...]", modelsHelp);
  o.option(train, "--train", "SPEC",
           "Training frames: numbers, ids or ranges (0-5,14), first:K, spread:K, or per-surface (default: the session's, else "
           "first:6)");
  o.option(exclude, "--exclude", "SPEC", kExcludeHelp);
  o.option(level, "--level", "Q",
           "Contour level: fraction of the peak above the background, or auto: chosen by the training frames, with the reason "
           "(default: the session's, else 0.5)");
  o.choice(source, "--source", {"", "radiance", "image"},
           "Pixels to use where a frame has both: float radiance or captured image (default: the session's, else radiance)");
  o.option(preset, "--preset", "NAME", "Take model and settings from the session's trade-off: fast, balanced, exact or chosen");
  o.repeated(set, "--set", "KEY=VALUE", "Any setting by its dotted name (`glint settings` lists them); may be repeated");
  o.option(noisePx, "--noise-px", "S", "Add Gaussian noise to each coordinate of training contours (72 points) and peaks, px");
  o.option(seed, "--seed", "N", "Seed of the noise");
  o.option(truth, "--truth", "DIR", "Score against contours stored as FRAME.json instead of detected ones");
  places.declare(o);
}

void exclude(const std::string& spec, const Scene& scene, InspectionRequest& request) {
  if (spec.empty()) return;
  request.excluded = parseFrames(spec, scene, "--exclude");
  if (request.excluded.size() == scene.frames.size()) throw InputError("", "--exclude " + spec, "excludes every frame");
}

void applyEach(Settings& settings, const std::vector<std::string>& keysAndValues) {
  for (const std::string& text : keysAndValues) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw InputError("", "--set " + text, "expected KEY=VALUE");
    settings.setFromText(text.substr(0, equals), text.substr(equals + 1));
  }
}

InspectionRequest InspectionArguments::request() const {
  InspectionRequest r;
  const bool isSession = std::filesystem::path(input).extension() == ".glint";
  if (!preset.empty() && !isSession) throw InputError("", "--preset " + preset, "INPUT is not a session, so it has no trade-off");
  if (isSession) {
    const Session session = places.readRequestOf(input, truth.empty());
    r = session.request;
    if (!preset.empty()) applyPreset(session, preset, r);
  }
  if (!models.empty() && models != "auto") r.models = splitList(models, "--models");
  for (auto m = r.models.begin(); m != r.models.end(); ++m) {
    modelByName(*m);
    if (std::find(r.models.begin(), m, *m) != m) throw InputError("", "--models " + models, "'" + *m + "' is named twice");
  }
  if (!train.empty()) r.train = train;
  if (!source.empty()) r.source = source == "image" ? FrameSource::Image : FrameSource::Radiance;
  applyEach(r.settings, set);
  if (!level.empty() && level != kAutoLevel) {
    try {
      r.settings.setFromText("detect.level", level);
    } catch (const InputError& e) {
      throw InputError("", "--level " + level, kLevelRange);
    }
  }
  if (!(noisePx >= 0 && std::isfinite(noisePx))) throw InputError("", "--noise-px", "must be finite and not negative");
  if (noisePx > 0) {
    r.noisePx = noisePx;
    r.seed = seed;
  }
  if (!truth.empty()) r.truthFolder = truth;
  return r;
}

bool InspectionArguments::sets(const std::string& key) const {
  return std::any_of(set.begin(), set.end(), [&](const std::string& entry) { return entry.rfind(key + "=", 0) == 0; });
}

std::shared_ptr<const Scene> InspectionArguments::scene(InspectionRequest& request, std::string* levelReason) const {
  auto scene = std::make_shared<const Scene>(places.read(input));
  cli::exclude(exclude, *scene, request);
  if (level == kAutoLevel) {
    std::vector<int> frames = parseTrainSpec(request.train, *scene).frames;
    std::erase_if(
        frames, [&](int f) { return std::find(request.excluded.begin(), request.excluded.end(), f) != request.excluded.end(); });
    if (frames.empty()) throw InputError("", "--level auto", "no training frame is left to choose a level by");
    photographs = std::make_shared<const PhotographsHeld>(*scene, frames);
    const Outcome<LevelChoice> choice = chooseLevel(*scene, frames, request.source, request.settings);
    if (!choice) throw CannotAnswer{choice.failure()};
    request.settings.set("detect.level", choice->level);
    if (levelReason) *levelReason = choice->reason;
  }
  return scene;
}

void warnOfUnusedTrainingFrames(const Inspection& inspection, const Context& context) {
  const std::vector<std::string> unused = unusedTrainingFrames(inspection);
  if (unused.empty()) return;
  context.warn(std::to_string(unused.size()) + " of " + std::to_string(inspection.train.frames.size()) +
               " training frames could not be used; first: " + unused.front());
}

void requireUsableViews(const Inspection& inspection) {
  if (std::optional<Failure> none = noUsableView(inspection)) throw CannotAnswer{*std::move(none)};
}

void requireLights(const Inspection& result) {
  std::set<std::string> ids;
  for (const auto& [name, model] : result.models)
    for (const ModelResult::Fit& fit : model.fits) ids.insert(fit.light);
  std::string all;
  for (const std::string& id : ids) all += (all.empty() ? "" : ", ") + id;
  for (const std::string& id : result.request.lights)
    if (!ids.count(id)) throw InputError("", "--light", "no light '" + id + "' is fitted or known; there are: " + all);
}

}  // namespace glint::cli
