// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/html_text.h"
#include "core/pipeline/what_if_knobs.h"
#include "core/report/evaluation_words.h"
#include "core/report/html_parts.h"
#include "core/report/report.h"
#include "core/report/texts.h"

namespace glint {
namespace {

using html::escaped;
using html::format;

constexpr std::size_t kWorstFrames = 9;  // three rows of the page

/// A light page whatever the reader's system prefers: it is printed and pasted. Every text on white has at least 4.5 : 1.
constexpr const char* kStyle =
    "body{font:14px/1.5 sans-serif;margin:2em auto;max-width:980px;padding:0 1em;color:#222;background:#fff}"
    "h1{margin-bottom:.2em}h2{margin-top:1.8em;border-bottom:2px solid #ddd}h3{margin-bottom:.2em}"
    "table{border-collapse:collapse;margin:1em 0;width:100%}th,td{padding:.25em .6em;border-bottom:1px solid #ddd;"
    "text-align:right;vertical-align:top}th:first-child,td:first-child,td.reason,td.text,th.text{text-align:left}"
    "td:first-child{white-space:nowrap}td.part{padding-left:2.2em;color:#555}tbody+tbody{border-top:2px solid #bbb}"
    "svg{width:100%;height:auto}.frames{display:grid;grid-template-columns:repeat(3,1fr);gap:1em;align-items:start}"
    "figure{margin:0}figcaption{font-size:12px;color:#444}.note{color:#555;font-weight:normal;font-size:.93em}"
    ".swatch{display:inline-block;width:.8em;height:.8em;margin-right:.4em}"
    ".bar{display:inline-block;height:.8em;min-width:2px;margin-right:.6em;vertical-align:baseline}"
    ".overview td.text{width:70%}tr.best td{font-weight:bold}.refused{color:#9c1f12}"
    "tr.poor td{color:#666;font-style:italic}"
    ".short{background:#f4f6f8;border-left:5px solid #2f7cc4;padding:.2em 1.2em .8em}.short p:first-child{font-size:1.15em}"
    "ul{padding-left:1.4em}.settings{columns:3;column-gap:2em;font-size:12px}.settings p{margin:0;break-inside:avoid}"
    "@media(max-width:700px){.frames{grid-template-columns:1fr}.settings{columns:1}}"
    "@page{margin:15mm}@media print{body{margin:0;max-width:none;padding:0;font-size:10pt}"
    "*{-webkit-print-color-adjust:exact;print-color-adjust:exact}h2,h3{break-after:avoid}"
    "figure,tr,li,svg{break-inside:avoid}thead{display:table-header-group}}";

std::string head(const Inspection& inspection) {
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width\"><meta name=\"color-scheme\" content=\"light\"><title>Glint evaluation: " +
         escaped(inspection.scene->name) + "</title>\n<style>" + kStyle + "</style></head><body>\n";
}

/// What was evaluated.
std::string about(const Inspection& inspection, const ReportContext& context) {
  std::string text = "<h1>" + escaped(inspection.scene->name) + "</h1>\n<p>Input <code>" + escaped(context.input) +
                     "</code>, training <code>" + escaped(trainText(inspection.train, *inspection.scene)) + "</code> (" +
                     std::to_string(inspection.train.frames.size()) + " of " + std::to_string(inspection.scene->frames.size()) +
                     " frames), level " + format("%g", inspection.request.settings.number("detect.level")) +
                     (inspection.request.whatIf.synthesise              ? ""
                      : inspection.request.source == FrameSource::Image ? ", from captured images"
                                                                        : ", from float radiance where available") +
                     ".</p>\n";
  if (const std::string changed = summaryOf(inspection.request.whatIf); !changed.empty())
    text += "<p><b>What-if: " + escaped(changed) + ".</b> The scene differs from the captured one.</p>\n";
  return text;
}

std::string summary(const Inspection& inspection, const EvaluationWords& words) {
  std::string text = "<h2>In short</h2>\n<div class=\"short\">\n";
  for (const std::string& s : words.inShort) text += "<p>" + escaped(s) + "</p>\n";
  text += "</div>\n" + html::overview(inspection, words.best);
  if (!words.best.empty()) text += html::bestFigures(inspection, words.best);
  if (words.doubts.empty()) return text;
  text += "<h2>What to doubt</h2>\n<ul>\n";
  for (const std::string& s : words.doubts) text += "<li>" + escaped(s) + "</li>\n";
  return text + "</ul>\n";
}

std::string candidatesTable(const Selection& selection) {
  std::string text =
      "<h2>How the model was chosen</h2>\n<table><thead><tr><th>candidate</th><th>left-out views answered</th>"
      "<th>leave-one-out error %</th><th>standard error %</th><th>&micro;s/frame</th><th class=\"text\">remark</th></tr></thead>"
      "<tbody>\n";
  for (const Candidate& c : selection.candidates)
    text += "<tr><td>" + html::swatch(c.model) + escaped(c.model) + "</td><td>" + std::to_string(c.answered) + " / " +
            std::to_string(c.tried) + "</td><td>" + format("%.3g", c.meanPct) + "</td><td>" + format("%.2g", c.standardErrorPct) +
            "</td><td>" + format("%.3g", c.predictUs) + "</td><td class=\"reason\">" + escaped(c.remark) + "</td></tr>\n";
  return text + "</tbody></table>\n";
}

/// Every setting, so that the report says by itself what was computed: what differs from the defaults first.
std::string settingsList(const Settings& settings) {
  std::string own, rest;
  for (const ParamSpec& p : allParams()) {
    const SettingValue& value = settings.value(p.key);
    const std::string key = "<code>" + escaped(p.key) + "</code>", unit = p.unit.empty() ? "" : " " + escaped(p.unit);
    if (value != p.defaultValue)
      own += "<tr><td>" + key + "</td><td><b>" + escaped(settingText(value)) + "</b>" + unit + "</td><td>" +
             escaped(settingText(p.defaultValue)) + unit + "</td></tr>\n";
    else
      rest += "<p>" + key + " " + escaped(settingText(value)) + unit + "</p>\n";
  }
  return "<h2>Settings</h2>\n" +
         (own.empty() ? "<p>All as by default:</p>\n"
                      : "<table><thead><tr><th>setting</th><th>value</th><th>default</th></tr></thead><tbody>\n" + own +
                            "</tbody></table>\n<p>All others as by default:</p>\n") +
         "<div class=\"settings\">\n" + rest + "</div>\n";
}

}  // namespace

std::string evaluationHtml(const Inspection& inspection, const ReportContext& context) {
  std::string page = head(inspection) + about(inspection, context) + summary(inspection, evaluationWords(inspection, context));
  page += "<h2>Error over frames</h2>\n" + html::errorFigure(inspection);
  page += "<h2>Numbers</h2>\n<p>Errors are taken over the " + std::string(inspection.train.perSurface ? "" : "held-out ") +
          "highlights that a model found; those that it missed are counted beside them: symmetric mean distance between "
          "predicted and observed contour, as a percentage of the equivalent "
          "diameter of the observed region. Scored against " +
          scoredAgainst(inspection) + ".</p>\n" + html::statisticsTable(inspection);
  if (context.selection) page += candidatesTable(*context.selection);
  page += "<h2>Models</h2>\n" + html::modelSections(inspection);
  page += "<h2>Worst frames</h2>\n<p>White: observed contour. Coloured: predictions.</p>\n<div class=\"frames\">\n";
  for (const int frame : html::worstFrames(inspection, kWorstFrames)) page += html::frameFigure(inspection, frame, "", "");
  page += "</div>\n" + settingsList(inspection.request.settings);
  if (!context.program.empty()) page += "<p>Made by " + escaped(context.program) + ".</p>\n";
  return page + "</body></html>\n";
}

}  // namespace glint
