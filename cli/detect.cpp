// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <numeric>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/base/atomic_folder.h"
#include "core/base/number_text.h"
#include "core/base/parallel.h"
#include "core/fit/evidence.h"
#include "core/highlight/background.h"
#include "core/highlight/report.h"
#include "core/scene/outputs.h"

namespace glint::cli {
namespace {

/// A contour that may be off by more than this, in percent of the diameter, is pointed out: predictions from exact contours are better.
constexpr double kWorthSayingPct = 0.25;

/// What the unknown tail of the lobe leaves open, per highlight. The surroundings are looked at in measured pixels.
std::vector<double> uncertainties(const Frame& frame, FrameSource source, const Settings& settings,
                                  const std::vector<Highlight>& highlights) {
  std::vector<double> result(highlights.size(), 0);
  const Outcome<LinearPixels> pixels = pixelsOf(frame, source, settings);
  if (!pixels) return result;
  for (std::size_t i = 0; i < highlights.size(); ++i) {
    const Highlight& h = highlights[i];
    if (!h.ellipse || h.clipped) continue;
    Footprint footprint;
    footprint.centre = frame.camera.distorted(h.ellipse->centre);
    footprint.level = h.level;
    const Eigen::Matrix2d axes = Eigen::Rotation2Dd(h.ellipse->angle).toRotationMatrix();
    footprint.shape = axes * h.ellipse->semiAxes.cwiseAbs2().asDiagonal() * axes.transpose();
    result[i] = backgroundUncertaintyPct(pixels->value, pixels->usable, footprint, h.peakValue);
  }
  return result;
}

std::string table(const std::vector<DetectedFrame>& frames) {
  std::string text = "frame         light         peak x    peak y      area px2   axes px          flags\n";
  for (const DetectedFrame& frame : frames) {
    if (frame.failure) {
      text += formatted("%-12.40s  -  %.180s\n", frame.id.c_str(), frame.failure->message().c_str());
    }
    for (std::size_t i = 0; i < frame.highlights.size(); ++i) {
      const Highlight& h = frame.highlights[i];
      std::string axes = "-";
      if (h.ellipse) axes = formatted("%.2f x %.2f", h.ellipse->semiAxes.x(), h.ellipse->semiAxes.y());
      text += formatted("%-12.40s  %-10.40s  %8.3f  %8.3f  %12.1f   %-15s  %s%s\n", frame.id.c_str(), h.light.c_str(), h.peak.x(),
                        h.peak.y(), h.areaPx2, axes.c_str(), h.clipped ? "clipped " : "", h.touchesBorder ? "border" : "");
    }
  }
  return text;
}

}  // namespace

Command detectCommand() {
  struct Arguments {
    std::string input, source = "radiance", out, json;
    double level = 0.5;
    std::vector<std::string> set;
    SceneArguments places;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "detect";
  c.summary = "Detect the highlights in every frame: contour, peak, ellipse";
  c.description =
      "Detects the highlights in every frame and ignores those that the scene file gives: a log-quadratic peak, the diffuse\n"
      "background around it removed, and the sub-pixel iso-contour at a level relative to the strongest peak of the frame.\n"
      "Prints a table in ideal pixels. --out also writes highlights.json and one overlay per frame.";
  c.examples =
      "  glint detect scene.json                          a table of all highlights\n"
      "  glint detect scene.json --source image --out DIR from the photographs, with overlays\n";
  c.declare = [a](Options& o) {
    o.positional(a->input, "INPUT",
                 "Scene file, capture of another program (COLMAP, nerfstudio ...), folder that contains one, or session");
    o.option(a->level, "--level", "L",
             "Contour level: fraction of the strongest peak above its background (more than 0, less than 1)");
    o.choice(a->source, "--source", {"radiance", "image"}, "Pixels to use where a frame has both");
    o.repeated(a->set, "--set", "KEY=VALUE", "Any setting by its dotted name, such as detect.min_area=20; may be repeated");
    o.option(a->out, "--out", "DIR", "Write highlights.json and PNG overlays to this folder");
    o.option(a->json, "--json", "FILE", "Write highlights.json to this file (- = standard output, replaces the table)");
    a->places.declare(o);
  };
  c.run = [a](const Context& context) -> int {
    Settings settings;
    try {
      settings.set("detect.level", a->level);
    } catch (const InputError&) {
      throw InputError("", "--level", kLevelRange);
    }
    applyEach(settings, a->set);
    Scene scene = a->places.read(a->input);
    for (const std::string& warning : scene.warnings) context.warn(warning);
    Outputs outputs(a->input, scene);
    std::vector<int> all(scene.frames.size());
    std::iota(all.begin(), all.end(), 0);
    std::vector<std::string> names = picturesOf(all);
    names.emplace_back("highlights.json");
    outputs.inFolder(a->out, "--out", names, "highlights.json", "glint_detection");
    outputs.file(a->json, "--json", OutputKind::document("glint_detection"));
    for (Frame& frame : scene.frames) frame.highlights.clear();
    const FrameSource source = a->source == "image" ? FrameSource::Image : FrameSource::Radiance;
    std::vector<DetectedFrame> frames(scene.frames.size());
    parallelFor(
        static_cast<int>(frames.size()),
        [&](int i) {
          FrameEvidence evidence = gatherEvidence(scene, i, source, settings);
          const Frame& frame = scene.frames[static_cast<std::size_t>(i)];
          std::vector<double> uncertain = uncertainties(frame, source, settings, evidence.highlights);
          frames[static_cast<std::size_t>(i)] = {frame.id, std::move(evidence.highlights), std::move(uncertain),
                                                 std::move(evidence.failure)};
        },
        context.progress(), "detect");

    const std::string json = detectionJson(a->input, settings.number("detect.level"), a->source, frames);
    if (!a->out.empty())
      atomicFiles(a->out, "highlights.json", [&](const std::filesystem::path& folder) {
        parallelFor(
            static_cast<int>(frames.size()),
            [&](int i) {
              const Frame& frame = scene.frames[static_cast<std::size_t>(i)];
              const Outcome<Image> photograph = readPhotograph(frame);
              // Numbered by position: an id may hold characters that no file name may.
              const std::string name = formatted("%04d.png", i);
              if (photograph)
                writePng(folder / name, drawDetection(*photograph, frame.camera, frames[static_cast<std::size_t>(i)].highlights));
            },
            context.progress(), "overlays");
        context.write((folder / "highlights.json").string(), json);
      });
    if (!a->json.empty()) context.write(a->json, json);
    double worst = 0;
    int open = 0;
    for (const DetectedFrame& frame : frames)
      for (const double pct : frame.uncertaintyPct) {
        worst = std::max(worst, pct);
        open += pct > kWorthSayingPct;
      }
    if (open > 0) {
      const std::string text = formatted(
          "the background is uncertain under %d highlight%s: the surroundings may be the tail of the highlight, so contours "
          "may be up to %.2g %% of the diameter too small; evaluate and reconstruct resolve this because they know the surface",
          open, open == 1 ? "" : "s", worst);
      context.warn(text);
    }
    if (a->json != "-") context.print(table(frames));
    for (const DetectedFrame& frame : frames)
      if (!frame.failure) return kDone;
    const Failure& first = *frames.front().failure;
    throw CannotAnswer{{first.reason, "no frame shows a highlight; first: frame " + frames.front().id + ": " + first.detail}};
  };
  return c;
}

}  // namespace glint::cli
