// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/number_text.h"
#include "core/choice/selection.h"

namespace glint {

std::string selectionTable(const Selection& s) {
  std::string out = "candidate     views   leave-one-out %   std. error %   ahead %  expected %  us/frame  seconds  remark\n";
  double slowest = 0, all = 0;
  std::string slowestModel;
  for (const Candidate& c : s.candidates) {
    const std::string views = std::to_string(c.answered) + "/" + std::to_string(c.tried);
    out += formatted("%-12s %6s %17.4g %14.4g %9.3g %11.3g %9.3g %8.2f  ", c.model.c_str(), views.c_str(), c.meanPct,
                     c.standardErrorPct, c.outlookPct, c.expectedPct, c.predictUs, c.timeUs * 1e-6) +
           c.remark + "\n";
    all += c.timeUs;
    if (c.timeUs > slowest) slowest = c.timeUs, slowestModel = c.model;
  }
  if (s.candidates.size() > 1 && all > slowest) {
    out += formatted("%s makes the search %.2g times as long.\n", slowestModel.c_str(), all / (all - slowest));
  }
  if (s.leftOut < s.trainingViews)
    out += std::to_string(s.leftOut) + " of " + std::to_string(s.trainingViews) +
           " training views were left out one at a time, evenly spread.\n";
  return out + s.why + "\n" + (s.patches ? s.patches->why + "\n" : "");
}

}  // namespace glint
