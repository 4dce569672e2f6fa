// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/advise/highlight_evidence.h"
#include "core/base/html_text.h"
#include "core/base/words.h"
#include "core/model/models.h"
#include "core/report/html_parts.h"
#include "core/report/texts.h"
#include "core/scene/frame_name.h"

namespace glint::html {
namespace {

/// The summary of one light alone.
ModelSummary ofLight(const Inspection& inspection, const ModelResult& result, const std::string& light) {
  std::vector<ComparisonTally> tallies;
  for (const FrameComparison& c : result.frames)
    if (inspection.isHeldOut(c.frame) && c.light == light) tallies.push_back(tallyOf(c));
  FitReasons reasons;
  for (const ModelResult::Fit& fit : result.fits)
    if (fit.light == light) reasons.add(fitStatus(fit), fitReason(fit));
  return summaryOf(tallies, reasons, heldOutFrames(inspection));
}

/// Lights of a model's comparisons, in their order.
std::vector<std::string> lightsOf(const Inspection& inspection, const ModelResult& result) {
  std::vector<std::string> lights;
  for (const FrameComparison& c : result.frames)
    if (inspection.isHeldOut(c.frame) && std::find(lights.begin(), lights.end(), c.light) == lights.end())
      lights.push_back(c.light);
  return lights;
}

std::string statisticsRow(const std::string& head, const ModelSummary& s) {
  std::string html = std::string(s.poor ? "<tr class=\"poor\">" : "<tr>") + head + "<td>" + std::to_string(s.predicted) + "/" +
                     std::to_string(s.frames) + "</td>";
  if (!s.answered) return html + "<td class=\"reason\" colspan=\"10\">" + escaped(s.reason) + "</td></tr>\n";
  for (const double v : {s.contourErrorPct.mean, s.contourErrorPct.median, s.contourErrorPct.p95, s.contourErrorPct.max,
                         s.contourErrorPx.mean, s.ellipseErrorPct.mean})
    html += "<td>" + format("%.3g", v) + "</td>";
  return html + "<td>" + format("%.4f", s.iou.mean) + "</td><td>" + format("%.3f", s.coverage.mean) + "</td><td>" +
         std::to_string(s.matched) + " / " + std::to_string(s.missed) + " / " + std::to_string(s.spurious) + "</td><td>" +
         format("%.0f", s.timeUs.median) + "</td></tr>\n";
}

/// Held-out highlights without a partner, those with the same reason in one row.
struct Unmatched {
  bool missed = false;  ///< else spurious
  std::string light, why;
  std::vector<int> frames;
};
std::vector<Unmatched> unmatchedOf(const Inspection& inspection, const std::string& model) {
  std::vector<Unmatched> groups;
  for (const bool missed : {true, false})
    for (const FrameComparison& c : inspection.models.at(model).frames)
      for (const FrameComparison::Row& row : c.rows) {
        if (!inspection.isHeldOut(c.frame) || row.metrics || (missed ? row.observed < 0 : row.observed >= 0 || row.predicted < 0))
          continue;
        const std::string why = whyUnmatched(inspection, c, row);
        const auto same = std::find_if(groups.begin(), groups.end(), [&](const Unmatched& g) {
          return g.missed == missed && g.light == c.light && g.why == why;
        });
        if (same == groups.end())
          groups.push_back({missed, c.light, why, {c.frame}});
        else
          same->frames.push_back(c.frame);
      }
  return groups;
}

/// "0012, 0014": all of them.
std::string idsOf(const Inspection& inspection, const std::vector<int>& frames) {
  std::string text;
  for (const std::string& id : frameIds(*inspection.scene, frames)) text += (text.empty() ? "" : ", ") + id;
  return text;
}

std::string unmatchedTable(const Inspection& inspection, const std::string& model) {
  constexpr std::size_t kMost = 40;  // rows of one model that anybody reads
  const std::vector<Unmatched> groups = unmatchedOf(inspection, model);
  if (groups.empty()) return "";
  std::string html =
      "<table><thead><tr><th>what</th><th class=\"text\">light</th><th class=\"text\">why</th><th class=\"text\">frames</th></tr>"
      "</thead><tbody>\n";
  for (std::size_t i = 0; i < std::min(kMost, groups.size()); ++i) {
    const Unmatched& g = groups[i];
    html += std::string("<tr><td>") + std::to_string(g.frames.size()) + (g.missed ? " missed" : " spurious") +
            "</td><td class=\"text\">" + escaped(g.light) + "</td><td class=\"text\">" + escaped(g.why) +
            "</td><td class=\"text\">" + escaped(idsOf(inspection, g.frames)) + "</td></tr>\n";
  }
  html += "</tbody></table>\n";
  return groups.size() > kMost ? html + "<p>And " + std::to_string(groups.size() - kMost) + " more.</p>\n" : html;
}

std::string remarks(const Inspection& inspection, const ModelResult& result) {
  std::string html;
  for (const ModelResult::Fit& fit : result.fits) {
    const std::string of = result.fits.size() > 1 ? textOf(fit.key()) + ": " : "";
    if (fit.failure()) html += "<li class=\"refused\">" + escaped(of + "no fit: " + fit.failure()->message()) + "</li>\n";
    if (fit.fit && !fit.fit->poor.empty() && result.fits.size() > 1)  // a single fit has it above
      html += "<li class=\"refused\">" + escaped(of + poorWarning(fit.fit->poor)) + "</li>\n";
    if (fit.fit)
      for (const std::string& remark : fit.fit->remarks) html += "<li>" + escaped(of + remark) + "</li>\n";
  }
  for (const std::string& text : bandLines(inspection, result)) html += "<li>" + escaped(text) + "</li>\n";
  return html.empty() ? html : "<ul>\n" + html + "</ul>\n";
}

}  // namespace

std::string swatch(const std::string& model) {
  return "<span class=\"swatch\" style=\"background:" + modelHex(model) + "\"></span>";
}

std::string overview(const Inspection& inspection, const std::string& best) {
  double largest = 0;
  for (const auto& [name, result] : inspection.models)
    if (const double mean = summarise(inspection, result).contourErrorPct.mean; std::isfinite(mean))
      largest = std::max(largest, mean);
  std::string html =
      "<table class=\"overview\"><thead><tr><th>model</th><th class=\"text\">mean error of those found, % of a highlight's "
      "diameter</th><th>missed</th>"
      "<th>spurious</th></tr></thead><tbody>\n";
  for (const std::string& name : inspection.request.models) {
    if (!inspection.models.count(name)) continue;
    const ModelSummary s = summarise(inspection, inspection.models.at(name));
    const std::string classes = std::string(name == best ? "best " : "") + (s.poor ? "poor" : "");
    html += "<tr" + (classes.empty() ? "" : " class=\"" + classes + "\"") + "><td>" + swatch(name) + escaped(name) +
            (s.poor ? " <span class=\"refused\">poor</span>" : "") + "</td>";
    if (!s.answered) {
      html += "<td class=\"text refused\" colspan=\"3\">no answer</td></tr>\n";
      continue;
    }
    const double mean = s.contourErrorPct.mean;
    html += "<td class=\"text\">";
    if (std::isfinite(mean) && largest > 0)
      html += "<span class=\"bar\" style=\"width:" + format("%.2f", 75 * mean / largest) + "%;background:" + modelHex(name) +
              "\"></span>";
    html +=
        format("%.3g", mean) + "</td><td>" + std::to_string(s.missed) + "</td><td>" + std::to_string(s.spurious) + "</td></tr>\n";
  }
  return html + "</tbody></table>\n";
}

std::string statisticsTable(const Inspection& inspection) {
  std::string html =
      "<table><thead><tr><th>model</th><th>predicted</th><th>mean %</th><th>median %</th><th>p95 %</th><th>max %</th><th>mean "
      "px</th>"
      "<th>ellipse %</th><th>IoU</th><th>coverage</th><th>matched / missed / spurious</th><th>median "
      "&micro;s</th></tr></thead>\n";
  for (const std::string& name : inspection.request.models) {
    if (!inspection.models.count(name)) continue;
    const ModelResult& result = inspection.models.at(name);
    html += "<tbody>\n" + statisticsRow("<td>" + swatch(name) + escaped(name) + "</td>", summarise(inspection, result));
    if (const std::vector<std::string> lights = lightsOf(inspection, result); lights.size() > 1)
      for (const std::string& light : lights)
        html += statisticsRow("<td class=\"part\">" + escaped(lightName(light)) + "</td>", ofLight(inspection, result, light));
    html += "</tbody>\n";
  }
  return html + "</table>\n";
}

std::string modelSections(const Inspection& inspection) {
  std::string html;
  for (const std::string& name : inspection.request.models) {
    if (!inspection.models.count(name)) continue;
    const ModelResult& result = inspection.models.at(name);
    html += "<section class=\"model\">\n<h3>" + swatch(name) + escaped(name);
    if (const HighlightModel* const model = findModel(name))
      html += " <span class=\"note\">" + escaped(model->title()) + "</span></h3>\n<p>" + escaped(model->assumption()) +
              " <span class=\"note\">(" + escaped(model->reference()) + ")</span></p>\n";
    else
      html += "</h3>\n";
    const ModelSummary s = summarise(inspection, result);
    if (s.poor) html += "<p class=\"refused\"><b>Poor answer:</b> " + escaped(s.reason) + "</p>\n";
    if (!s.answered) html += "<p class=\"refused\"><b>No answer:</b> " + escaped(s.reason) + "</p>\n";
    html += remarks(inspection, result) + unmatchedTable(inspection, name) + "</section>\n";
  }
  return html;
}

}  // namespace glint::html
