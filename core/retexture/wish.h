// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/geometry/camera.h"
#include "core/retexture/retexture.h"

namespace glint {

/// What a person asks a program to retexture: names and files, before anything is read. Refusals name the command line's flags.
struct RetextureWish {
  std::string model = {};                     ///< id; "" = the one shown, else the richest of the request
  std::string shown = {};                     ///< the model that the session shows; "" = none
  std::string session = {};                   ///< for messages: what names the models
  std::string light = {};                     ///< id; "" = every light
  std::string texture = {}, background = {};  ///< files; exactly one of these, `picture` and `remove`
  bool remove = false;
  std::optional<Image> picture = {};  ///< in place of the file that `texture` or `background` then only names: linear, 3 channels
  std::string mapping = "natural", shading = "auto";
  double repeat = 1, albedo = 0, marginPx = 4;  ///< albedo 0: the texture's mean takes the place of it
};

/// InputError "--repeat" unless it is above 0 and at most 10,000.
void requireRepeat(double texturesInPlaceOfOne);
/// InputError if not exactly one of texture, background and removal is asked for, or a number is out of its range.
void requireAnswerable(const RetextureWish& wish);

/// A frame of which one model was asked.
struct RetexturedFrame {
  std::string model;
  Inspection inspection;  ///< of this frame and model alone
  Outcome<Retextured> result;
};

/// What is asked of this frame alone (Question::Part::Frame), and retexture(), as wished.
/// @param request   of the session: models, training frames, settings
/// @param previous  an inspection of the same scene, whose stages are taken over; null = none
/// Failures of both, the detail with model and frame. InputError: a model, light, mapping, shading or file that is missing or
/// not right; std::invalid_argument: a picture of another size; Stopped.
RetexturedFrame retextureAsWished(std::shared_ptr<const Scene> scene, InspectionRequest request, int frame,
                                  const RetextureWish& wish, const ProgressFn& progress = {},
                                  const Inspection* previous = nullptr);

/// A picture that a person gives, in linear light: 8- and 16-bit codes through the inverse sRGB curve (16 bits that say so are
/// linear), float as stored. 3 channels. Header, size and limits are checked before anything is decoded.
/// @param flag  for the message, "--texture".
/// InputError (file, flag): missing, damaged, beyond a limit, or values that are negative or not finite.
Image readTexture(const std::filesystem::path& file, const std::string& flag);

/// The same, of the size of the camera's frames; InputError names both sizes.
Image readBackground(const std::filesystem::path& file, const Camera& camera, const std::string& flag);

}  // namespace glint
