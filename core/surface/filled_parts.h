// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/surface/surface.h"

namespace glint {

/// A surface that was not measured everywhere: holes in its depth were filled, so that contours can cross them.
class FilledParts {
 public:
  virtual ~FilledParts() = default;
  /// Whether the point lies on what was filled: a contour may pass there, but it is no evidence of where a peak is.
  virtual bool filledAt(const SurfacePoint& p) const = 0;
};

}  // namespace glint
