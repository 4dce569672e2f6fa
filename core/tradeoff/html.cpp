// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "core/base/html_text.h"
#include "core/model/palette.h"
#include "core/tradeoff/pareto.h"
#include "core/tradeoff/tradeoff.h"

namespace glint {
namespace {

using html::escaped;
using html::format;

/// A logarithmic axis over values > 0, with a margin.
struct LogAxis {
  double from = 0, to = 1;    ///< decimal logarithms
  double start = 0, end = 1;  ///< pixels
  double at(double v) const { return start + (end - start) * (std::log10(v) - from) / (to - from); }
};

LogAxis axisOver(std::vector<double> values, double start, double end) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  LogAxis a{std::log10(*low), std::log10(*high), start, end};
  const double margin = std::max(0.15, 0.06 * (a.to - a.from));
  a.from -= margin;
  a.to += margin;
  return a;
}

/// Ticks 1, 2, 5 of every decade where they are few, else whole decades.
std::vector<double> ticksOf(const LogAxis& a) {
  std::vector<double> ticks;
  const bool fine = a.to - a.from < 2.5;
  for (double d = std::floor(a.from); d <= a.to; ++d)
    for (const double m : {1.0, 2.0, 5.0}) {
      if (m > 1 && !fine) continue;
      const double v = m * std::pow(10, d);
      if (std::log10(v) >= a.from && std::log10(v) <= a.to) ticks.push_back(v);
    }
  return ticks;
}

std::string svgOf(const Tradeoff& t) {
  const double width = 920, height = 460, left = 74, right = 20, top = 18, bottom = 46;
  std::vector<double> times, errors;
  for (const TradeoffPoint& p : t.points) {
    if (!std::isfinite(p.rankedErrorPct) || !std::isfinite(p.predictUs)) continue;
    times.push_back(std::max(p.predictUs, kSmallestUs));
    errors.push_back(std::max(p.rankedErrorPct, kSmallestErrorPct));
  }
  if (times.empty()) return "<p>No setting answered, so there is nothing to plot.</p>\n";
  const LogAxis xAxis = axisOver(times, left, width - right), yAxis = axisOver(errors, height - bottom, top);
  const auto x = [&](const TradeoffPoint& p) { return xAxis.at(std::max(p.predictUs, kSmallestUs)); };
  const auto y = [&](const TradeoffPoint& p) { return yAxis.at(std::max(p.rankedErrorPct, kSmallestErrorPct)); };
  const auto px = [](double v) { return format("%.1f", v); };
  std::string svg = "<svg viewBox=\"0 0 920 460\" role=\"img\" aria-label=\"contour error against time per frame\">\n";
  for (const double v : ticksOf(yAxis))
    svg += "<line class=\"grid\" x1=\"" + px(left) + "\" x2=\"" + px(width - right) + "\" y1=\"" + px(yAxis.at(v)) + "\" y2=\"" +
           px(yAxis.at(v)) + "\"/><text x=\"" + px(left - 6) + "\" y=\"" + px(yAxis.at(v) + 4) + "\" text-anchor=\"end\">" +
           format("%g", v) + " %</text>\n";
  for (const double v : ticksOf(xAxis))
    svg += "<line class=\"grid\" y1=\"" + px(top) + "\" y2=\"" + px(height - bottom) + "\" x1=\"" + px(xAxis.at(v)) + "\" x2=\"" +
           px(xAxis.at(v)) + "\"/><text x=\"" + px(xAxis.at(v)) + "\" y=\"" + px(height - bottom + 16) +
           "\" text-anchor=\"middle\">" + format("%g", v) + "</text>\n";
  svg += "<text x=\"" + px((left + width - right) / 2) + "\" y=\"" + px(height - 8) +
         "\" text-anchor=\"middle\">microseconds per frame</text>\n<text transform=\"translate(14 " +
         px((top + height - bottom) / 2) + ") rotate(-90)\" text-anchor=\"middle\">contour error</text>\n";
  // The front as steps: up to each time, the best error that can be had.
  std::string path;
  double lastY = 0;
  for (const TradeoffPoint& p : t.points) {
    if (!p.pareto) continue;
    path += path.empty() ? "M" + px(x(p)) + "," + px(y(p)) : " L" + px(x(p)) + "," + px(lastY) + " L" + px(x(p)) + "," + px(y(p));
    lastY = y(p);
  }
  if (!path.empty()) svg += "<path class=\"front\" d=\"" + path + " L" + px(width - right) + "," + px(lastY) + "\"/>\n";
  for (const bool onFront : {false, true})
    for (int i = 0; i < static_cast<int>(t.points.size()); ++i) {
      const TradeoffPoint& p = t.points[i];
      if (p.pareto != onFront || !std::isfinite(p.rankedErrorPct)) continue;
      const std::string colour = modelHex(p.model);
      svg += "<circle cx=\"" + px(x(p)) + "\" cy=\"" + px(y(p)) + "\" r=\"" + (onFront ? "5.5" : "4") + "\" stroke=\"" + colour +
             "\" stroke-width=\"1.6\" fill=\"" + (onFront ? colour : "none") + "\"><title>" + std::to_string(i) + ": " +
             escaped(describe(t, p)) + "\n" + format("%.4g", p.contourErrorPct) + " %, IoU " + format("%.4f", p.iou) +
             ", coverage " + format("%.3f", p.coverage) + ", " + format("%.4g", p.predictUs) + " µs/frame</title></circle>\n";
    }
  std::map<int, std::string> labels;
  for (const char* name : {"fast", "balanced", "exact"})
    if (const auto it = t.presets.find(name); it != t.presets.end())
      labels[it->second] += (labels[it->second].empty() ? "" : ", ") + std::string(name);
  if (t.chosen) {
    labels[*t.chosen];
    svg += "<circle class=\"chosen\" cx=\"" + px(x(t.points[*t.chosen])) + "\" cy=\"" + px(y(t.points[*t.chosen])) +
           "\" r=\"10\"/>\n";
  }
  for (const auto& [i, label] : labels) {
    const bool atRight = x(t.points[i]) > width - 130;
    svg += "<text class=\"preset\" x=\"" + px(x(t.points[i]) + (atRight ? -13 : 13)) + "\" y=\"" + px(y(t.points[i]) - 9) + "\"" +
           (atRight ? " text-anchor=\"end\"" : "") + ">" + (label.empty() ? "chosen" : label) + "</text>\n";
  }
  return svg + "</svg>\n";
}

std::string legendOf(const Tradeoff& t) {
  std::vector<std::string> seen;
  std::string out = "<p>";
  for (const TradeoffPoint& p : t.points) {
    if (std::count(seen.begin(), seen.end(), p.model)) continue;
    seen.push_back(p.model);
    out += "<span class=\"swatch\" style=\"background:" + modelHex(p.model) + "\"></span>" + escaped(p.model) + " &nbsp; ";
  }
  return out +
         "&mdash; filled: on the front, no other setting is both faster and more accurate; ring: chosen. Hover over a point for "
         "its setting.</p>\n";
}

}  // namespace

std::string tradeoffHtml(const Tradeoff& t) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"color-scheme\" content=\"light "
      "dark\"><title>Glint: speed against "
      "accuracy</title>\n<style>:root{--back:#fff;--text:#222;--faded:#555;--line:#ddd;--grid:#e8e8e8}"
      "@media(prefers-color-scheme:dark){:root{--back:#16181c;--text:#e4e6ea;--faded:#a4a9b2;--line:#3a3e46;--grid:#2a2d33}}"
      "body{font:14px/1.45 sans-serif;margin:2em auto;max-width:980px;padding:0 1em;color:var(--text);background:var(--back)}"
      "table{border-collapse:collapse;margin:1em 0;width:100%}th,td{padding:.25em .6em;border-bottom:1px solid "
      "var(--line);text-align:right}"
      "td.text,th.text{text-align:left}tr.chosen{font-weight:bold}svg{width:100%;height:auto}svg text{font:11px "
      "sans-serif;fill:var(--faded)}"
      "svg text.preset{font:bold 12px "
      "sans-serif;fill:var(--text)}.grid{stroke:var(--grid)}.front{fill:none;stroke:var(--faded);stroke-width:1.4;stroke-"
      "dasharray:5 3}"
      ".chosen{fill:none;stroke:var(--text);stroke-width:1.6}.swatch{display:inline-block;width:.8em;height:.8em;margin-right:."
      "4em}"
      ".faded{color:var(--faded)}</style></head><body>\n";
  html += "<h1>Speed against accuracy</h1>\n<p>Input <code>" + escaped(t.input) + "</code>, training <code>" +
          escaped(t.trainSpec) + "</code> (" + std::to_string(t.train.size()) + " frames).</p>\n<p><b>" + escaped(t.reason) +
          "</b></p>\n";
  html += svgOf(t) + legendOf(t);
  html +=
      "<h2>Settings measured in full</h2>\n<table><tr><th></th><th class=\"text\">setting</th><th>&micro;s/frame</th><th>error "
      "%</th><th>IoU</th>"
      "<th>coverage</th><th>predicted</th><th>matched / missed / spurious</th><th>fit ms</th><th>peak MB</th></tr>\n";
  for (int i = 0; i < static_cast<int>(t.points.size()); ++i) {
    const TradeoffPoint& p = t.points[i];
    std::string marks = p.pareto ? "&#9679;" : "";
    for (const auto& [name, index] : t.presets)
      if (index == i) marks += " " + name;
    html += std::string("<tr") + (t.chosen == i ? " class=\"chosen\"" : "") + "><td>" + marks +
            "</td><td class=\"text\"><span class=\"swatch\" style=\"background:" + modelHex(p.model) + "\"></span>" +
            escaped(describe(t, p)) + "</td><td>" + format("%.1f", p.predictUs) + "</td><td>" +
            format("%.3g", p.contourErrorPct) + "</td><td>" + format("%.4f", p.iou) + "</td><td>" + format("%.3f", p.coverage) +
            "</td><td>" + std::to_string(p.predicted) + "/" + std::to_string(p.frames) + "</td><td>" + std::to_string(p.matched) +
            " / " + std::to_string(p.missed) + " / " + std::to_string(p.spurious) + "</td><td>" + format("%.2f", p.fitUs * 1e-3) +
            "</td><td>" + format("%.1f", p.peakMb) + "</td></tr>\n";
  }
  html +=
      "</table>\n<p class=\"faded\">Only settings that differ from the defaults are listed. Error: symmetric mean "
      "distance between predicted and "
      "observed contour, in percent of the equivalent diameter of the observed region, mean over held-out highlights. Where a "
      "setting missed highlights, predicted "
      "spurious ones or left directions out, the plot counts these as 100 %. " +
      escaped(t.measurement) + "</p>\n";
  std::map<std::string, std::vector<const PrunedPoint*>> kinds;
  for (const PrunedPoint& p : t.pruned) kinds[p.kind].push_back(&p);
  html += "<h2>Not measured in full</h2>\n<p>" + std::to_string(t.trials) + " settings were tried on a few frames; " +
          std::to_string(t.pruned.size()) + " of those considered were dropped, for these reasons:</p>\n";
  for (const auto& [kind, list] : kinds) {
    html += "<details><summary>" + std::to_string(list.size()) + " " + escaped(kind) + "</summary>\n<table>";
    for (const PrunedPoint* p : list) {
      TradeoffPoint point;
      point.model = p->model;
      point.settings = p->settings;
      html += "<tr><td class=\"text\">" + escaped(describe(t, point)) + "</td><td class=\"text\">" + escaped(p->reason) +
              "</td></tr>\n";
    }
    html += "</table></details>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace glint
