// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>

#include "gui/document/document.h"
#include "viz/hidden_objects.h"

namespace glint::gui {

/// The objects that the 3D views leave out are an option of the document, "scene/hidden": one object a line, "camera ID",
/// "surface KEY", "light ID", "ellipsoid MODEL LIGHT". Cameras that the scene does not have are left out of the answer.
viz::HiddenObjects hiddenObjects(const Document& document);
/// One step of undo. @param text  what it is called.
void setHiddenObjects(Document& document, const viz::HiddenObjects& hidden, const QString& text);

}  // namespace glint::gui
