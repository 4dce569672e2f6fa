// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/pixel_probe.h"

#include <cmath>
#include <optional>
#include <utility>

#include "core/base/numeric.h"
#include "gui/base/decoded_frames.h"
#include "gui/base/text.h"
#include "viz/develop.h"

namespace glint::gui {

struct PixelProbeWorker::Images {
  FramePictures of;
  int frame = -1;
  DecodedFrames::Held photograph, radiance;  // null without such a file
};

PixelProbeWorker::PixelProbeWorker(QObject* parent) : QObject(parent), images_(std::make_shared<Images>()) {}

void PixelProbeWorker::want(std::shared_ptr<const Scene> scene, std::shared_ptr<const Inspection> inspection, int frame,
                            const Pixel& at) {
  if (!scene || frame < 0 || frame >= int(scene->frames.size())) return;
  const auto work = [this, frame, at, scene = std::move(scene), inspection = std::move(inspection), images = images_] {
    FramePictures pictures{scene};
    pictures.follow(inspection);
    if (!(images->of == pictures) || images->frame != frame) {
      *images = {};  // until all of it is read
      const auto read = [&](FrameSource source, bool there) {
        const Outcome<DecodedFrames::Held> image =
            there ? decodedFrames().part(pictures, frame, source, 1) : DecodedFrames::Held();
        return image ? *image : nullptr;
      };
      const Frame& f = pictures.frame(frame);
      const bool synthesised = pictures.synthesis != nullptr;
      images->photograph = read(FrameSource::Image, !synthesised && !f.image.empty());
      images->radiance = read(FrameSource::Radiance, synthesised || !f.radiance.empty());
      images->frame = frame;
      pictures.synthesis.reset();  // large, and only compared by its key
      images->of = std::move(pictures);
    }
    const int x = int(std::lround(at.x())), y = int(std::lround(at.y()));
    QStringList values;
    if (images->photograph) values << toQString(viz::valueText(*images->photograph, viz::Values::Srgb, x, y));
    if (images->radiance) values << toQString(viz::valueText(*images->radiance, viz::Values::Linear, x, y));
    const std::optional<Outcome<PixelProbe>> probe =
        inspection ? std::optional(probePixel(*inspection, frame, at)) : std::nullopt;
    const QString text = probeText(at, values.join(QStringLiteral("   ")), probe ? &*probe : nullptr);
    return LatestJob::Deliver([this, text] { emit probed(text); });
  };
  job_.run(work, [this](const QString& failure) { emit probed(failure); });
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
