// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace glint {

/// One kind of input. A new kind is one class and one line in `sceneReaders`.
class SceneReader {
 public:
  virtual ~SceneReader() = default;
  /// For a person: "scene file (scene.json, version 1)".
  virtual std::string describe() const = 0;
  /// The file to read when this reader understands `input` (a file, or a folder in which it looks), by content;
  /// an empty path otherwise. Never throws for an unreadable input.
  virtual std::filesystem::path recognise(const std::filesystem::path& input) const = 0;
  /// Reads what `recognise` returned. InputError with file, place and reason.
  virtual Scene read(const std::filesystem::path& file, const ReadOptions& options) const = 0;
};

/// All readers, in the order in which they are asked.
const std::vector<std::unique_ptr<const SceneReader>>& sceneReaders();

std::unique_ptr<const SceneReader> makeSceneFileReader();     ///< scene.json
std::unique_ptr<const SceneReader> makeSessionSceneReader();  ///< the scene that a session *.glint refers to

/// The file that `key` of a document in `folder` names. `relative` is taken relative to the folder; the result is absolute
/// and lexically normal, and may not exist.
/// @throw InputError (file, place) when it is empty; OutsidePath when it is absolute or leaves the folder (by `..` or through a symbolic
///        link), unless it lies in one of `options.folders` or `options.allowOutsidePaths` is true.
std::filesystem::path resolveInside(const std::filesystem::path& folder, const std::string& relative, const ReadOptions& options,
                                    const std::string& file, const std::string& place);

/// The first `n` bytes of a file; "" when it cannot be read. For recognising contents.
std::string firstBytes(const std::filesystem::path& file, std::size_t n);

}  // namespace glint
