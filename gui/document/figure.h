// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QImage>
#include <QString>

#include "gui/document/engine.h"

namespace glint::gui {

/// A PNG with the session inside (text under the key "glint-session"), so that opening the picture opens what it shows. The
/// session's paths are relative to the picture's folder. Atomic. InputError if it cannot be written.
void writeFigure(const QImage& picture, const Opened& state, const Engine& engine, const QString& file);
/// The session inside a picture; "" if it holds none.
QString sessionInFigure(const QString& picture);

}  // namespace glint::gui
