// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include "core/base/image.h"

namespace glint {

/// Diffuse light of a part of a frame, as other views of the same surface show it: what lies under its highlights.
struct DiffuseLight {
  int left = 0, top = 0;  ///< measured pixel of the first value
  Image value;            ///< one channel, linear, the mean of the photograph's channels; not finite where it is unknown

  float at(int x, int y) const {
    const int column = x - left, row = y - top;
    const bool inside = column >= 0 && row >= 0 && column < value.width && row < value.height;
    return inside ? value.at(column, row) : std::numeric_limits<float>::quiet_NaN();
  }
};

/// Takes the light off a frame's values. Where it is unknown they become 0, and are no longer usable.
/// @return  how many still are
int takeOff(const DiffuseLight& under, Image& value, std::vector<char>& usable);

/// What a picture shows beside smooth shading: the distance of its pixels from a copy that is smoothed over a few of them,
/// exceeded by a fifth of the usable pixels. Print and wood have it all over; highlights and silhouettes cover less than a
/// fifth.
struct FineStructure {
  double amount = 0;  ///< in the picture's values, the share that noise explains taken off
  double top = 0;     ///< the value that one usable pixel in 200 exceeds

  /// More than a smooth background under a highlight follows.
  bool isTexture() const;
};
/// @param image   one channel, linear. @param usable  one per pixel: on the object, finite
FineStructure fineStructure(const Image& image, const std::vector<char>& usable);

}  // namespace glint
