// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/readers.h"

#include <algorithm>
#include <exception>

#include "core/base/safe_text.h"

namespace glint::fuzz {

const std::vector<Reader>& readers() {
  static const std::vector<Reader> all = {
      {"scene", Form::Json, feedScene},
      {"session", Form::Json, feedSession},
      {"synth", Form::Json, feedSynth},
      {"truth", Form::Json, feedTruth},
      {"work_file", Form::Json, feedWorkFile},
      {"settings", Form::Text, feedSettings},
      {"train", Form::Text, feedTrain},
      {"ply", Form::Text, feedPly},
      {"obj", Form::Text, feedObj},
      {"stl", Form::Text, feedStl},
      {"gltf", Form::Json, feedGltf},
      {"glb", Form::Bytes, feedGlb},
      {"pcd", Form::Bytes, feedPcd},
      {"ply_cloud", Form::Text, feedPlyCloud},
      {"colmap_cameras", Form::Bytes, feedColmapCameras},
      {"colmap_images", Form::Bytes, feedColmapImages},
      {"colmap_points", Form::Bytes, feedColmapPoints},
      {"colmap_text", Form::Text, feedColmapText},
      {"nvm", Form::Text, feedNvm},
      {"transforms", Form::Json, feedTransforms},
      {"bundle", Form::Text, feedBundle},
      {"tum", Form::Text, feedTum},
      {"bop", Form::Json, feedBop},
      {"poses", Form::Text, feedPoses},
      {"labels", Form::Json, feedLabels},
      {"posed_images", Form::Text, feedPosedImages},
      {"response", Form::Text, feedResponse},
      {"image_header", Form::Bytes, feedImageHeader},
      {"image", Form::Bytes, feedImage},
  };
  return all;
}

const Reader* readerOf(const std::string& name) {
  const auto found = std::find_if(readers().begin(), readers().end(), [&](const Reader& r) { return r.name == name; });
  return found == readers().end() ? nullptr : &*found;
}

void checkRefusal(const std::exception& e, const std::string& file) {
  const std::string line = messageLine(e.what());
  if (line.empty()) throw Finding{"a refusal without words"};
  if (line.size() > kLongestMessage) throw Finding{"a message of " + std::to_string(line.size()) + " bytes"};
  if (line.find('\n') != std::string::npos || withoutControls(line) != line)
    throw Finding{"a message that is not one plain line: " + line};
  if (line.find(file) == std::string::npos) throw Finding{"a message without the file's name: " + line};
}

}  // namespace glint::fuzz
