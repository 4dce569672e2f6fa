// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/models.h"

namespace glint {

const std::vector<std::unique_ptr<HighlightModel>>& allModels() {
  static const std::vector<std::unique_ptr<HighlightModel>> models = [] {
    std::vector<std::unique_ptr<HighlightModel>> m;
    m.push_back(makePrimal());
    m.push_back(makeDual());
    m.push_back(makeCanonical());
    m.push_back(makeLimitAngle());
    return m;
  }();
  return models;
}

const HighlightModel& modelByName(const std::string& id) {
  std::string known;
  for (const auto& m : allModels()) {
    if (m->id() == id) return *m;
    known += (known.empty() ? "" : ", ") + m->id();
  }
  throw InputError("", "model '" + id + "'", "there is no such model; known: " + known);
}

BrightestPointOptions brightestOptions(const Settings& settings) {
  BrightestPointOptions o;
  o.seedStepPx = settings.number("predict.seed_step");
  return o;
}

}  // namespace glint
