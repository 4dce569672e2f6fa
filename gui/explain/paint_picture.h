// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QFont>

#include "viz/drawn_picture.h"

class QPainter;

namespace glint::gui {

/// Strokes, dots and texts of a picture that viz describes, in the painter's px.
void paintPicture(QPainter& painter, const viz::DrawnPicture& picture, const QFont& font);

}  // namespace glint::gui
