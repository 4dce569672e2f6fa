// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/band_text.h"

#include "core/base/number_text.h"

namespace glint {

std::optional<BandScore> bandSummary(const Inspection& inspection, const ModelResult& result) {
  BandScore mean;
  double count = 0;
  for (const ComparisonTally& tally : talliesOf(inspection, result))
    for (const BandScore& band : tally.bands) {
      mean.sigmaPx += band.sigmaPx;
      mean.coverage += band.coverage;
      count += 1;
    }
  if (!(count > 0)) return std::nullopt;
  mean.sigmaPx /= count;
  mean.coverage /= count;
  return mean;
}

std::vector<std::string> bandLines(const Inspection& inspection, const ModelResult& result) {
  std::vector<std::string> lines;
  if (const std::optional<BandScore> score = bandSummary(inspection, result)) {
    const std::string text =
        formatted("bands: sigma %.3g px; %.1f %% of the vertices lie within 1.96 sigma of the %s contours", score->sigmaPx,
                  100 * score->coverage, inspection.request.truthFolder.empty() ? "observed" : "true");
    lines.emplace_back(text);
  }
  for (const ModelResult::Fit& fit : result.fits)
    for (const std::string& remark : fit.bandRemarks)
      lines.push_back((result.fits.size() > 1 ? textOf(fit.key()) + ": " : "") + remark);
  return lines;
}

}  // namespace glint
