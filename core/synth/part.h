// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/shard.h"
#include "core/synth/synth.h"

namespace glint {

/// What one shard of a synthetic scene left in the folder of the whole.
struct SynthPart {
  std::filesystem::path file;  ///< FOLDER/parts/2-of-8.json
  int frames = 0, highlights = 0;
  std::vector<std::string> warnings;  ///< of its frames
};
/// Makes the shard's frames in `folder`, where other shards may be at work at the same time, on other machines too, and last its part, which
/// lists them with their digests. A shard that failed is repeated by the same call. Highlights of all frames are traced where the exposure or
/// the noise is that of the brightest peak.
/// @param program  with its version
/// @throw InputError as synthesise(); Stopped.
SynthPart synthesisePart(const SynthSpec& spec, const std::filesystem::path& folder, const Shard& shard,
                         const std::string& program, const ProgressFn& progress = {});

struct MergedSynth {
  std::string sceneJson;  ///< equal to that of one run, byte for byte
  int frames = 0, highlights = 0;
};
/// The scene file of all parts of one folder. Reads every file that the parts list.
/// @param sceneFile  FOLDER/scene.json, where it will be
/// @throw InputError (file, place): as readParts(), parts of another specification or folder, a file that is missing or not what its part says.
MergedSynth mergedSynth(const std::vector<std::string>& parts, const std::filesystem::path& sceneFile);

}  // namespace glint
