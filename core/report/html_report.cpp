// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/base/html_text.h"
#include "core/base/number_text.h"
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

std::string base64(const std::vector<unsigned char>& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned n = bytes[i] << 16 | (i + 1 < bytes.size() ? bytes[i + 1] : 0) << 8 | (i + 2 < bytes.size() ? bytes[i + 2] : 0);
    out += digits[n >> 18 & 63];
    out += digits[n >> 12 & 63];
    out += i + 1 < bytes.size() ? digits[n >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? digits[n & 63] : '=';
  }
  return out;
}

/// One model over the held-out frames.
struct ErrorsOver {
  std::vector<std::pair<int, double>> errors;  ///< frame, mean error over its highlights, where each of them was matched
  std::vector<int> missed;                     ///< frames of which a highlight was missed: the others' mean would make them look good
};
ErrorsOver errorsOver(const Inspection& inspection, const ModelResult& result) {
  struct Sum {
    double pct = 0;
    int matched = 0, missed = 0;
  };
  std::map<int, Sum> frames;
  for (const FrameComparison& c : result.frames) {
    if (!inspection.isHeldOut(c.frame)) continue;
    for (const FrameComparison::Row& row : c.rows) {
      if (row.observed < 0) continue;
      Sum& sum = frames[c.frame];
      if (row.metrics && std::isfinite(row.metrics->contourErrorPct))
        sum.pct += row.metrics->contourErrorPct, ++sum.matched;
      else
        ++sum.missed;
    }
  }
  ErrorsOver out;
  for (const auto& [frame, sum] : frames)
    if (sum.missed > 0)
      out.missed.push_back(frame);
    else if (sum.matched > 0)
      out.errors.emplace_back(frame, sum.pct / sum.matched);
  return out;
}

std::string errorPlot(const Inspection& inspection) {
  const double width = 920, height = 320, left = 62, right = 12, top = 12, bottom = 38;
  double low = 1e300, high = 0;
  const int frames = static_cast<int>(inspection.scene->frames.size());
  std::vector<std::pair<std::string, ErrorsOver>> curves;
  for (const std::string& name : inspection.request.models) {
    if (!inspection.models.count(name)) continue;
    curves.emplace_back(name, errorsOver(inspection, inspection.models.at(name)));
    for (const auto& [frame, e] : curves.back().second.errors)
      if (e > 0) low = std::min(low, e), high = std::max(high, e);
  }
  if (!(high > 0)) return "<p>No held-out frame was matched, so there is no error to plot.</p>\n";
  // Errors of the models differ by orders of magnitude: a logarithmic axis over whole decades.
  const double from = std::floor(std::log10(std::max(low, 1e-9))), to = std::max(from + 1, std::ceil(std::log10(high)));
  const auto x = [&](double frame) { return left + (width - left - right) * (frames > 1 ? frame / (frames - 1) : 0.5); };
  const auto y = [&](double e) {
    const double t = (std::log10(std::max(e, std::pow(10, from))) - from) / (to - from);
    return height - bottom - (height - top - bottom) * t;
  };
  std::string svg = "<svg viewBox=\"0 0 920 320\" role=\"img\" aria-label=\"contour error over frames\">\n";
  for (double d = from; d <= to; ++d) {
    const double at = y(std::pow(10, d));
    svg += "<line class=\"grid\" x1=\"" + format("%.1f", left) + "\" x2=\"" + format("%.1f", width - right) + "\" y1=\"" +
           format("%.1f", at) + "\" y2=\"" + format("%.1f", at) + "\"/><text x=\"" + format("%.1f", left - 6) + "\" y=\"" +
           format("%.1f", at + 4) + "\" text-anchor=\"end\">" + format("%g", std::pow(10, d)) + " %</text>\n";
  }
  const int step = std::max(1, static_cast<int>(std::ceil(frames / 12.0)));
  for (int f = 0; f < frames; f += step)
    svg += "<text x=\"" + format("%.1f", x(f)) + "\" y=\"" + format("%.1f", height - bottom + 16) + "\" text-anchor=\"middle\">" +
           std::to_string(f) + "</text>\n";
  svg += "<text x=\"" + format("%.1f", (left + width - right) / 2) + "\" y=\"" + format("%.1f", height - 6) +
         "\" text-anchor=\"middle\">frame</text>\n";
  for (int f = 0; f < frames; ++f)
    if (inspection.isTraining(f) && !inspection.train.perSurface)
      svg += "<rect class=\"train\" x=\"" + format("%.1f", x(f) - 2) + "\" y=\"" + format("%.1f", height - bottom - 6) +
             "\" width=\"4\" height=\"6\"><title>training frame " + std::to_string(f) + "</title></rect>\n";
  int row = 0;  // of crosses, one for each model that missed something and matched something
  for (const auto& [name, curve] : curves) {
    std::string path;
    int last = -2;
    for (const auto& [frame, e] : curve.errors) {
      path += (frame == last + 1 ? " L" : " M") + format("%.1f", x(frame)) + "," + format("%.1f", y(e));
      last = frame;
    }
    svg += "<path fill=\"none\" stroke-width=\"1.6\" stroke=\"" + modelHex(name) + "\" d=\"" + path + "\"/>\n";
    for (const auto& [frame, e] : curve.errors)
      svg += "<circle r=\"2.6\" fill=\"" + modelHex(name) + "\" cx=\"" + format("%.1f", x(frame)) + "\" cy=\"" + format("%.1f", y(e)) +
             "\"><title>" + name + ", frame " + std::to_string(frame) + ": " + format("%.4g", e) + " %</title></circle>\n";
    if (curve.errors.empty() || curve.missed.empty()) continue;
    for (const int frame : curve.missed) {
      const double cx = x(frame), cy = top + 4 + 8 * row, r = 3;
      svg += "<path class=\"missed\" fill=\"none\" stroke-width=\"1.6\" stroke=\"" + modelHex(name) + "\" d=\"M" + format("%.1f", cx - r) +
             "," + format("%.1f", cy - r) + " L" + format("%.1f", cx + r) + "," + format("%.1f", cy + r) + " M" + format("%.1f", cx - r) + "," +
             format("%.1f", cy + r) + " L" + format("%.1f", cx + r) + "," + format("%.1f", cy - r) + "\"><title>" + name + ", frame " +
             std::to_string(frame) + ": missed a highlight</title></path>\n";
    }
    ++row;
  }
  return svg + "</svg>\n" + (row > 0 ? "<p>Crosses at the top: the model missed a highlight of the frame, so it has no error there.</p>\n" : "");
}

std::string pathOf(const Polyline& line) {
  std::string path;
  // A vertex every tenth of a pixel is more than a screen shows.
  Pixel last(-1e9, -1e9);
  for (const Pixel& p : line.points) {
    if ((p - last).norm() < 0.1) continue;
    path += (path.empty() ? "M" : " L") + format("%.2f", p.x()) + "," + format("%.2f", p.y());
    last = p;
  }
  return path + (line.closed ? " Z" : "");
}

std::string overlay(const Inspection& inspection, int frame) {
  // Crop around everything drawn, in pixel coordinates.
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  const auto include = [&](const Polyline& line) {
    for (const Pixel& p : line.points) x0 = std::min(x0, p.x()), x1 = std::max(x1, p.x()), y0 = std::min(y0, p.y()), y1 = std::max(y1, p.y());
  };
  for (const Highlight& h : inspection.evidence[frame].scored()) include(h.contour);
  std::string shapes, caption;
  for (const Highlight& h : inspection.evidence[frame].scored()) {
    const std::string d = pathOf(h.contour);
    shapes += "<path class=\"halo\" d=\"" + d + "\"/><path class=\"observed\" d=\"" + d + "\"/>\n";
  }
  for (const std::string& name : inspection.request.models) {
    if (!inspection.models.count(name)) continue;
    for (const FrameComparison& c : inspection.models.at(name).frames) {
      if (c.frame != frame) continue;
      for (const PredictedHighlight& h : c.prediction.highlights) {
        shapes += "<path class=\"predicted\" stroke=\"" + modelHex(name) + "\" d=\"" + pathOf(h.contour) + "\"/>\n";
      }
      for (const FrameComparison::Row& row : c.rows) {
        std::string text = row.metrics ? format("%.3g", row.metrics->contourErrorPct) + " %" : "";
        if (!row.metrics && row.failure) text = escaped(row.failure->message());
        else if (!row.metrics) text = "spurious";
        caption += "<span style=\"color:" + modelHex(name) + "\">&#9632;</span> " + name + " " + text + "<br>";
      }
    }
  }
  const Camera& camera = inspection.scene->frames[frame].camera;
  if (x1 < x0) x0 = y0 = 0, x1 = camera.width - 1, y1 = camera.height - 1;
  const double pad = std::max(12.0, 0.5 * std::max(x1 - x0, y1 - y0));
  const int cx0 = std::clamp(static_cast<int>(x0 - pad), 0, camera.width - 1), cy0 = std::clamp(static_cast<int>(y0 - pad), 0, camera.height - 1);
  const int cx1 = std::clamp(static_cast<int>(x1 + pad), cx0 + 1, camera.width), cy1 = std::clamp(static_cast<int>(y1 + pad), cy0 + 1, camera.height);
  std::string picture;
  if (const Outcome<Image> photo = photographOf(inspection, int(frame))) {
    cv::Mat crop(cy1 - cy0, cx1 - cx0, CV_8UC3);
    for (int y = cy0; y < cy1; ++y)
      for (int x = cx0; x < cx1; ++x)
        for (int k = 0; k < 3; ++k)
          crop.at<cv::Vec3b>(y - cy0, x - cx0)[2 - k] =
              cv::saturate_cast<unsigned char>(255 * photo->at(x, y, std::min(k, photo->channels - 1)));
    std::vector<unsigned char> png;
    cv::imencode(".png", crop, png);
    // Integer coordinates are pixel centres, so the image starts half a pixel earlier.
    picture = "<image x=\"" + format("%.1f", cx0 - 0.5) + "\" y=\"" + format("%.1f", cy0 - 0.5) + "\" width=\"" + std::to_string(cx1 - cx0) +
              "\" height=\"" + std::to_string(cy1 - cy0) + "\" href=\"data:image/png;base64," + base64(png) + "\"/>\n";
  }
  const std::string box = formatted("%.1f %.1f %d %d", cx0 - 0.5, cy0 - 0.5, cx1 - cx0, cy1 - cy0);
  return "<figure><svg class=\"frame\" viewBox=\"" + box + "\">\n" + picture + shapes + "</svg><figcaption><b>frame " +
         std::to_string(frame) + "</b> (" + escaped(inspection.scene->frames[frame].id) + ")<br>" + caption + "</figcaption></figure>\n";
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
    sorted.push_back(errorsOver(inspection, inspection.models.at(name)).errors);
    std::stable_sort(sorted.back().begin(), sorted.back().end(), [](const auto& a, const auto& b) { return a.second > b.second; });
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
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Glint evaluation: " + escaped(inspection.scene->name) +
      "</title>\n<style>body{font:14px/1.45 sans-serif;margin:2em auto;max-width:980px;padding:0 1em;color:#222}"
      "table{border-collapse:collapse;margin:1em 0;width:100%}th,td{padding:.25em .6em;border-bottom:1px solid #ddd;text-align:right}"
      "th:first-child,td:first-child,td.reason{text-align:left}td:first-child{white-space:nowrap}svg{width:100%;height:auto;background:#fff}svg text{font:11px sans-serif;fill:#555}"
      ".grid{stroke:#e4e4e4}.train{fill:#0072b2}.frame{image-rendering:pixelated;background:#000;max-height:420px}"
      ".halo{fill:none;stroke:#000;stroke-opacity:.65;stroke-width:3.2;vector-effect:non-scaling-stroke}"
      ".observed{fill:none;stroke:#fff;stroke-width:1.6;vector-effect:non-scaling-stroke}"
      ".predicted{fill:none;stroke-width:1.6;vector-effect:non-scaling-stroke}"
      ".frames{display:grid;grid-template-columns:repeat(auto-fill,minmax(290px,1fr));gap:1em}figure{margin:0}"
      "figcaption{font-size:12px;color:#444}.swatch{display:inline-block;width:.8em;height:.8em;margin-right:.4em}</style></head><body>\n";
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
              std::to_string(c.answered) + " / " + std::to_string(c.tried) + "</td><td>" + format("%.3g", c.meanPct) + "</td><td>" +
              format("%.2g", c.standardErrorPct) + "</td><td>" + format("%.3g", c.predictUs) + "</td><td class=\"reason\">" + escaped(c.remark) + "</td></tr>\n";
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
    html += "<td>" + format("%.4f", s.iou.mean) + "</td><td>" + format("%.3f", s.coverage.mean) + "</td><td>" + std::to_string(s.matched) +
            " / " + std::to_string(s.missed) + " / " + std::to_string(s.spurious) + "</td><td>" + format("%.0f", s.timeUs.median) + "</td></tr>\n";
  }
  html += "</table>\n";
  for (const std::string& name : inspection.request.models)
    if (inspection.models.count(name))
      for (const std::string& text : bandLines(inspection, inspection.models.at(name))) html += "<p>" + name + ": " + escaped(text) + "</p>\n";
  html += "<h2>Error over frames</h2>\n" + errorPlot(inspection);
  html += "<p>Blue ticks mark training frames; hover over a point for its value.</p>\n";
  html += missedTable(inspection, missedBy(inspection));
  html += "<h2>Worst frames</h2>\n<p>White: observed contour. Coloured: predictions.</p>\n<div class=\"frames\">\n";
  for (const int frame : worstFrames(inspection, 9)) html += overlay(inspection, frame);
  html += "</div>\n" + settingsTable(inspection.request.settings);
  if (!context.program.empty()) html += "<p>Made by " + escaped(context.program) + ".</p>\n";
  html += "</body></html>\n";
  return html;
}

}  // namespace glint
