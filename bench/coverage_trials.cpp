// SPDX-License-Identifier: BSD-3-Clause
// Checks the uncertainty band by noisy trials and prints a table: coverage_trials TRIALS MODEL... (docs/make_uncertainty.py calls
// it).
#include "tests/core/model/coverage_trials.h"

#include <cstdio>
#include <cstdlib>
#include <string>

int main(int argc, char** argv) {
  using namespace glint::test;
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s TRIALS MODEL...\n", argv[0]);
    return 2;
  }
  for (int m = 2; m < argc; ++m)
    for (const auto& [name, scene] : coverageScenes())
      for (const double noise : {0.1, 0.3, 1.0}) {
        CoverageTrials t;
        t.scene = scene;
        if (std::string(argv[m]) == "reflectance") {
          if (noise != 0.3) continue;  // a fit takes fifty times as long
          t = rightLobe(std::move(t));
        }
        t.model = argv[m];
        t.noisePx = noise;
        t.trials = std::atoi(argv[1]);
        const CoverageResult r = runCoverageTrials(t);
        std::printf("%s\t%s\t%g\t%d\t%d\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\n", argv[m], name.c_str(), noise, r.trials, r.failed,
                    r.share(), r.shareSpread, r.meanSigmaPx, r.rmsErrorPx, r.meanNoisePx);
        std::fflush(stdout);
      }
}
