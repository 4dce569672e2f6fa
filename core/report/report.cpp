// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/report.h"

#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/model/star.h"
#include "core/pipeline/summary.h"
#include "core/report/evaluation_words.h"
#include "core/report/texts.h"

namespace glint {
namespace {

/// With as many decimals in every row, so that a column can be read from top to bottom.
std::string cell(double v, const char* format = "%.3f") {
  if (!std::isfinite(v)) return "-";
  return formatted(format, v);
}

/// Where the lamps stand still, if not in the world.
std::string carriedLine(const Inspection& inspection) {
  return inspection.lightFrame.anyMoves() ? inspection.lightFrame.reason + "\n" : std::string();
}

/// What the rows of a table are over, and what the models were made from.
std::string captionOf(const Inspection& inspection) {
  const std::string all = std::to_string(inspection.scene->frames.size());
  if (inspection.train.perSurface)
    return "contour errors of all frames; each surface has a model of all its frames (per-surface, " + all + " frames)\n";
  int heldOut = 0;
  for (int frame = 0; frame < static_cast<int>(inspection.scene->frames.size()); ++frame) heldOut += inspection.isHeldOut(frame);
  return "contour errors of held-out frames (" + std::to_string(heldOut) + "); trained on " +
         std::to_string(inspection.train.frames.size()) + " of " + all + " frames (" +
         trainText(inspection.train, *inspection.scene) + "); % of a highlight's diameter\n" + carriedLine(inspection);
}

}  // namespace

BestModel bestModel(const Inspection& inspection) {
  std::vector<std::pair<std::string, ModelSummary>> models;
  for (const std::string& name : inspection.request.models)
    if (const auto it = inspection.models.find(name); it != inspection.models.end())
      models.emplace_back(name, summarise(inspection, it->second));
  return evaluation::bestOf(models);
}

std::string evaluationTable(const Inspection& inspection) {
  std::string out = captionOf(inspection);
  out += formatted("%-12s %11s %9s %9s %9s %9s %9s %8s %8s %13s %10s\n", "model", "predicted", "mean %", "median %", "p95 %",
                   "max %", "mean px", "IoU", "coverage", "match/mis/spu", "median us");
  for (const std::string& name : inspection.request.models) {
    const auto it = inspection.models.find(name);
    if (it == inspection.models.end()) continue;
    const ModelSummary s = summarise(inspection, it->second);
    const std::string predicted = std::to_string(s.predicted) + "/" + std::to_string(s.frames);
    const std::string counts = std::to_string(s.matched) + "/" + std::to_string(s.missed) + "/" + std::to_string(s.spurious);
    out += formatted("%-12s %11s %9s %9s %9s %9s %9s %8s %8s %13s %10s", name.c_str(), predicted.c_str(),
                     cell(s.contourErrorPct.mean).c_str(), cell(s.contourErrorPct.median).c_str(),
                     cell(s.contourErrorPct.p95).c_str(), cell(s.contourErrorPct.max).c_str(),
                     cell(s.contourErrorPx.mean).c_str(), cell(s.iou.mean, "%.4f").c_str(), cell(s.coverage.mean, "%.3f").c_str(),
                     counts.c_str(), cell(s.timeUs.median, "%.0f").c_str());
    if (!s.answered || s.poor) out += "  " + (s.poor ? poorWarning(s.reason) : s.reason);
    out += "\n";
    for (const std::string& text : bandLines(inspection, it->second)) {
      out += formatted("%-12s ", "") + text + "\n";
    }
    double variation = 0;
    for (const FrameComparison& c : it->second.frames)
      for (const PredictedHighlight& h : c.prediction.highlights())
        variation = std::max(variation, h.curvatureVariation.value_or(0));
    if (variation > kLargestVariation) {
      out +=
          formatted("%-12s the local quadric is not good enough: curvature varies by up to %.3f over a highlight (limit %.2f)\n",
                    "", variation, kLargestVariation);
    }
  }
  if (const std::optional<DetectionError> d = detectionError(inspection)) {
    out += formatted("own detection against truth: %s %% mean, %s %% max; %d true highlights missed in %d frames\n",
                     cell(d->contourErrorPct.mean).c_str(), cell(d->contourErrorPct.max).c_str(), d->missed, d->frames);
  } else if (scoredAgainst(inspection) == "own detection") {
    out += "errors are relative to Glint's own detection; --truth DIR scores against known contours\n";
  }
  return out;
}

}  // namespace glint
