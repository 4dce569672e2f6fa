// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/to_qimage.h"

namespace glint::gui {

namespace {
uchar byte(float v) { return v >= 1.f ? 255 : v > 0.f ? uchar(v * 255.f + 0.5f) : 0; }
}  // namespace

QImage toQImage(const Image& image) {
  if (image.channels == 4) {
    QImage out(image.width, image.height, QImage::Format_RGBA8888);
    for (int y = 0; y < image.height; ++y) {
      uchar* line = out.scanLine(y);
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 4; ++c) *line++ = byte(image.at(x, y, c));
    }
    return out;
  }
  QImage out(image.width, image.height, QImage::Format_RGB888);
  const int green = image.channels >= 3 ? 1 : 0, blue = image.channels >= 3 ? 2 : 0;
  for (int y = 0; y < image.height; ++y) {
    uchar* line = out.scanLine(y);
    for (int x = 0; x < image.width; ++x, line += 3) {
      line[0] = byte(image.at(x, y, 0));
      line[1] = byte(image.at(x, y, green));
      line[2] = byte(image.at(x, y, blue));
    }
  }
  return out;
}

}  // namespace glint::gui
