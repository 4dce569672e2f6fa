// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnose/spurious_note.h"

#include <algorithm>
#include <set>

#include "core/base/number_text.h"
#include "core/inspect/prediction_filter.h"

namespace glint {
namespace {

bool isSpurious(const FrameComparison::Row& row) { return row.predicted >= 0 && row.observed < 0; }

/// Predicted highlights that a filter takes out of one frame.
struct Taken {
  int spurious = 0, matched = 0;
};

/// @param only  settings with one filter
Taken taken(const Inspection& inspection, const ModelResult& result, const FrameComparison& c, const Settings& only) {
  Taken t;
  if (c.prediction.failure() || c.fit < 0 || !result.fits[std::size_t(c.fit)].fit) return t;
  const Outcome<std::shared_ptr<const Surface>> surface = surfaceFor(inspection, c.frame, c.light);
  const Camera& camera = inspection.scene->frames[std::size_t(c.frame)].camera;
  for (const FrameComparison::Row& row : c.rows) {
    if (row.predicted < 0) continue;
    // Alone, so that its place among the others does not change: neither filter compares them.
    Prediction one(std::vector{c.prediction.highlights()[std::size_t(row.predicted)]});
    filterPrediction(one, *result.fits[std::size_t(c.fit)].fit, camera, surface ? surface->get() : nullptr, only);
    if (!one.filtered.empty()) ++(isSpurious(row) ? t.spurious : t.matched);
  }
  return t;
}

}  // namespace

std::string spuriousNote(const Inspection& inspection, const ModelResult& result) {
  int spurious = 0, matched = 0;
  std::set<int> frames;  // one may have several lights
  std::vector<const FrameComparison*> held;
  for (const FrameComparison& c : result.frames) {
    if (!inspection.isHeldOut(c.frame) || c.prediction.failure()) continue;
    held.push_back(&c);
    const auto count = std::count_if(c.rows.begin(), c.rows.end(), isSpurious);
    spurious += int(count);
    if (count > 0) frames.insert(c.frame);
    matched +=
        int(std::count_if(c.rows.begin(), c.rows.end(), [](const auto& r) { return r.predicted >= 0 && r.observed >= 0; }));
  }
  if (spurious == 0) return "";
  std::string text =
      formatted("%d predicted %s in %d held-out %s %s no observed one", spurious, spurious == 1 ? "highlight" : "highlights",
                int(frames.size()), frames.size() == 1 ? "frame" : "frames", spurious == 1 ? "matches" : "match");
  bool helps = false;
  for (const char* key : {"predict.filter_area", "predict.filter_shadow"}) {
    const Settings& settings = inspection.request.settings;
    if (settings.flag(key)) continue;
    Settings only = settings;
    for (const char* off : {"predict.filter_area", "predict.filter_shadow"}) only.setFromText(off, "false");
    only.setFromText("predict.filter_brightness", "0");
    only.setFromText(key, "true");
    Taken all;
    for (const FrameComparison* c : held) {
      const Taken t = taken(inspection, result, *c, only);
      all.spurious += t.spurious;
      all.matched += t.matched;
    }
    if (all.spurious == 0 || all.matched > 0) continue;
    text += formatted("; with %s = true, %d %s left out, and none of the %d that match", key, all.spurious,
                      all.spurious == 1 ? "is" : "are", matched);
    helps = true;
  }
  return text + (helps ? "" : "; no filter of predictions takes them alone");
}

}  // namespace glint
