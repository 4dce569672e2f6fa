// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "viz/frame_overlay.h"
#include "viz/style.h"

class vtkContext2D;
class vtkPen;
class vtkTextProperty;

namespace glint::viz {

// How a plot's texts and strokes are set: sizes in screen px, opacities 0..1.

void setText(vtkTextProperty* text, double size, const Colour& colour, bool bold = false);
/// For the painter's own strings; an axis places its labels itself.
void setPainterText(vtkContext2D* painter, double size, const Colour& colour, bool bold = false);
/// Of VTK's pens.
int lineType(Dash dash);
void setPen(vtkPen* pen, const Colour& colour, double width, double opacity = 1);
void setBrush(vtkContext2D* painter, const Colour& colour, double opacity = 1);

/// The title of an axis; where that is too long, as many of its last words and its unit as fit: the unit stays longest. "" where
/// not even that fits, or there is no unit.
std::string fitting(const std::string& title, const std::function<bool(const std::string&)>& fits);
/// "a long sentence" in lines of at most `letters`.
std::string wrapped(const std::string& sentence, int letters);

}  // namespace glint::viz
