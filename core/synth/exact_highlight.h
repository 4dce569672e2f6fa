// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/outcome.h"
#include "core/highlight/highlight.h"
#include "core/synth/light_source.h"

namespace glint {

/// Which curve is called the highlight's contour.
enum class ContourKind {
  Radiance,    ///< level set of the specular radiance at `level` of its strongest peak in the frame; the peak is its maximum
  LimitAngle,  ///< level set alpha = limitAngle; the peak is the mirror point. For lights that are points.
};

struct ExactOptions {
  ContourKind kind = ContourKind::Radiance;
  double level = 0.5;
  double limitAngle = 0.1;  ///< rad
  double sagittaPx = 2e-3;  ///< the polyline's chords stay this close to the curve
  double marginPx = 0;      ///< contours and peaks are followed this far beyond the image's outermost pixel centres
};

/// Contours and peaks of one light in one frame, traced on the analytic field itself, not on pixels; ideal pixels, strongest
/// first. Vertices lie on the level set to 1e-9 px, peaks to about 1e-7 px (the finite differences of their Newton steps).
/// A contour cut by the image or by the end of the surface runs along that border (`touchesBorder` for the image's border,
/// `marginPx` beyond it). `peakValue` is the specular radiance for unit intensity (0 for LimitAngle).
/// @return NoHighlight when nothing is lit and visible; NotSupported for LimitAngle with a tube or a sphere of non-zero radius.
Outcome<std::vector<Highlight>> exactHighlights(const Surface& surface, const Camera& camera, const TrueLight& light,
                                                const Material& material, const ExactOptions& options);

}  // namespace glint
