// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/outcome.h"
#include "core/scene/capture.h"
#include "core/scene/scene.h"

namespace glint {

/// One kind of input. A new kind is one class and one line in `sceneReaders`.
class SceneReader {
 public:
  virtual ~SceneReader() = default;
  /// The name that InputChoices::as gives it: "scene", "colmap"; "session".
  virtual std::string name() const = 0;
  /// For a person: "scene file (scene.json)".
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
/// A capture of another program; the reader lives as long as the program.
std::unique_ptr<const SceneReader> makeCaptureSceneReader(const CaptureReader& reader);

/// The scene of a capture: lengths in metres, a surface, ids of frames (the image's name without folder and ending; with the
/// folder where names repeat). InputError where no surface, or more than one, is named or found, or a choice does not fit the
/// capture.
///
/// The surface is `choices.surfaceFile`, else the mesh that the capture names, else the only mesh in its folder (`mesh.*` before
/// others; a PLY without faces does not count), else the frames' own depth maps.
Scene sceneOfCapture(const Capture& capture, const ReadOptions& options);

/// The options with which a capture is read.
CaptureOptions captureOptionsOf(const ReadOptions& options);
/// The same for a scene that was read: for its sparse points.
CaptureOptions captureOptionsOf(const Scene& scene);

/// Nothing in a folder is recognised, but a folder inside it is: a person who is one level too high can be led there.
class FolderBelow : public InputError {
 public:
  /// @param folder  inside `input`. @param what  "COLMAP model"
  FolderBelow(const std::string& input, const std::string& reason, std::filesystem::path folder, std::string what)
      : InputError(input, "", reason), folder_(std::move(folder)), what_(std::move(what)) {}
  const std::filesystem::path& folder() const { return folder_; }
  const std::string& holds() const { return what_; }

 private:
  std::filesystem::path folder_;
  std::string what_;
};

}  // namespace glint
