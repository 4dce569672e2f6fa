// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QImage>
#include <QString>

namespace glint::gui {

/// A PNG, whole or not at all (atomicWrite). @param key, text  what is kept inside under a key; none if empty. InputError.
void writePng(const QImage& picture, const QString& file, const QString& key = {}, const QString& text = {});

/// How large it is on paper: px per inch, which the file keeps.
void setDpi(QImage& picture, int dpi);

}  // namespace glint::gui
