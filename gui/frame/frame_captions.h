// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QPalette>
#include <QString>

#include "core/draw/frame_overlay.h"
#include "gui/document/document.h"

namespace glint::gui {

inline constexpr char kModelLayer[] = "frame/model/";  ///< and the model: the layer of its lines

/// The text below the photograph, as rich text: notes, a table with one row per model ("show:MODEL" and "select:MODEL" are its
/// links), and the reasons of failures.
struct FrameCaptions {
  QString html;      ///< "" for none
  int failures = 0;  ///< how many it gives the reason of
  QString tip;       ///< why models are poor; "" = none is
};
/// @param earlier  the errors are of an earlier state than what is asked for: faded, and the heading says so
FrameCaptions frameCaptions(const Document& document, const draw::FrameOverlay& overlay, const QPalette& palette, bool earlier);
/// The errors of the last results stay in sight until new ones follow; a new contour has none yet.
void keepErrors(const draw::FrameOverlay& results, draw::FrameOverlay& shown);
/// In place of a photograph that cannot be read. @param reason  may have the scene's folder in it
QString unreadableText(const Scene& scene, int frame, const QString& reason);

}  // namespace glint::gui
