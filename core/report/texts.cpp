// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/texts.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>

#include "core/base/number_text.h"
#include "core/base/permitted.h"
#include "core/base/words.h"
#include "core/scene/capture.h"
#include "core/scene/frame_name.h"
#include "core/scene/scene_files.h"

namespace glint {

namespace {
/// As short as it can be without losing a bit.
std::string shortest(double v) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, v).ptr;
  return std::string(buffer, end);
}

std::string text(const SettingValue& value) {
  if (const auto* s = std::get_if<std::string>(&value)) return *s;
  if (const auto* b = std::get_if<bool>(&value)) return *b ? "true" : "false";
  if (const auto* i = std::get_if<int>(&value)) return std::to_string(*i);
  return shortest(std::get<double>(value));
}

/// Whether a file lies where the command needs permission to look. The inspector remembers permissions, a command does not.
bool namesFilesOutside(const Scene& scene) {
  if (scene.allowOutsidePaths) return true;
  std::vector<std::filesystem::path> named{std::filesystem::absolute(scene.file).parent_path()};
  for (const FilesFolder& f : scene.folders) named.push_back(f.folder);
  for (const auto& [mesh, file] : scene.meshes) named.push_back(file);
  for (const std::filesystem::path& folder : foldersOfCapture(scene.file)) named.push_back(folder);
  if (!scene.choices.surfaceFile.empty()) named.push_back(scene.choices.surfaceFile);
  const std::vector<std::filesystem::path> files = filesOf(scene);
  return std::any_of(files.begin(), files.end(), [&](const std::filesystem::path& file) { return !liesIn(named, file); });
}

}  // namespace

std::string shellWord(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string("_-./=:,+@%").find(c) != std::string::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), plain)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

Outcome<std::string> commandOf(const Scene& scene, const InspectionRequest& q) {
  if (!q.whatIf.none()) return Failure{Reason::NotSupported, "a what-if has no flag; save a session and use it as INPUT"};
  const InspectionRequest usual;
  // The command is pasted into a shell in another folder.
  const auto absolute = [](const std::filesystem::path& path) {
    return std::filesystem::absolute(path).lexically_normal().string();
  };
  const auto place = [&](const std::filesystem::path& path) { return shellWord(absolute(path)); };
  std::string command = "glint evaluate " + place(scene.file);
  if (q.models != usual.models) {
    std::string models;
    for (const std::string& m : q.models) models += (models.empty() ? "" : ",") + m;
    command += " --models " + shellWord(models);
  }
  if (q.train != usual.train) command += " --train " + shellWord(q.train);
  if (!q.excluded.empty()) {
    const std::string spec = frameSpec(q.excluded, scene);
    bool readsBack = false;
    try {
      readsBack = parseFrames(spec, scene, "--exclude") == q.excluded;
    } catch (const InputError&) {
      // Ids with commas that read like numbers.
    }
    if (!readsBack)
      return Failure{Reason::NotSupported, "the excluded frames cannot be written as a SPEC; save a session and use it as INPUT"};
    command += " --exclude " + shellWord(spec);
  }
  if (q.source != usual.source) command += q.source == FrameSource::Image ? " --source image" : " --source radiance";
  for (const auto& [key, value] : q.settings.values()) command += " --set " + shellWord(key + "=" + text(value));
  if (q.noisePx > 0) command += " --noise-px " + shortest(q.noisePx) + " --seed " + std::to_string(q.seed);
  if (!q.truthFolder.empty()) command += " --truth " + place(q.truthFolder);
  if (namesFilesOutside(scene)) command += " --allow-outside";
  for (const FilesFolder& f : scene.folders)
    command += f.kind == FrameFile::Photograph ? " --photographs " + place(f.folder)
                                               : " --files " + shellWord(nameOf(f.kind) + ("=" + absolute(f.folder)));
  for (const ChoiceOption& option : choiceOptions())
    if (const std::string choice = option.textOf(scene.choices); !choice.empty())
      command += std::string(" ") + option.flag + " " + shellWord(choice);
  for (const auto& [named, file] : scene.meshes) command += " --mesh " + shellWord(named + "=" + absolute(file));
  return command;
}

std::optional<BandScore> bandSummary(const Inspection& inspection, const ModelResult& result) {
  BandScore mean;
  double count = 0;
  for (const ComparisonTally& tally : talliesOf(inspection, result))
    for (const BandScore& band : tally.bands) {
      mean.sigmaPx += band.sigmaPx;
      mean.coverage += band.coverage;
      count += 1;
    }
  if (!(count > 0)) return std::nullopt;
  mean.sigmaPx /= count;
  mean.coverage /= count;
  return mean;
}

std::vector<std::string> bandLines(const Inspection& inspection, const ModelResult& result) {
  std::vector<std::string> lines;
  if (const std::optional<BandScore> score = bandSummary(inspection, result)) {
    const std::string text =
        formatted("bands: sigma %.3g px; %.1f %% of the vertices lie within 1.96 sigma of the %s contours", score->sigmaPx,
                  100 * score->coverage, inspection.request.truthFolder.empty() ? "observed" : "true");
    lines.emplace_back(text);
  }
  for (const ModelResult::Fit& fit : result.fits)
    for (const std::string& remark : fit.bandRemarks)
      lines.push_back((result.fits.size() > 1 ? textOf(fit.key()) + ": " : "") + remark);
  return lines;
}

namespace {

/// Frames that the inspection looked at and that train or are scored.
bool counts(const Inspection& inspection, const FrameEvidence& e) {
  return e.frame >= 0 && (inspection.isTraining(e.frame) || inspection.isHeldOut(e.frame));
}

/// The warning about clipped highlights with their frames; "" without any. Clipping takes the peak away to which the contour's
/// level refers.
std::string clippedWarning(const Inspection& inspection) {
  std::vector<std::string> training, others;
  bool known = true;  // a lobe says what was cut off
  for (const FrameEvidence& e : inspection.evidence) {
    const auto clipped = [](const Highlight& h) { return h.clipped; };
    if (!counts(inspection, e) || std::none_of(e.highlights.begin(), e.highlights.end(), clipped)) continue;
    for (const Highlight& h : e.highlights) known = known && (!h.clipped || h.trueLevel);
    (inspection.isTraining(e.frame) ? training : others).push_back(frameName(*inspection.scene, e.frame));
  }
  if (training.empty() && others.empty()) return "";
  std::string text = "clipped (saturated) highlights in ";
  if (!training.empty()) text += "training " + framesText(training);
  if (!others.empty()) text += (training.empty() ? "" : " and other ") + framesText(others);
  return text + (known ? ": the peak, and so the level of the contour, comes from the lobe fitted around the clipped pixels"
                       : ": the peak is unknown, so a contour lies at a smaller fraction of it than the stated level");
}

/// The warning about frames whose colours do not tell what is specular (detect.background = colours), with reasons; or "".
std::string notSeparatedWarning(const Inspection& inspection) {
  std::map<std::string, std::vector<std::string>> frames;
  for (const FrameEvidence& e : inspection.evidence)
    if (counts(inspection, e) && !e.notSeparated.empty()) frames[e.notSeparated].push_back(frameName(*inspection.scene, e.frame));
  std::string text;
  for (const auto& [reason, which] : frames) text += (text.empty() ? "" : "; ") + framesText(which) + " (" + reason + ")";
  return text.empty() ? "" : "colours do not tell what is specular, and the smooth background is used, in " + text;
}

}  // namespace

std::string fitWarning(const std::string& model, const std::string& light, const std::optional<std::string>& surface,
                       const std::string& remark) {
  return model + ", " + lightName(light) + (surface ? ", surface " + *surface : "") + ": " + remark;
}

std::string poorWarning(const std::string& reason) { return "poor: " + reason; }

std::vector<std::string> warningsOf(const Inspection& inspection) {
  std::vector<std::string> warnings;
  for (std::string warning : {clippedWarning(inspection), notSeparatedWarning(inspection)})
    if (!warning.empty()) warnings.push_back(std::move(warning));
  for (const std::string& name : inspection.request.models) {
    const auto model = inspection.models.find(name);
    if (model == inspection.models.end()) continue;
    for (const ModelResult::Fit& fit : model->second.fits) {
      if (!fit.fit) continue;
      if (!fit.fit->poor.empty()) warnings.push_back(fitWarning(name, fit.light, fit.surface, poorWarning(fit.fit->poor)));
      for (const std::string& remark : fit.fit->remarks) warnings.push_back(fitWarning(name, fit.light, fit.surface, remark));
    }
  }
  return warnings;
}

std::string scoredAgainst(const Inspection& inspection) {
  if (!inspection.request.truthFolder.empty()) return "truth";
  bool given = false, detected = false;
  for (const FrameEvidence& e : inspection.evidence)
    if (e.frame >= 0 && inspection.isHeldOut(e.frame))
      for (const Highlight& h : e.scored()) (h.fromScene ? given : detected) = true;
  return given && !detected ? "given contours" : "own detection";
}

}  // namespace glint
