// SPDX-License-Identifier: BSD-3-Clause
// Seconds of a diagnosis, as "Find out why" runs it on results that are there: docs/make_debugging.py runs this program.
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "core/diagnose/diagnosis.h"
#include "core/inspect/inspection.h"
#include "core/model/model.h"
#include "core/scene/scene.h"

namespace {
using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }
}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fputs("usage: diagnose_times SCENE\n", stderr);
    return 2;
  }
  glint::InspectionRequest request;
  request.models = glint::modelIds();
  const auto scene = std::make_shared<const glint::Scene>(glint::readScene(argv[1]));
  const glint::Inspection inspection = glint::inspect(scene, request);
  const Clock::time_point start = Clock::now();
  double first = -1;
  std::string what = "none";
  glint::DiagnoseOptions options;
  options.found = [&](const std::string& model, const glint::Remedy& remedy) {
    if (first >= 0 || !remedy.measured) return;
    first = secondsSince(start);
    what = model + ": " + glint::flagsOf(remedy.change);
  };
  glint::diagnose(inspection, options);
  std::printf("first %.2f all %.1f %s\n", first, secondsSince(start), what.c_str());
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "diagnose_times: %s\n", e.what());
  return 2;
}
