// SPDX-License-Identifier: BSD-3-Clause
// stability [--stage NAME] [--json FILE] [--markdown]: the extremes as a table, as JSON (docs/formats.md) or as the table of
// docs/stability.md.
#include <algorithm>
#include <iostream>

#include "core/base/atomic_file.h"
#include "core/base/outcome.h"
#include "core/scene/outputs.h"
#include "tests/stability/stability.h"

int main(int argc, char** argv) {
  using namespace glint;
  const std::vector<std::string> words(argv + 1, argv + argc);
  std::string json, stage;
  bool markdown = false;
  try {
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] == "--markdown")
        markdown = true;
      else if ((words[i] == "--json" || words[i] == "--stage") && i + 1 < words.size())
        (words[i] == "--json" ? json : stage) = words[i + 1], ++i;
      else
        throw InputError("", words[i], "expected [--stage NAME] [--json FILE] [--markdown]");
    }
    Outputs(std::vector<std::filesystem::path>{}).file(json, "--json", OutputKind::document("glint_stability"));
    const std::vector<StabilityResult> results = runStability({}, stage);
    if (json == "-")
      std::cout << stabilityJson(results);
    else
      std::cout << (markdown ? stabilityMarkdown(results) : stabilityTable(results));
    if (!json.empty() && json != "-") atomicWrite(json, stabilityJson(results));
    return std::any_of(results.begin(), results.end(), [](const StabilityResult& r) { return r.verdict == CaseVerdict::Wrong; });
  } catch (const InputError& e) {
    std::cerr << "stability: " << e.what() << "\n";
    return 2;
  }
}
