// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry/camera.h"

namespace glint {

/// One photograph to write for another program.
struct PosedImage {
  std::string name;   ///< of the image relative to the file's folder (transforms.json) or to the folder of images (COLMAP)
  Camera camera;      ///< with pose, our conventions
  std::string depth;  ///< transforms.json only: relative path of a 16-bit depth map in millimetres; "" = none
  std::string mask;   ///< transforms.json only; "" = none
};

/// nerfstudio's transforms.json, with 17 digits. InputError (file, place frames[i]) for skew or a lens that nerfstudio lacks.
/// @param points  relative path of a point cloud; "" = none
void writeTransforms(const std::vector<PosedImage>& images, const std::filesystem::path& file, const std::string& points = "");

/// COLMAP's text model (cameras.txt, images.txt, points3D.txt without points) in a folder, with 17 digits, whole or not at all.
/// Cameras that are equal become one. InputError (folder, name of the image) for skew or VISUALSFM's lens, which COLMAP lacks.
void writeColmapText(const std::vector<PosedImage>& images, const std::filesystem::path& folder);

}  // namespace glint
