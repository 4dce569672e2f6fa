// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/observer.h"

#include <utility>

namespace glint::gui {

Observer::Observer(const Engine& engine, Document& document, QObject* parent)
    : QObject(parent), engine_(engine), document_(document) {
  connect(&document_, &Document::requestChanged, this, &Observer::observe);
}

void Observer::observe() {
  job_.drop();
  const auto known = document_.results();
  if (!document_.stale()) return;          // results of this request were still there
  if (!engine_.contour || !known) return;  // before the first results there is nothing that could be behind
  job_.run([this, contour = engine_.contour, pipeline = document_.pipeline(), request = document_.request(), known,
            frame = document_.selection().frame]() -> LatestJob::Deliver {
    std::optional<Observation> seen;
    try {
      seen = contour(*pipeline, request, frame, {}, known.get());
    } catch (const InputError&) {
      return {};  // the run beside it fails for the same reason, and says so
    }
    const auto observation = seen ? std::make_shared<const Observation>(std::move(*seen)) : nullptr;
    return [this, observation] { document_.setObservation(observation); };
  });
}

}  // namespace glint::gui
