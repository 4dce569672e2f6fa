// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QImage>

#include "core/base/image.h"

namespace glint::gui {

/// 8-bit copy of a display image (sRGB 0..1, 1 or 3 channels, or 4 with opacity); values outside are clamped, NaN is 0.
QImage toQImage(const Image& image);

}  // namespace glint::gui
