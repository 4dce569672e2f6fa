// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/warnings.h"

#include "core/base/light_name.h"
#include "core/report/evaluation_notes.h"

namespace glint {

std::string fitWarning(const std::string& model, const std::string& light, const std::optional<std::string>& surface,
                       const std::string& remark) {
  return model + ", " + lightName(light) + (surface ? ", surface " + *surface : "") + ": " + remark;
}

std::string poorWarning(const std::string& reason) { return "poor: " + reason; }

std::vector<std::string> warningsOf(const Inspection& inspection) {
  std::vector<std::string> warnings = evidenceWarnings(notesOf(inspection));
  for (const std::string& name : inspection.request.models) {
    const auto model = inspection.models.find(name);
    if (model == inspection.models.end()) continue;
    for (const ModelResult::Fit& fit : model->second.fits) {
      if (!fit.fit) continue;
      if (!fit.fit->poor.empty()) warnings.push_back(fitWarning(name, fit.light, fit.surface, poorWarning(fit.fit->poor)));
      for (const std::string& remark : fit.fit->remarks) warnings.push_back(fitWarning(name, fit.light, fit.surface, remark));
    }
  }
  return warnings;
}

std::string scoredAgainst(const Inspection& inspection) {
  if (!inspection.request.truthFolder.empty()) return "truth";
  return scoredAgainst(notesOf(inspection));
}

}  // namespace glint
