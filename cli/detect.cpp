// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numeric>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/base/atomic_file.h"
#include "core/base/image.h"
#include "core/base/number_text.h"
#include "core/base/progress.h"
#include "core/highlight/report.h"
#include "core/pipeline/depth_motion.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/level_choice.h"
#include "core/scene/outputs.h"
#include "core/surface/mesh_policy.h"

namespace glint::cli {
namespace {

/// Points out contours that may be off by more than this, % of the diameter: predictions from exact contours are better.
constexpr double kWorthSayingPct = 0.25;

constexpr std::size_t kRejectedLines = 3;  // of a frame in the table; the JSON has them all

struct DetectArguments {
  std::string input, source = "radiance", out, json, level = "0.5";
  std::vector<std::string> set;
  std::string separate = "off";
  bool parts = false;
  SceneArguments places;
};

/// Blur of a frame's edges; clipped ones look sharper than they are.
std::optional<FrameBlur> blurOf(const LinearPixels& pixels) {
  Image image = pixels.value;
  for (std::size_t i = 0; i < image.data.size(); ++i)
    if (pixels.clipped[i]) image.data[i] = std::numeric_limits<float>::quiet_NaN();
  const Outcome<FrameBlur> blur = measureBlur(image, 0);
  return blur ? std::optional(*blur) : std::nullopt;
}

/// The surface of a frame, where there is one that can be read: detection needs none.
std::shared_ptr<const Surface> anySurface(const SurfaceCache& surfaces, int frame, const Settings& settings) {
  try {
    Outcome<std::shared_ptr<const Surface>> surface = surfaces.surfaceOf(frame, meshPolicy(settings));
    return surface ? *std::move(surface) : nullptr;
  } catch (const InputError&) {
    return nullptr;
  }
}

/// Depth maps are left out: a surface for each frame takes longer than its detection.
std::shared_ptr<const Surface> surfaceIn(const Scene& scene, const SurfaceCache& surfaces, int frame, const Settings& settings) {
  return scene.frames[static_cast<std::size_t>(frame)].surface.empty() ? nullptr : anySurface(surfaces, frame, settings);
}

/// One frame by itself.
struct Seen {
  FrameEvidence evidence;
  std::shared_ptr<const Surface> surface;
  std::vector<HighlightQuality> quality;
  std::optional<FrameBlur> blur;
  std::optional<SpecularSeparation> separation;
};

/// The uncertainty of a contour on the specular part: noise and leftover diffuse light. No tail passes for background there.
void qualityOfSeparated(const SpecularSeparation& separation, Seen& seen) {
  for (std::size_t i = 0; separation.separated && i < seen.quality.size(); ++i) {
    seen.quality[i].noisePx = movedBy(separation.regions[i].noise, seen.evidence.highlights[i]);
    seen.quality[i].backgroundPx = movedBy(separation.regions[i].leftover, seen.evidence.highlights[i]);
  }
}

Seen seenIn(const Scene& scene, const SurfaceCache& surfaces, int index, FrameSource source, const Settings& settings,
            bool separate) {
  const Frame& frame = scene.frames[static_cast<std::size_t>(index)];
  Seen seen;
  seen.evidence = gatherEvidence(scene, index, source, settings);
  if (separate) seen.separation = separateEvidence(scene, index, source, settings, seen.evidence);
  if (const Outcome<LinearPixels> pixels = pixelsOf(frame, source, settings)) {
    seen.blur = blurOf(*pixels);
    seen.surface = surfaceIn(scene, surfaces, index, settings);
    seen.quality = highlightQualities(frame, *pixels, seen.surface.get(), seen.blur, seen.evidence.highlights);
    if (seen.separation) qualityOfSeparated(*seen.separation, seen);
  }
  return seen;
}

/// What the motion over all frames says goes to the flags, or takes a highlight out.
void applyMotion(const std::vector<MotionVerdict>& verdicts, MotionUse use, const Camera& camera, Seen& seen) {
  std::vector<HighlightQuality> kept;
  std::vector<SeparatedRegion> regions;
  for (std::size_t i = 0; i < seen.quality.size() && i < verdicts.size(); ++i) {
    if (use == MotionUse::Reject && verdicts[i].kind == MotionVerdict::Kind::Texture) continue;
    if (seen.separation && i < seen.separation->regions.size()) regions.push_back(seen.separation->regions[i]);
    if (const std::string text = verdicts[i].text(); !text.empty()) seen.quality[i].flags.push_back(text);
    kept.push_back(std::move(seen.quality[i]));
  }
  seen.quality = std::move(kept);
  if (seen.separation) seen.separation->regions = std::move(regions);
  if (use == MotionUse::Reject) withholdTextures(seen.evidence, verdicts, camera);
}

DetectedFrame detectedIn(const Frame& frame, Seen seen) {
  if (seen.surface && seen.quality.size() == seen.evidence.highlights.size())
    flagStrangers(frame, *seen.surface, seen.evidence.highlights, seen.quality);
  DetectedFrame result;
  result.id = frame.id;
  result.failure = std::move(seen.evidence.failure);
  result.separation = std::move(seen.separation);
  for (RejectedCandidate& r : seen.evidence.rejected) {
    r.place = frame.camera.undistorted(r.place);
    if (r.place.allFinite()) result.rejected.push_back(std::move(r));
  }
  result.blur = seen.blur;
  result.highlights = std::move(seen.evidence.highlights);
  result.quality = std::move(seen.quality);
  for (std::size_t i = 0; i < result.quality.size(); ++i) {
    const double diameter = std::sqrt(4 / M_PI * result.highlights[i].areaPx2);
    result.uncertaintyPct.push_back(diameter > 0 ? 100 * result.quality[i].backgroundPx / diameter : 0);
  }
  return result;
}

std::vector<DetectedFrame> detectAll(const Scene& scene, FrameSource source, const Settings& settings, bool separate,
                                     const ProgressFn& progress) {
  const SurfaceCache surfaces(scene);
  const int n = static_cast<int>(scene.frames.size());
  std::vector<Seen> seen(scene.frames.size());
  parallelFor(
      n, [&](int i) { seen[static_cast<std::size_t>(i)] = seenIn(scene, surfaces, i, source, settings, separate); }, progress,
      "detect");
  std::vector<std::vector<MotionVerdict>> verdicts(seen.size());
  if (motionUse(settings) != MotionUse::Off) {
    const std::vector<std::vector<int>> panels = motionPanels(scene, surfaces);
    std::vector<FrameEvidence> evidence;
    for (const Seen& s : seen) evidence.push_back(s.evidence);
    const PanelDepths depths(scene, settings);
    parallelFor(
        n,
        [&](int i) {
          const auto k = static_cast<std::size_t>(i);
          // A depth map becomes a surface only where a spot stays on its point.
          const auto surface = [&] { return seen[k].surface ? seen[k].surface : anySurface(surfaces, i, settings); };
          verdicts[k] = judgedByMotion(scene, i, panels[k], evidence, surface, depths, settings);
        },
        progress, "motion");
  }
  std::vector<DetectedFrame> frames;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (!verdicts[k].empty()) applyMotion(verdicts[k], motionUse(settings), scene.frames[k].camera, seen[k]);
    frames.push_back(detectedIn(scene.frames[k], std::move(seen[k])));
  }
  return frames;
}

std::string flagsText(const DetectedFrame& frame, std::size_t i) {
  std::string text;
  if (i < frame.quality.size())
    for (const std::string& flag : frame.quality[i].flags) text += (text.empty() ? "" : "; ") + flag;
  return text;
}

std::string table(const std::vector<DetectedFrame>& frames) {
  std::string text = "frame         light         peak x    peak y      area px2   axes px          sigma px  flags\n";
  for (const DetectedFrame& frame : frames) {
    if (frame.failure) {
      text += formatted("%-12.40s  -  %.180s\n", frame.id.c_str(), frame.failure->message().c_str());
    }
    for (std::size_t i = 0; i < frame.highlights.size(); ++i) {
      const Highlight& h = frame.highlights[i];
      std::string axes = "-", sigma = "-";
      if (h.ellipse) axes = formatted("%.2f x %.2f", h.ellipse->semiAxes.x(), h.ellipse->semiAxes.y());
      if (i < frame.quality.size()) sigma = formatted("%.2f", frame.quality[i].contourSigmaPx());
      text += formatted("%-12.40s  %-10.40s  %8.3f  %8.3f  %12.1f   %-15s  %8s  ", frame.id.c_str(), h.light.c_str(), h.peak.x(),
                        h.peak.y(), h.areaPx2, axes.c_str(), sigma.c_str()) +
              flagsText(frame, i) + "\n";
    }
    if (frame.separation && !frame.highlights.empty())
      text += formatted("%-12.40s  specular and diffuse %sseparated%s%.300s\n", frame.id.c_str(),
                        frame.separation->separated ? "" : "not ", frame.separation->separated ? "" : ": ",
                        frame.separation->reason.c_str());
    for (std::size_t i = 0; i < std::min(kRejectedLines, frame.rejected.size()); ++i) {
      const RejectedCandidate& r = frame.rejected[i];
      text += formatted("%-12.40s  rejected    %8.3f  %8.3f  %12.1f   %s\n", frame.id.c_str(), r.place.x(), r.place.y(),
                        r.areaPx2, r.reason.c_str());
    }
    if (frame.rejected.size() > kRejectedLines)
      text +=
          formatted("%-12.40s  rejected    and %zu more (--json)\n", frame.id.c_str(), frame.rejected.size() - kRejectedLines);
  }
  return text;
}

/// The level that the user gave or asked to be chosen; in the second case also why. Settings that the command line names count.
std::string setLevel(const DetectArguments& a, const Scene& scene, FrameSource source, Settings& settings,
                     const Context& context) {
  if (a.level != kAutoLevel) return "";
  std::vector<int> all(scene.frames.size());
  std::iota(all.begin(), all.end(), 0);
  const Outcome<LevelChoice> choice = chooseLevel(scene, all, source, settings, context.progress());
  if (!choice) throw CannotAnswer{choice.failure()};
  settings.set("detect.level", choice->level);
  return choice->reason;
}

void warnOfBackground(const std::vector<DetectedFrame>& frames, const Context& context) {
  double worst = 0;
  int open = 0;
  for (const DetectedFrame& frame : frames)
    for (const double pct : frame.uncertaintyPct) {
      worst = std::max(worst, pct);
      open += pct > kWorthSayingPct;
    }
  if (open == 0) return;
  context.warn(formatted(
      "the background is uncertain under %d highlight%s: the surroundings may be the tail of the highlight, so contours "
      "may be up to %.2g %% of the diameter too small; evaluate and reconstruct resolve this because they know the surface",
      open, open == 1 ? "" : "s", worst));
}

std::array<std::string, 2> partsOf(const Frame& frame) {
  return {pictureName(frame, "_specular"), pictureName(frame, "_diffuse")};
}

/// The two parts of a frame that was separated, as a screen shows them.
void writeParts(const std::filesystem::path& folder, const Frame& frame, FrameSource source,
                const SpecularSeparation& separation) {
  const Outcome<Image> linear = readLinear(frame, source);
  if (!linear || linear->channels != 3) return;
  Image specular = specularPart(*linear, separation), diffuse = *linear;
  for (std::size_t i = 0; i < diffuse.data.size(); ++i) {
    const float rest = diffuse.data[i] - specular.data[i];
    diffuse.data[i] = std::isfinite(rest) ? std::max(0.f, rest) : 0.f;
  }
  // Values above 1, which radiance may have, are scaled together, so that both parts and their sum compare.
  float top = 1;
  for (const float v : linear->data)
    if (std::isfinite(v)) top = std::max(top, v);
  for (Image* const part : {&specular, &diffuse})
    for (float& v : part->data) v = static_cast<float>(srgbFromLinear(v / top));
  const std::array<std::string, 2> names = partsOf(frame);
  writePng(folder / names[0], specular);
  writePng(folder / names[1], diffuse);
}

void writeFolder(const DetectArguments& a, const Scene& scene, const std::vector<DetectedFrame>& frames, FrameSource source,
                 const std::string& json, const Context& context) {
  atomicFiles(a.out, "highlights.json", [&](const std::filesystem::path& folder) {
    parallelFor(
        static_cast<int>(frames.size()),
        [&](int i) {
          const Frame& frame = scene.frames[static_cast<std::size_t>(i)];
          const Outcome<Image> photograph = readPhotograph(frame);
          if (photograph)
            writePng(folder / pictureName(frame),
                     drawDetection(*photograph, frame.camera, frames[static_cast<std::size_t>(i)].highlights));
          const std::optional<SpecularSeparation>& separation = frames[static_cast<std::size_t>(i)].separation;
          if (a.parts && separation && separation->separated) writeParts(folder, frame, source, *separation);
        },
        context.progress(), "overlays");
    context.write((folder / "highlights.json").string(), json);
  });
}

Settings settingsOf(const DetectArguments& a) {
  Settings settings;
  if (a.level != kAutoLevel) {
    try {
      settings.setFromText("detect.level", a.level);
    } catch (const InputError&) {
      throw InputError("", "--level", kLevelRange);
    }
  }
  applyEach(settings, a.set);
  return settings;
}

int run(const DetectArguments& a, const Context& context) {
  Settings settings = settingsOf(a);
  Scene scene = a.places.read(a.input);
  for (const std::string& warning : scene.warnings) context.warn(warning);
  Outputs outputs(a.input, scene);
  std::vector<int> all(scene.frames.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<std::string> names = picturesOf(scene, all);
  if (a.parts && (a.out.empty() || a.separate == "off")) throw InputError("", "--parts", "needs --out DIR and --separate auto");
  if (a.parts)
    for (const Frame& frame : scene.frames)
      for (std::string& name : partsOf(frame)) names.push_back(std::move(name));
  names.emplace_back("highlights.json");
  outputs.inFolder(a.out, "--out", names, "highlights.json", "glint_detection");
  outputs.file(a.json, "--json", OutputKind::document("glint_detection"));
  for (Frame& frame : scene.frames) frame.highlights.clear();
  const FrameSource source = a.source == "image" ? FrameSource::Image : FrameSource::Radiance;
  const std::string why = setLevel(a, scene, source, settings, context);
  const std::vector<DetectedFrame> frames = detectAll(scene, source, settings, a.separate == "auto", context.progress());
  const std::string json = detectionJson(a.input, settings.number("detect.level"), a.source, frames, why);
  if (!a.out.empty()) writeFolder(a, scene, frames, source, json, context);
  if (!a.json.empty()) context.write(a.json, json);
  warnOfBackground(frames, context);
  if (a.json != "-") context.print((why.empty() ? "" : why + "\n") + table(frames));
  for (const DetectedFrame& frame : frames)
    if (!frame.failure) return kDone;
  const Failure& first = *frames.front().failure;
  throw CannotAnswer{{first.reason, "no frame shows a highlight; first: frame " + frames.front().id + ": " + first.detail}};
}

}  // namespace

Command detectCommand() {
  const auto a = std::make_shared<DetectArguments>();
  Command c;
  c.name = "detect";
  c.summary = "Detect the highlights in every frame: contour, peak, ellipse";
  c.description =
      "Detects the highlights in every frame and ignores those that the scene file gives: a log-quadratic peak, the diffuse\n"
      "background around it removed, and the sub-pixel iso-contour at a level relative to the strongest peak of the frame.\n"
      "Streaks of clipped cores are cut off. Bright texture, which stays on the surface while highlights move, is rejected.\n"
      "Prints a table in ideal pixels, with what makes each highlight doubtful and what\n"
      "was rejected. --out also writes highlights.json and one overlay per frame.";
  c.examples =
      "  glint detect scene.json                          a table of all highlights\n"
      "  glint detect scene.json --source image --out DIR from the photographs, with overlays\n"
      "  glint detect scene.json --separate auto          contours on the specular part of colour images\n";
  c.declare = [a](Options& o) {
    o.positional(a->input, "INPUT",
                 "Scene file, capture of another program (COLMAP, nerfstudio ...), folder that contains one, or session");
    o.option(a->level, "--level", "L",
             "Contour level: fraction of the strongest peak above its background (more than 0, less than 1), or auto: chosen "
             "for the sequence, with the reason");
    o.choice(a->source, "--source", {"radiance", "image"}, "Pixels to use where a frame has both");
    o.choice(a->separate, "--separate", {"off", "auto"},
             "auto: contours and peaks on the specular part alone, where the colours of a frame allow to part it from the "
             "diffuse one");
    o.flag(a->parts, "--parts", "With --out and --separate auto: write the two parts of each separated frame, too");
    o.repeated(a->set, "--set", "KEY=VALUE", "Any setting by its dotted name, such as detect.min_area=20; may be repeated");
    o.option(a->out, "--out", "DIR", "Write highlights.json and PNG overlays to this folder");
    o.option(a->json, "--json", "FILE", "Write highlights.json to this file (- = standard output, replaces the table)");
    a->places.declare(o);
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
