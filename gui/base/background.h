// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QThread>

namespace glint::gui {

/// Starts a thread that computes, so that the interface and what draws for it (without a graphics card: as many threads as the
/// machine has cores) go first where there are fewer cores than threads. The threads that it starts are ranked as it is.
void startInBackground(QThread& thread);

}  // namespace glint::gui
