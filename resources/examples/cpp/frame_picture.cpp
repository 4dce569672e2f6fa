// SPDX-License-Identifier: BSD-3-Clause
// frame_picture FILE.glint OUT.png: the first frame that no model was trained on, with its observed and predicted contours.
#include <cstdio>
#include <exception>

#include "core/app/session.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/photograph.h"
#include "viz/pictures.h"

int main(int count, char** arguments) try {
  if (count != 3) return std::fprintf(stderr, "usage: frame_picture FILE.glint OUT.png\n"), 2;
  const glint::OpenedSession opened = glint::openSession(arguments[1]);
  const glint::Inspection result = glint::inspect(opened.scene, opened.session.request);
  int frame = 0;
  while (frame + 1 < static_cast<int>(result.scene->frames.size()) && !result.isHeldOut(frame)) ++frame;
  glint::viz::writePng(glint::viz::framePicture(result, frame, glint::photographOf(result, frame), 1200, 800), arguments[2]);
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "frame_picture: %s\n", error.what()), 2;
}
