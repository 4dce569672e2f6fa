// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "tests/fuzz/mutator.h"

namespace glint::fuzz {

/// One reader of files that come from others. `feed` returns whether the bytes were read; false = refused as such bytes shall be.
/// Everything else is a finding: it throws Finding, or something that no reader may throw, or the process dies.
struct Reader {
  std::string name;  ///< also of its folder in tests/fuzz/corpus
  Form form;
  bool (*feed)(const std::string& bytes);
};
const std::vector<Reader>& readers();
/// Null for an unknown name.
const Reader* readerOf(const std::string& name);

struct Finding {
  std::string what;
};

// One function for each, by the file that holds it.
bool feedScene(const std::string& bytes);  // scene_fuzz.cpp
bool feedSession(const std::string& bytes);
bool feedSynth(const std::string& bytes);
bool feedTruth(const std::string& bytes);
bool feedWorkFile(const std::string& bytes);  // request_fuzz.cpp
bool feedSettings(const std::string& bytes);
bool feedTrain(const std::string& bytes);
bool feedPly(const std::string& bytes);  // mesh_fuzz.cpp
bool feedObj(const std::string& bytes);
bool feedStl(const std::string& bytes);
bool feedGltf(const std::string& bytes);
bool feedGlb(const std::string& bytes);
bool feedPcd(const std::string& bytes);
bool feedPlyCloud(const std::string& bytes);
bool feedColmapCameras(const std::string& bytes);  // capture_fuzz.cpp
bool feedColmapImages(const std::string& bytes);
bool feedColmapPoints(const std::string& bytes);
bool feedColmapText(const std::string& bytes);
bool feedNvm(const std::string& bytes);
bool feedTransforms(const std::string& bytes);
bool feedBundle(const std::string& bytes);
bool feedTum(const std::string& bytes);
bool feedBop(const std::string& bytes);
bool feedPosedImages(const std::string& bytes);
bool feedPoses(const std::string& bytes);  // live_fuzz.cpp
bool feedLabels(const std::string& bytes);
bool feedResponse(const std::string& bytes);     // response_fuzz.cpp
bool feedImageHeader(const std::string& bytes);  // image_fuzz.cpp
bool feedImage(const std::string& bytes);

/// Checks what every refusal promises: one line that a person may see, with the file's name in it when `file` is not empty.
void checkRefusal(const std::exception& e, const std::string& file);

}  // namespace glint::fuzz
