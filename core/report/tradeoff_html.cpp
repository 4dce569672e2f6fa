// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "core/base/html_text.h"
#include "core/choice/tradeoff.h"
#include "core/draw/plot_painter.h"
#include "core/draw/plots.h"
#include "core/draw/svg_painter.h"
#include "core/model/models.h"
#include "core/report/report.h"

namespace glint {
namespace {

using html::escaped;
using html::format;

/// The plot that the inspector shows, twice: for light and dark pages.
std::string svgOf(const Tradeoff& t) {
  constexpr double kWidth = 920, kHeight = 460;
  const draw::PlotData plot = draw::tradeoffPlot(t);
  if (!plot.empty.empty()) return "<p>No setting answered, so there is nothing to plot.</p>\n";
  std::string html;
  for (const bool dark : {false, true}) {
    draw::SvgPainter painter(kWidth, kHeight);
    draw::paintPlot(painter, plot, {dark, 1}, draw::rangeOf(plot), {}, kWidth, kHeight);
    html += std::string("<div class=\"") + (dark ? "dark" : "light") + "\">" +
            painter.element("contour error against time per frame") + "</div>\n";
  }
  return html;
}

constexpr const char* kLegend =
    "<p>Filled points lie on the front: no other setting is both faster and more accurate. Names mark the presets and the chosen "
    "setting. Hover over a point for its setting.</p>\n";

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
      "td.text,th.text{text-align:left}tr.chosen{font-weight:bold}svg{width:100%;height:auto}.dark{display:none}"
      "@media(prefers-color-scheme:dark){.light{display:none}.dark{display:block}}"
      ".swatch{display:inline-block;width:.8em;height:.8em;margin-right:."
      "4em}"
      ".faded{color:var(--faded)}</style></head><body>\n";
  html += "<h1>Speed against accuracy</h1>\n<p>Input <code>" + escaped(t.input) + "</code>, training <code>" +
          escaped(trainedOn(t)) + "</code> (" + std::to_string(t.train.size()) + " frames).</p>\n<p><b>" + escaped(t.reason) +
          "</b></p>\n";
  if (const std::string note = presetNote(t); !note.empty()) html += "<p>" + escaped(note) + "</p>\n";
  html += svgOf(t) + kLegend;
  html +=
      "<h2>Settings measured in full</h2>\n<table><tr><th></th><th class=\"text\">setting</th><th>&micro;s/frame</th><th>error "
      "%</th><th>highlights found</th><th>error of those found %</th><th>spurious</th><th>IoU</th><th>coverage</th><th>fit "
      "ms</th><th>peak MB</th></tr>\n";
  for (int i = 0; i < static_cast<int>(t.points.size()); ++i) {
    const TradeoffPoint& p = t.points[i];
    const std::string names = presetNames(t, i), marks = (p.pareto ? "&#9679; " : "") + names;
    html += std::string("<tr") + (t.chosen == i ? " class=\"chosen\"" : "") + "><td>" + marks +
            "</td><td class=\"text\"><span class=\"swatch\" style=\"background:" + modelHex(p.model) + "\"></span>" +
            escaped(describe(t, p) + (p.poor.empty() ? "" : ", poor: " + p.poor)) + "</td><td>" + format("%.1f", p.predictUs) +
            "</td><td>" + format("%.3g", p.rankedErrorPct) + "</td><td>" + foundText(p) + "</td><td>" +
            format("%.3g", p.contourErrorPct) + "</td><td>" + std::to_string(p.spurious) + "</td><td>" + format("%.4f", p.iou) +
            "</td><td>" + format("%.3f", p.coverage) + "</td><td>" + format("%.2f", p.fitUs * 1e-3) + "</td><td>" +
            format("%.1f", p.peakMb) + "</td></tr>\n";
  }
  html += "</table>\n<p class=\"faded\">Only settings that differ from the defaults are listed. " + escaped(kTradeoffErrors) +
          " " + escaped(t.measurement) + "</p>\n";
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
