// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/lamps_on_csv.h"

#include <map>

#include "core/base/csv_text.h"
#include "core/base/number_text.h"

namespace glint {

const char* const kLampsOnCsvHeader = "frame,light,state,confidence,contrast,expected,noise,x,y,stated,reason";

std::string lampsOnCsv(const LampsOn& lamps, const Scene& scene) {
  std::string text = std::string(kLampsOnCsvHeader) + "\n";
  const auto idOf = [&](int frame) { return csvText(scene.frames[static_cast<std::size_t>(frame)].id); };
  for (const LampInFrame& l : lamps.lamps) {
    text += idOf(l.frame) + "," + csvText(l.light) + "," + wordOf(l.state) + ",";
    text += l.confidence > 0 ? formatted("%.4f,%.6g,%.6g,%.6g,", l.confidence, l.contrast, l.expected, l.noise) : ",,,,";
    text += l.place ? formatted("%.3f,%.3f,", l.place->x(), l.place->y()) : ",,";
    text += std::string(l.stated ? *l.stated ? "on" : "off" : "") + "," + csvText(l.reason) + "\n";
  }
  for (const UnexpectedHighlight& h : lamps.unexpected)
    text += idOf(h.frame) + ",,unexpected,," +
            formatted("%.6g,,%.6g,%.3f,%.3f,,", h.contrast, h.noise, h.place.x(), h.place.y()) +
            "a highlight that no lamp explains\n";
  return text;
}

std::string lampsOnSummary(const LampsOn& lamps) {
  std::map<LampIs, int> count;
  for (const LampInFrame& l : lamps.lamps) ++count[l.state];
  return formatted("lamps in frames: %d on, %d off, %d cannot be seen, %d unsure; %zu highlights that no lamp explains\n",
                   count[LampIs::On], count[LampIs::Off], count[LampIs::CannotBeSeen], count[LampIs::Unsure],
                   lamps.unexpected.size());
}

}  // namespace glint
