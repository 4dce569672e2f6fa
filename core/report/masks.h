// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/pipeline/inspection.h"

namespace glint {

/// The pixels of highlights in the captured image: 1 channel, 255 where the pixel's centre lies inside a contour, else 0.
/// @param contours  closed, ideal pixels; lens distortion is put back. Contours with fewer than 3 finite points hold no pixel.
Image maskOf(const std::vector<Polyline>& contours, const Camera& camera);

/// What a folder of labels holds.
struct LabelFormats {
  bool coco = true, masks = true, yolo = false;
};
/// "coco,masks,yolo", in any order. InputError (--labels) for another word, or none.
LabelFormats labelFormatsFrom(const std::string& list);

/// The labels of an inspection as a folder:
///   masks/observed/LIGHT/0007.png  and  masks/MODEL/LIGHT/0007.png    one 8-bit mask per frame (by its id) and light, all 0
///                                                                      where there is no highlight
///   masks.json      keys: glint_masks 1, scene, masks[]: frame, id, light, of ("observed" or the model), file, pixels, reason
///   labels_MODEL.json                                                  COCO, see `cocoJson`
///   yolo/MODEL/                                                        see `writeYolo`
/// Observed means what predictions are compared with. A light's folder is its id, with what no file name may hold replaced.
/// Whole or not at all. InputError, see `atomicFolder`; Stopped.
/// @param frames  which are labelled; none = all
void writeLabels(const Inspection& inspection, const std::filesystem::path& folder, const ProgressFn& progress = {},
                 const LabelFormats& formats = {}, const std::vector<int>& frames = {});

}  // namespace glint
