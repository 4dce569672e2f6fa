// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/pixel_probe.h"

#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "core/base/angle.h"
#include "core/pipeline/photograph.h"
#include "gui/base/text.h"
#include "viz/develop.h"

namespace glint::gui {

struct PixelProbeWorker::Images {
  std::shared_ptr<const Scene> scene;
  int frame = -1;
  std::string key;  // of synthesised pictures
  std::optional<Image> photograph, radiance;
};

PixelProbeWorker::PixelProbeWorker(QObject* parent) : QObject(parent), images_(std::make_shared<Images>()) {}

void PixelProbeWorker::want(std::shared_ptr<const Scene> scene, std::shared_ptr<const Inspection> inspection, int frame,
                            const Pixel& at) {
  if (!scene || frame < 0 || frame >= int(scene->frames.size())) return;
  job_.run([this, frame, at, scene = std::move(scene), inspection = std::move(inspection), images = images_] {
    QString text;
    try {
      const Frame& f = scene->frames[std::size_t(frame)];
      const bool synthesised = inspection && picturesAreSynthesised(*inspection);
      const std::string key = synthesised ? pictureKey(*inspection) : "";
      if (images->scene != scene || images->frame != frame || images->key != key) {
        *images = {scene, frame, key, {}, {}};
        if (synthesised) {
          if (Outcome<Image> image = linearImageOf(*inspection, frame, FrameSource::Radiance))
            images->radiance = std::move(*image);
        } else if (!f.image.empty()) {
          if (Outcome<Image> image = readPhotograph(f)) images->photograph = std::move(*image);
        }
        if (!synthesised && !f.radiance.empty())
          if (Outcome<Image> image = readLinear(f, FrameSource::Radiance)) images->radiance = std::move(*image);
      }
      const int x = int(std::lround(at.x())), y = int(std::lround(at.y()));
      QStringList values;
      if (images->photograph) values << toQString(viz::valueText(*images->photograph, viz::Values::Srgb, x, y));
      if (images->radiance) values << toQString(viz::valueText(*images->radiance, viz::Values::Linear, x, y));
      const std::optional<Outcome<PixelProbe>> probe =
          inspection ? std::optional(probePixel(*inspection, frame, at)) : std::nullopt;
      text = probeText(at, values.join(QStringLiteral("   ")), probe ? &*probe : nullptr);
    } catch (const std::exception& e) {
      text = toQString(e.what());
    }
    return LatestJob::Deliver([this, text] { emit probed(text); });
  });
}

QString probeText(const Pixel& at, const QString& values, const Outcome<PixelProbe>* probe) {
  QString text = PixelProbeWorker::tr("x %1  y %2").arg(at.x(), 0, 'f', 2).arg(at.y(), 0, 'f', 2);
  if (!values.isEmpty()) text += QStringLiteral("   ") + values;
  if (!probe) return text;
  if (!*probe) return text + QStringLiteral("   ") + toQString((*probe).failure().message());
  const PixelProbe& p = **probe;
  text += PixelProbeWorker::tr("   depth %1 m   N (%2, %3, %4)")
              .arg(p.depth, 0, 'g', 5)
              .arg(p.point.normal.x(), 0, 'f', 3)
              .arg(p.point.normal.y(), 0, 'f', 3)
              .arg(p.point.normal.z(), 0, 'f', 3);
  for (const PixelProbe::Incidence& incidence : p.lights) {
    text += QStringLiteral("   α");
    if (p.lights.size() > 1) text += QStringLiteral(" ") + nameText(incidence.light);
    text += QStringLiteral(" ") + (incidence.alpha ? QString::number(degrees(*incidence.alpha), 'f', 3) + QChar(0xb0)
                                                   : PixelProbeWorker::tr("light behind"));
  }
  return text;
}

}  // namespace glint::gui
