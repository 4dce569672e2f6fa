// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>

class vtkRenderWindow;

namespace glint::viz {

/// VTK's FreeType tools are one instance with caches of its own and no lock, and pictures are drawn by several threads (a movie
/// in the background, the 3D views in the window). Hold it while VTK draws or measures text.
std::recursive_mutex& textMutex();

/// vtkRenderWindow::Render with that lock: the texts of a scene are drawn in it.
void render(vtkRenderWindow* window);

}  // namespace glint::viz
