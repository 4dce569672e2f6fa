// SPDX-License-Identifier: BSD-3-Clause
// What stands beside the inputs: work files of a trade-off, settings, specifications of frames.
#include <algorithm>
#include <sstream>

#include "core/app/trial_work_file.h"
#include "core/base/outcome.h"
#include "core/base/settings.h"
#include "core/pipeline/inspection.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/scratch_file.h"

namespace glint::fuzz {

bool feedWorkFile(const std::string& bytes) {
  // A file that this run did not make counts as empty, never as an error; the key is the one of the corpus.
  const WorkFile work(scratch().write("run.work", bytes), "key");
  return work.size() > 0;
}

bool feedSettings(const std::string& bytes) {
  bool all = true;
  std::istringstream lines(bytes);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = std::min(line.find('='), line.size());
    Settings settings;
    try {
      settings.setFromText(line.substr(0, equals), line.substr(std::min(equals + 1, line.size())));
    } catch (const InputError& e) {
      checkRefusal(e, "--set");
      all = false;
      continue;
    }
    for (const auto& [key, value] : settings.values())
      if (!std::holds_alternative<std::string>(value) && !std::holds_alternative<bool>(value)) {
        const ParamSpec& spec = paramSpec(key);
        const double v = std::holds_alternative<int>(value) ? std::get<int>(value) : std::get<double>(value);
        if (!(v >= spec.min && v <= spec.max)) throw Finding{key + " left its range"};
      }
  }
  return all;
}

bool feedTrain(const std::string& bytes) {
  static const Scene scene = [] {
    Scene s;
    for (const char* id : {"0003", "0-5", "a", "a-b", "first:2", "6", "x,y", "-"}) {
      s.frames.emplace_back();
      s.frames.back().id = id;
    }
    return s;
  }();
  try {
    const TrainSpec spec = parseTrainSpec(bytes, scene);
    const int count = static_cast<int>(scene.frames.size());
    if (spec.frames.empty()) throw Finding{"a specification that names no frame"};
    for (std::size_t i = 0; i < spec.frames.size(); ++i)
      if (spec.frames[i] < 0 || spec.frames[i] >= count || (i > 0 && spec.frames[i] <= spec.frames[i - 1]))
        throw Finding{"frames that are not sorted, or do not exist"};
    return true;
  } catch (const InputError& e) {
    checkRefusal(e, "--train");
    return false;
  }
}

}  // namespace glint::fuzz
