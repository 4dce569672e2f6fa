// SPDX-License-Identifier: BSD-3-Clause
// glint-save HOW INPUT MODEL TARGET: what the inspector does when it saves (HOW = save, with results) or keeps what is not saved
// (autosave).
#include <cstdio>
#include <exception>
#include <string>

#include "core/base/safe_text.h"
#include "core/pipeline/inspection.h"
#include "gui/document/session_file.h"

int main(int argc, char** argv) {
  using namespace glint;
  if (argc != 5) return 2;
  const std::string how = argv[1];
  try {
    gui::Opened opened = gui::openInput(argv[2]);
    opened.request.models = {argv[3]};
    if (how == "save") {
      const Inspection inspection = inspect(opened.scene, opened.request);
      gui::saveSession(opened, &inspection, argv[4]);
    } else {
      gui::autosaveSession(opened, argv[4]);
    }
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "glint-save: %s\n", messageLine(e.what()).c_str());
    return 2;
  }
}
