// SPDX-License-Identifier: BSD-3-Clause
// session_errors FILE.glint: fits the models of a session and prints how far each predicted contour lies from the observed one.
#include <cstdio>
#include <exception>

#include "core/app/session.h"
#include "core/pipeline/inspection.h"

int main(int count, char** arguments) try {
  if (count != 2) return std::fprintf(stderr, "usage: session_errors FILE.glint\n"), 2;
  const glint::OpenedSession opened = glint::openSession(arguments[1]);
  const glint::Inspection result = glint::inspect(opened.scene, opened.session.request);
  for (const auto& [name, model] : result.models)
    for (const glint::FrameComparison& comparison : model.frames)
      for (const auto& row : comparison.rows) {
        if (!row.metrics || !result.isHeldOut(comparison.frame)) continue;  // nothing to compare, or a frame that trained
        const glint::Frame& frame = result.scene->frames[static_cast<std::size_t>(comparison.frame)];
        std::printf("%s %s %s %d %.17g\n", name.c_str(), frame.id.c_str(), comparison.light.c_str(), row.observed,
                    row.metrics->contourErrorPx);
      }
  return 0;
} catch (const std::exception& error) {  // glint::InputError names file, place and reason
  return std::fprintf(stderr, "session_errors: %s\n", error.what()), 2;
}
