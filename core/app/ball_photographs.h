// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/app/lamp_fit.h"
#include "core/base/progress.h"
#include "core/scene/camera_response.h"

namespace glint {

/// A ball as a person names it: "[DIR:]CX,CY,R[@X0,Y0]".
struct NamedBall {
  std::string text;                                  ///< as typed
  std::string folder;                                ///< of its photographs; "" = that of all
  BallOutline outline;                               ///< in pixels of the shot: the corner is in it
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< of its photographs in the shot
};
/// InputError (place "--ball TEXT").
NamedBall namedBall(const std::string& text);

/// Which outlines count: fitted to the photographs' edges and to the highlights of several balls; to the edges alone; as typed.
enum class Outlines { Fitted, Edges, Given };

/// One shot: photographs with one file name, one for each ball where it was cut out of the shot.
struct Shot {
  std::string name;                          ///< of the files, with ending
  std::string id;                            ///< without ending; with it where two shots would have one id
  std::vector<std::filesystem::path> files;  ///< of each ball; empty = this ball has none
};

/// Balls and shots, before any picture is read.
struct BallShots {
  std::vector<NamedBall> balls;
  std::vector<Shot> shots;  ///< by name
  CameraResponse response;  ///< of all photographs
  /// Folders beside those of the balls with photographs of the same names: those of another ball without an outline.
  std::vector<std::string> leftOut;
  std::vector<std::filesystem::path> files() const;
};

/// The photographs in the folders that the balls name, by the endings of their names; `input` where a ball names none. A folder
/// is looked for as named, and in `input`.
/// @param exclude  a frame SPEC over the shots' ids; "" = none
/// InputError: a folder is missing, has no photographs or could be two; a ball is named twice; `exclude`.
BallShots ballShotsIn(const std::filesystem::path& input, const std::vector<NamedBall>& balls, const std::string& exclude);

/// What EXIF data of whole shots say of the camera: the focal length; the principal point is taken in the middle, the lens as
/// ideal. Nothing if a ball was cut out, where the first shot says nothing, or if the last one says something else.
/// @param mm  becomes the focal length on 35 mm film
std::optional<Camera> cameraOfExif(const BallShots& shots, double& mm);

struct PhotographLamps {
  BallLamps fit;                       ///< lamps in the order of the shots, each with its id
  std::vector<std::string> fileNames;  ///< of each lamp: the shot's
  std::vector<std::string> warnings;
};

/// Outlines, highlights and lamps of all shots. A shot that cannot be read or shows no highlight is a lamp without an answer.
/// @param camera,focalAlone  see BallPhotographs
/// @param givenSigmaPx  of centre and radius of an outline that is taken as typed
/// @throw InputError if a ball lies outside of its photographs; Stopped
/// @return  no answers if no shot shows a highlight. FrameUnreadable if no shot can be read; failures of fitBallLamps()
Outcome<PhotographLamps> lampsOfShots(const BallShots& shots, const std::optional<Camera>& camera, bool focalAlone,
                                      const std::optional<double>& ballRadius, Outlines outlines, double givenSigmaPx,
                                      const ProgressFn& progress);

/// Whether highlights are so wide that the middle of one is not its mirror point: a rough ball, no mirror.
bool showsLobes(const std::vector<LampObservation>& seen, const BallOutline& ball);

/// Refines the lamps of one rough ball by its lobe: fits every lamp in a scene with a sphere, as lampsOfScene()
/// does. A lamp takes the new direction if the model explains its highlight without doubt and agrees with the mirrored ray.
/// @param shots   with one ball. @param width,height  of its photographs
/// @param camera  see BallPhotographs; none: a camera so far away that its rays are parallel
/// @param lamps   of fitBallLamps(), in the order of the shots
void refineByLobe(const BallShots& shots, int width, int height, const std::optional<Camera>& camera, BallLamps& lamps,
                  const ProgressFn& progress);

}  // namespace glint
