// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/json_text.h"
#include "core/geometry/camera.h"
#include "core/scene/camera_response.h"

namespace glint {

/// What the files of other programs do not say about themselves: how to read them (docs/formats.md, "Captures of other
/// programs"). From the command line or the inspector; sessions keep it. A scene file says everything itself.
struct InputChoices {
  std::string as;  ///< which reading of several is meant: "colmap", "scene", ...; "" = the only one
  enum class Surface { Default, File, Depth, Points } surface = Surface::Default;
  std::filesystem::path surfaceFile;           ///< of Surface::File; absolute
  std::vector<double> camera;                  ///< fx, fy, cx, cy [, k1, k2, p1, p2, k3] (our pixels); empty = not given
  std::string object;                          ///< BOP: number of the object; "" = the only one
  std::optional<double> metresPerUnit;         ///< of poses and points; nothing = what the program says, else 1
  std::optional<double> surfaceMetresPerUnit;  ///< of the mesh; nothing = as the poses
  std::optional<double> depthScale;            ///< metres per stored unit of depth maps; nothing = what the program says
  std::string world;                           ///< nerfstudio: "original" = before applied_transform; "" = as stored
  std::filesystem::path poses;                 ///< of a folder of images or a video: TUM or JSON lines; absolute; "" = none
  bool posesByOrder = false;                   ///< the n-th pose is that of the n-th picture; only because a person says so
  std::string
      response;  ///< of the images: as CameraResponse::named() takes it, or the absolute path of a file; "" = by file type
  bool none() const { return *this == InputChoices{}; }
  friend bool operator==(const InputChoices&, const InputChoices&) = default;
};

/// An option of both programs that sets one of them.
struct ChoiceOption {
  const char* flag;   ///< "--surface"
  const char* value;  ///< "FILE|depth"
  const char* help;
  /// InputError (place: flag and text).
  void (*set)(InputChoices& choices, const std::string& text);
  /// The text that `set` would need; "" = not set.
  std::string (*textOf)(const InputChoices& choices);
};
const std::vector<ChoiceOption>& choiceOptions();

/// Metres of "m", "cm", "mm" or a number above 0. InputError (place: the option) for another text.
double metresOfUnit(const std::string& unit, const std::string& option);
/// "m", "cm" or "mm" for 1, 0.01 or 0.001; another number as text with all its digits.
std::string unitOfMetres(double metres);

/// The numbers of "fx,fy,cx,cy[,k1,k2,p1,p2,k3]". InputError (place: the option).
std::vector<double> cameraNumbers(const std::string& text, const std::string& option);
/// Intrinsics of these numbers, without a size. @pre as cameraNumbers returns them
Camera cameraOfNumbers(const std::vector<double>& numbers);

/// The response of this text. InputError (place: the option), also where the file that it names is not a response.
CameraResponse responseOf(const InputChoices& choices);
/// The file that it names; "" = none.
std::filesystem::path responseFileOf(const InputChoices& choices);

/// `input.reading` of a session. @param folder  of the session, absolute: paths are relative to it. InputError.
InputChoices readInputChoices(const JsonNode& node, const std::filesystem::path& folder);

}  // namespace glint
