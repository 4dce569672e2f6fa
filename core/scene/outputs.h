// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace glint {

/// What a file that a program writes holds.
class OutputKind {
 public:
  static OutputKind document(const std::string& key);  ///< JSON with this key at its top, "glint_scene"
  static OutputKind table(const std::string& start);   ///< text that begins like this
  static OutputKind page();                            ///< HTML of this program
  static OutputKind png();
  static OutputKind movie();
  static OutputKind lightPositions();  ///< .lp: a count, then as many lines

  /// Whether the file may be replaced by one of this kind: empty, or of this kind.
  bool holds(const std::filesystem::path& file) const;
  /// Whether a file of this name may hold it: the ending of another format would be wrong.
  bool mayBeNamed(const std::filesystem::path& file) const;
  const std::string& words() const { return words_; }
  const std::vector<std::string>& endings() const { return endings_; }

 private:
  enum class Form { Document, Table, Page, Png, Movie, LightPositions };
  OutputKind(Form form, std::string key, std::string words, std::vector<std::string> endings)
      : form_(form), key_(std::move(key)), words_(std::move(words)), endings_(std::move(endings)) {}
  Form form_;
  std::string key_, words_;
  std::vector<std::string> endings_;  ///< with their dot, lower case; empty = any
};

/// The files that a program was asked to write, checked before it computes: each is new, or of the kind that it writes; its
/// ending is one of that kind; none is a file of the input; no two are the same. "-", devices and pipes pass.
class Outputs {
 public:
  /// @param input  as given on the command line: a file or folder
  Outputs(const std::string& input, const Scene& scene);
  explicit Outputs(const std::vector<std::filesystem::path>& inputs);

  /// InputError (file, flag). An empty `file` was not asked for.
  void file(const std::string& file, const std::string& flag, const OutputKind& kind);
  /// Files with these names in a folder: where one of them exists, the folder must hold `marker`, a document of this kind, so
  /// that an earlier run wrote them.
  void inFolder(const std::string& folder, const std::string& flag, const std::vector<std::string>& names,
                const std::string& marker, const std::string& documentKey);

 private:
  void requireNoInput(const std::filesystem::path& file, const std::string& flag) const;
  std::vector<std::filesystem::path> inputs_;
  std::vector<std::filesystem::path> asked_;
};

/// The name of a frame's picture: its id, with what no file name may hold replaced, the part, ".png". "0012.png",
/// "0012_diffuse.png".
std::string pictureName(const Frame& frame, const std::string& part = "");
/// The names for these frames.
std::vector<std::string> picturesOf(const Scene& scene, const std::vector<int>& frames);

/// Cameras of a scene for another program, ready to be written.
struct Exported {
  std::vector<std::string> leftOut;  ///< what the other format cannot hold, one line each
  std::function<void()> write;       ///< InputError where a file exists already, a lens is not supported or the disk fails
};

/// nerfstudio's transforms.json: paths relative to its folder; depth maps and masks too, where nerfstudio reads them.
Exported transformsOf(const Scene& scene, const std::filesystem::path& file);
/// COLMAP's text model. Names of images are relative to `images/` of the project's root (the folder, or the one above `sparse` or
/// `sparse/0`), or to that root.
Exported colmapOf(const Scene& scene, const std::filesystem::path& folder);

}  // namespace glint
