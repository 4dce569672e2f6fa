// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/write_png.h"

#include <QBuffer>
#include <QImageWriter>
#include <cmath>

#include "core/base/atomic_file.h"
#include "core/base/outcome.h"

namespace glint::gui {

void writePng(const QImage& picture, const QString& file, const QString& key, const QString& text) {
  // In memory first: Qt's own safe files leave a part beside the target when the program is killed.
  QBuffer bytes;
  bytes.open(QIODevice::WriteOnly);
  QImageWriter writer(&bytes, "png");
  if (!key.isEmpty()) writer.setText(key, text);
  if (!writer.write(picture))
    throw InputError(file.toStdString(), "", "cannot be written: " + writer.errorString().toStdString());
  atomicWrite(file.toStdString(), std::string_view(bytes.data().constData(), std::size_t(bytes.size())));
}

void setDpi(QImage& picture, int dpi) {
  const int perMetre = static_cast<int>(std::lround(dpi / 0.0254));
  picture.setDotsPerMeterX(perMetre);
  picture.setDotsPerMeterY(perMetre);
}

}  // namespace glint::gui
