// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "gui/document/document.h"

namespace glint::gui {

/// What the 3D view can draw of a scene before anything is computed: its cameras with their roles and true lights, and its
/// surfaces where no file has to be read for them. Null while there is no scene, and where a what-if changes it: then the results
/// for one frame are the first that show it.
std::shared_ptr<const Inspection> knownBeforeResults(const Document& document);

}  // namespace glint::gui
