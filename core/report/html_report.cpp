// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/base/html_text.h"
#include "core/base/number_text.h"
#include "core/draw/overlay_painter.h"
#include "core/draw/plot_painter.h"
#include "core/draw/plots.h"
#include "core/draw/svg_painter.h"
#include "core/inspect/frame_score.h"
#include "core/inspect/photograph.h"
#include "core/inspect/summary.h"
#include "core/model/palette.h"
#include "core/report/band_text.h"
#include "core/report/report.h"
#include "core/report/setting_text.h"
#include "core/report/warnings.h"
#include "core/what_if/knobs.h"

namespace glint {
namespace {

using html::escaped;
using html::format;

constexpr double kPlotWidth = 920, kPlotHeight = 320, kFrameWidth = 290;  // px of the page

/// Error over frames as the inspector plots it.
std::string errorPlotOf(const Inspection& inspection) {
  const draw::PlotData plot = draw::errorPlot(inspection, {{}, true});
  if (!plot.empty.empty()) return "<p>" + escaped(plot.empty) + ".</p>\n";
  draw::SvgPainter painter(kPlotWidth, kPlotHeight);
  draw::paintPlot(painter, plot, {false, 1}, draw::rangeOf(plot), {}, kPlotWidth, kPlotHeight);
  return painter.element("contour error over frames");
}

/// Observed and predicted contours of a frame over its photograph, around what is drawn, with every model's error.
std::string frameFigure(const Inspection& inspection, int frame) {
  draw::OverlayOptions options;
  options.hidden = {draw::OverlayRole::PredictedPeak};
  for (const draw::OverlayLayer& layer : draw::overlayLayers())
    if (layer.role != draw::OverlayRole::ObservedContour && layer.role != draw::OverlayRole::PredictedContour)
      options.hidden.insert(layer.role);
  const draw::FrameOverlay overlay = draw::frameOverlay(inspection, frame, options);
  Eigen::AlignedBox2d observed;
  for (const draw::OverlayLine& line : overlay.lines)
    if (line.role == draw::OverlayRole::ObservedContour)
      for (const Pixel& p : line.points)
        if (p.allFinite()) observed.extend(p);
  const Camera& camera = inspection.scene->frames[std::size_t(frame)].camera;
  if (observed.isEmpty()) observed = Eigen::AlignedBox2d(Pixel(0, 0), Pixel(camera.width - 1, camera.height - 1));
  const double pad = std::max(12.0, 0.5 * observed.sizes().maxCoeff());
  const int x0 = std::clamp(int(observed.min().x() - pad), 0, camera.width - 1),
            y0 = std::clamp(int(observed.min().y() - pad), 0, camera.height - 1);
  const int x1 = std::clamp(int(observed.max().x() + pad), x0 + 1, camera.width),
            y1 = std::clamp(int(observed.max().y() + pad), y0 + 1, camera.height);
  // Integer coordinates are pixel centres, so the image starts half a pixel earlier.
  const draw::Crop crop{x0 - 0.5, y0 - 0.5, double(x1 - x0), double(y1 - y0)};
  const draw::Box box{0, 0, kFrameWidth, kFrameWidth * crop.height / crop.width};
  draw::SvgPainter painter(box.width, box.height, draw::Colour{0, 0, 0});
  if (const Outcome<Image> photo = photographOf(inspection, frame)) {
    cv::Mat part(y1 - y0, x1 - x0, CV_8UC3);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        for (int k = 0; k < 3; ++k)
          part.at<cv::Vec3b>(y - y0, x - x0)[2 - k] =
              cv::saturate_cast<unsigned char>(255 * photo->at(x, y, std::min(k, photo->channels - 1)));
    std::vector<unsigned char> png;
    cv::imencode(".png", part, png);
    painter.picture(png, "image/png", box);
  }
  draw::paintOverlay(painter, overlay, crop, box);
  std::string caption;
  for (const draw::OverlayCaption& c : overlay.captions)
    caption +=
        (c.model.empty() ? "" : "<span style=\"color:" + modelHex(c.model) + "\">&#9632;</span> ") + escaped(c.text) + "<br>";
  const std::string name = std::to_string(frame);
  return "<figure>" + painter.element("contours of frame " + name) + "<figcaption><b>frame " + name + "</b> (" +
         escaped(inspection.scene->frames[std::size_t(frame)].id) + ")<br>" + caption + "</figcaption></figure>\n";
}

/// Held-out highlights that a model did not predict, with the reason.
struct Missed {
  int frame;
  std::string light, model, reason;
};
std::vector<Missed> missedBy(const Inspection& inspection) {
  std::vector<Missed> all;
  for (const std::string& name : inspection.request.models) {
    if (!inspection.models.count(name)) continue;
    for (const FrameComparison& c : inspection.models.at(name).frames) {
      if (!inspection.isHeldOut(c.frame)) continue;
      for (const FrameComparison::Row& row : c.rows)
        if (row.observed >= 0 && !row.metrics)
          all.push_back({c.frame, c.light, name, row.failure ? row.failure->message() : "no prediction overlaps it"});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Missed& a, const Missed& b) { return a.frame < b.frame; });
  return all;
}

std::string missedTable(const Inspection& inspection, const std::vector<Missed>& missed) {
  constexpr std::size_t kMost = 60;  // rows that anybody reads
  if (missed.empty()) return "";
  std::string html =
      "<h2>Missed highlights</h2>\n<table><tr><th>frame</th><th>light</th><th>model</th>"
      "<th>reason</th></tr>\n";
  for (std::size_t i = 0; i < std::min(kMost, missed.size()); ++i) {
    const Missed& m = missed[i];
    html += "<tr><td>" + std::to_string(m.frame) + " (" + escaped(inspection.scene->frames[std::size_t(m.frame)].id) +
            ")</td><td>" + escaped(m.light) + "</td><td><span class=\"swatch\" style=\"background:" + modelHex(m.model) +
            "\"></span>" + m.model + "</td><td class=\"reason\">" + escaped(m.reason) + "</td></tr>\n";
  }
  html += "</table>\n";
  if (missed.size() > kMost) html += "<p>And " + std::to_string(missed.size() - kMost) + " more.</p>\n";
  return html;
}

/// Every setting, so that the report says by itself what was computed.
std::string settingsTable(const Settings& settings) {
  std::string html = "<h2>Settings</h2>\n<table><tr><th>setting</th><th>value</th><th>default</th></tr>\n";
  for (const ParamSpec& p : allParams()) {
    const auto found = settings.values().find(p.key);
    const SettingValue& value = found == settings.values().end() ? p.defaultValue : found->second;
    const bool own = value != p.defaultValue;
    html += "<tr><td><code>" + escaped(p.key) + "</code></td><td>" + (own ? "<b>" : "") + escaped(settingText(value)) +
            (own ? "</b>" : "") + " " + escaped(p.unit) + "</td><td>" + escaped(settingText(p.defaultValue)) + " " +
            escaped(p.unit) + "</td></tr>\n";
  }
  return html + "</table>\n";
}

/// Up to `count` frames, the worst of each model in turn; first those where highlights were missed, up to a third.
std::vector<int> worstFrames(const Inspection& inspection, std::size_t count) {
  std::vector<std::vector<std::pair<int, double>>> sorted;
  for (const std::string& name : inspection.request.models) {
    if (!inspection.models.count(name)) continue;
    const std::vector<FrameScore> scores = frameScores(inspection.models.at(name), int(inspection.scene->frames.size()));
    sorted.emplace_back();
    for (int frame = 0; frame < int(scores.size()); ++frame)
      if (const std::optional<double> pct = wholeErrorPct(scores[std::size_t(frame)]); pct && inspection.isHeldOut(frame))
        sorted.back().emplace_back(frame, *pct);
    std::stable_sort(sorted.back().begin(), sorted.back().end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
  }
  std::vector<int> frames;
  std::set<int> seen;
  for (const Missed& m : missedBy(inspection))
    if (frames.size() < count / 3 && seen.insert(m.frame).second) frames.push_back(m.frame);
  for (std::size_t rank = 0; frames.size() < count; ++rank) {
    bool any = false;
    for (const auto& list : sorted) {
      if (rank >= list.size()) continue;
      any = true;
      if (frames.size() < count && seen.insert(list[rank].first).second) frames.push_back(list[rank].first);
    }
    if (!any) break;
  }
  return frames;
}

}  // namespace

std::string evaluationHtml(const Inspection& inspection, const ReportContext& context) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Glint evaluation: " +
      escaped(inspection.scene->name) +
      "</title>\n<style>body{font:14px/1.45 sans-serif;margin:2em auto;max-width:980px;padding:0 1em;color:#222}"
      "table{border-collapse:collapse;margin:1em 0;width:100%}th,td{padding:.25em .6em;border-bottom:1px solid "
      "#ddd;text-align:right}"
      "th:first-child,td:first-child,td.reason{text-align:left}td:first-child{white-space:nowrap}svg{width:100%;height:auto}"
      ".frames{display:grid;grid-template-columns:repeat(auto-fill,minmax(290px,1fr));gap:1em}figure{margin:0}"
      "figcaption{font-size:12px;color:#444}.swatch{display:inline-block;width:.8em;height:.8em;margin-right:.4em}</style></"
      "head><body>\n";
  html += "<h1>" + escaped(inspection.scene->name) + "</h1>\n<p>Input <code>" + escaped(context.input) +
          "</code>, training <code>" + escaped(inspection.train.text) + "</code> (" +
          std::to_string(inspection.train.frames.size()) + " of " + std::to_string(inspection.scene->frames.size()) +
          " frames), level " + format("%g", inspection.request.settings.number("detect.level")) +
          (inspection.request.whatIf.synthesise              ? ""
           : inspection.request.source == FrameSource::Image ? ", from captured images"
                                                             : ", from float radiance where available") +
          ".</p>\n";
  if (const std::string changed = summaryOf(inspection.request.whatIf); !changed.empty())
    html += "<p><b>What-if: " + escaped(changed) + ".</b> The scene differs from the captured one.</p>\n";
  if (const std::vector<std::string> warnings = warningsOf(inspection); !warnings.empty()) {
    html += "<h2>Warnings</h2>\n<ul>\n";
    for (const std::string& w : warnings) html += "<li>" + escaped(w) + "</li>\n";
    html += "</ul>\n";
  }
  if (!context.chosenModel.empty())
    html += "<p><b>Chosen model: " + escaped(context.chosenModel) + "</b>. " + escaped(context.whyChosen) + "</p>\n";
  if (context.selection) {
    html +=
        "<table><tr><th>candidate</th><th>left-out views answered</th><th>leave-one-out error %</th><th>standard error %</th>"
        "<th>&micro;s/frame</th><th>remark</th></tr>\n";
    for (const Candidate& c : context.selection->candidates)
      html += "<tr><td><span class=\"swatch\" style=\"background:" + modelHex(c.model) + "\"></span>" + c.model + "</td><td>" +
              std::to_string(c.answered) + " / " + std::to_string(c.tried) + "</td><td>" + format("%.3g", c.meanPct) +
              "</td><td>" + format("%.2g", c.standardErrorPct) + "</td><td>" + format("%.3g", c.predictUs) +
              "</td><td class=\"reason\">" + escaped(c.remark) + "</td></tr>\n";
    html += "</table>\n";
  }
  html +=
      "<p>Errors are taken over held-out highlights: symmetric mean distance between predicted and observed contour, as a "
      "percentage of the equivalent diameter of the observed region. Scored against " +
      scoredAgainst(inspection) +
      ".</p>\n"
      "<table><tr><th>model</th><th>predicted</th><th>mean %</th><th>median %</th><th>p95 %</th><th>max %</th><th>mean px</th>"
      "<th>ellipse %</th><th>IoU</th><th>coverage</th><th>matched / missed / spurious</th><th>median &micro;s</th></tr>\n";
  for (const std::string& name : inspection.request.models) {
    if (!inspection.models.count(name)) continue;
    const ModelSummary s = summarise(inspection, inspection.models.at(name));
    html += "<tr><td><span class=\"swatch\" style=\"background:" + modelHex(name) + "\"></span>" + name + "</td><td>" +
            std::to_string(s.predicted) + "/" + std::to_string(s.frames) + "</td>";
    if (!s.answered) {
      html += "<td class=\"reason\" colspan=\"10\">" + escaped(s.reason) + "</td></tr>\n";
      continue;
    }
    for (const double v : {s.contourErrorPct.mean, s.contourErrorPct.median, s.contourErrorPct.p95, s.contourErrorPct.max,
                           s.contourErrorPx.mean, s.ellipseErrorPct.mean})
      html += "<td>" + format("%.3g", v) + "</td>";
    html += "<td>" + format("%.4f", s.iou.mean) + "</td><td>" + format("%.3f", s.coverage.mean) + "</td><td>" +
            std::to_string(s.matched) + " / " + std::to_string(s.missed) + " / " + std::to_string(s.spurious) + "</td><td>" +
            format("%.0f", s.timeUs.median) + "</td></tr>\n";
  }
  html += "</table>\n";
  for (const std::string& name : inspection.request.models)
    if (inspection.models.count(name))
      for (const std::string& text : bandLines(inspection, inspection.models.at(name)))
        html += "<p>" + name + ": " + escaped(text) + "</p>\n";
  html += "<h2>Error over frames</h2>\n" + errorPlotOf(inspection);
  html += "<p>Blue: training frames. Hover over a point for its value.</p>\n";
  html += missedTable(inspection, missedBy(inspection));
  html += "<h2>Worst frames</h2>\n<p>White: observed contour. Coloured: predictions.</p>\n<div class=\"frames\">\n";
  for (const int frame : worstFrames(inspection, 9)) html += frameFigure(inspection, frame);
  html += "</div>\n" + settingsTable(inspection.request.settings);
  if (!context.program.empty()) html += "<p>Made by " + escaped(context.program) + ".</p>\n";
  html += "</body></html>\n";
  return html;
}

}  // namespace glint
