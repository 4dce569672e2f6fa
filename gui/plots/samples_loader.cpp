// SPDX-License-Identifier: BSD-3-Clause
#include "gui/plots/samples_loader.h"

#include <exception>
#include <utility>

namespace glint::gui {

void SamplesLoader::want(std::shared_ptr<const Inspection> inspection, int frame, const std::string& model) {
  if (!inspection) return job_.drop();
  job_.run([this, inspection = std::move(inspection), frame, model] {
    auto samples = std::make_shared<draw::FrameSamples>();
    try {
      *samples = draw::frameSamples(*inspection, frame, model);
    } catch (const std::exception& e) {
      samples->failure = e.what();
    }
    return LatestJob::Deliver([this, samples = FrameSamplesPtr(std::move(samples))] { emit loaded(samples); });
  });
}

}  // namespace glint::gui
