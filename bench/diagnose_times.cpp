// SPDX-License-Identifier: BSD-3-Clause
// Processor time of a diagnosis, run as "Find out why" does: until its first word, its first remedy (-1 = none) and its end; the
// model on screen, the verdict and the flags of the first remedy. docs/make_debugging.py runs this program.
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>

#include "core/advise/diagnosis.h"
#include "core/model/model.h"
#include "core/pipeline/inspection.h"
#include "core/scene/scene.h"

namespace {
double processorSeconds() { return double(std::clock()) / CLOCKS_PER_SEC; }
}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3) {
    std::fputs("usage: diagnose_times SCENE [MODEL ON SCREEN]\n", stderr);
    return 2;
  }
  glint::InspectionRequest request;
  request.models = glint::modelIds();
  const auto scene = std::make_shared<const glint::Scene>(glint::readScene(argv[1]));
  const glint::Inspection inspection = glint::inspect(scene, request);
  const double start = processorSeconds();
  double word = -1, first = -1;
  glint::DiagnoseOptions options;
  if (argc == 3) options.present = argv[2];
  options.soFar = [&](const glint::Diagnosis& d) {
    if (word < 0) word = processorSeconds() - start;
    if (first < 0 && !d.remedies.empty()) first = processorSeconds() - start;
  };
  const glint::Diagnosis d = glint::diagnose(inspection, options);
  std::printf("%.2f %.2f %.1f\n%s\n%s\n%s\n", word, first, processorSeconds() - start, d.present.c_str(), d.verdict.c_str(),
              d.remedies.empty() ? "" : glint::flagsOf(d.remedies.front().change).c_str());
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "diagnose_times: %s\n", e.what());
  return 2;
}
