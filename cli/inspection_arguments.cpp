// SPDX-License-Identifier: BSD-3-Clause
#include "cli/inspection_arguments.h"

#include <sstream>

namespace glint::cli {

std::vector<std::string> splitList(const std::string& text, const std::string& flag) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  std::string part;
  while (std::getline(stream, part, ',')) {
    if (part.empty()) throw InputError("", flag + " " + text, "empty entry");
    parts.push_back(part);
  }
  if (parts.empty()) throw InputError("", flag, "names nothing");
  return parts;
}

void InspectionArguments::declare(Options& o, const std::string& modelsHelp) {
  o.positional(input, "INPUT", "A scene file, a folder with one, or a session");
  o.option(models, "--models,--model", "NAME[,NAME...]", modelsHelp);
  o.option(train, "--train", "SPEC", "Training frames: numbers, ids or ranges (0-5,14), first:K, spread:K, or per-surface");
  o.option(level, "--level", "Q", "Contour level, fraction of the peak above the background (default 0.5)");
  o.choice(source, "--source", {"radiance", "image"}, "Where both exist: the float radiance or the captured image");
  o.repeated(set, "--set", "KEY=VALUE", "Any setting by its dotted name (`glint settings` lists them); may be repeated");
  o.option(noisePx, "--noise-px", "S", "Gaussian noise per coordinate on training contours (72 points) and peaks, px");
  o.option(seed, "--seed", "N", "Seed of that noise");
  o.option(truth, "--truth", "DIR", "Score against contours stored as FRAME.json instead of the own detection");
  o.flag(allowOutside, "--allow-outside", "Accept paths that leave the folder of the scene file");
}

InspectionRequest InspectionArguments::request() const {
  InspectionRequest r;
  if (!models.empty() && models != "auto") r.models = splitList(models, "--models");
  for (const std::string& m : r.models) modelByName(m);
  r.train = train;
  r.source = source == "image" ? FrameSource::Image : FrameSource::Radiance;
  for (const std::string& entry : set) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos) throw InputError("", "--set " + entry, "expected KEY=VALUE");
    r.settings.setFromText(entry.substr(0, equals), entry.substr(equals + 1));
  }
  if (!level.empty()) {
    try {
      r.settings.setFromText("detect.level", level);
    } catch (const InputError& e) {
      throw InputError("", "--level " + level, "the level is a number from 0.02 to 0.98");
    }
  }
  if (!(noisePx >= 0)) throw InputError("", "--noise-px", "must not be negative");
  r.noisePx = noisePx;
  r.seed = seed;
  r.truthFolder = truth;
  return r;
}

std::shared_ptr<const Scene> InspectionArguments::scene() const {
  return std::make_shared<const Scene>(readScene(input, ReadOptions{allowOutside}));
}

void requireUsableViews(const Inspection& inspection) {
  std::string first;
  for (const TrainingView& v : inspection.views) {
    if (!v.failure) return;
    if (first.empty()) first = "frame " + std::to_string(v.frame) + ": " + v.failure->message();
  }
  for (const int frame : inspection.train.frames)
    if (first.empty() && inspection.evidence[frame].failure)
      first = "frame " + std::to_string(frame) + ": " + inspection.evidence[frame].failure->message();
  throw CannotAnswer{{Reason::TooFewViews, "no training frame could be used" + (first.empty() ? "" : "; " + first)}};
}

}  // namespace glint::cli
