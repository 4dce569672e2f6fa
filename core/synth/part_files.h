// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to this folder: the files of one shard beside those of the others.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/shard.h"

namespace glint {

/// The files of one shard in the folder of the whole, and its part.
class SynthPartFiles {
 public:
  /// @param names  relative to the folder
  /// @throw InputError (the file) where one exists already and neither scene.json nor a part says that synth wrote it
  SynthPartFiles(std::filesystem::path folder, const Shard& shard, std::vector<std::filesystem::path> names);
  const std::filesystem::path& file() const { return file_; }
  /// `make` writes all files into a temporary folder and returns the text of the part; then they are moved into the folder, the part first
  /// where there is none yet. Other shards may do so at the same time. When `make` throws, nothing stays.
  void write(const std::function<std::string(const std::filesystem::path& temporary)>& make) const;

 private:
  std::filesystem::path folder_, file_;
  std::vector<std::filesystem::path> names_;
};

/// What a part says of the scene.
struct SynthPartContent {
  std::string sceneText;                     ///< of all frames; those of the shard are kept
  std::filesystem::path specFile;            ///< hashed: all parts are of one specification
  double top = 0;                            ///< the brightest value that exposure and noise are taken from; 0 = they are given
  std::vector<std::filesystem::path> files;  ///< relative to `written`, hashed
  std::filesystem::path written;
};
std::string synthPartText(const SynthPartContent& content, const Shard& shard, const std::string& program, int first, int end);

}  // namespace glint
