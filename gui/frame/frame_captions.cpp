// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/frame_captions.h"

#include <QColor>
#include <QObject>
#include <QStringList>
#include <algorithm>
#include <iterator>

#include "core/base/number_text.h"
#include "core/scene/scene_files.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"

namespace glint::gui {

namespace {
QString cell(const QString& text, const char* align = "right") {
  return QStringLiteral("<td align='%1' style='padding-right:16px; white-space:nowrap'>%2</td>").arg(QLatin1String(align), text);
}
}  // namespace

FrameCaptions frameCaptions(const Document& document, const draw::FrameOverlay& overlay, const QPalette& palette, bool earlier) {
  const QString faded = palette.color(QPalette::PlaceholderText).name(), warning = warningColour().name();
  const QString plain = earlier ? faded : palette.color(QPalette::Text).name();
  const auto error = [&](const std::optional<double>& value) {
    return cell(value ? toQString(errorText(*value)) : QStringLiteral("–"));
  };
  const auto share = [&](const std::optional<double>& value) {
    return cell(value ? QString::number(*value, 'f', 3) : QStringLiteral("–"));
  };
  const auto link = [](const QString& target, const QString& colour, const QString& text) {
    return QStringLiteral("<a href='%1' style='color:%2; text-decoration:none'>%3</a>").arg(target, colour, text);
  };
  QString rows, reasons, poor;
  int failures = 0;
  QString problems, lobes;
  for (const draw::OverlayCaption& c : overlay.captions) {
    if (c.model.empty()) {
      const QString text = toQString(c.text).toHtmlEscaped();
      if (c.problem)
        problems += QStringLiteral("<div style='color:%1'>%2</div>").arg(warning, text);
      else
        lobes += QStringLiteral("<div><span style='color:%1'>■</span>&nbsp;%2</div>").arg(toQColor(c.colour).name(), text);
      continue;
    }
    QStringList said;
    if (const QString reason = toQString(c.score.reason); !reason.isEmpty()) {
      // A sentence would wrap in its narrow column and push the next models out of sight: it is below them.
      said << reason.section(QStringLiteral(": "), 0, 0);
      const QString line = (toQString(c.model) + QStringLiteral(": ") + reason).toHtmlEscaped();
      if (c.score.matched > 0)
        poor += QStringLiteral("<p>%1</p>").arg(line);  // in a tool tip: it answers, and the photograph keeps its room
      else if (reason.contains(QStringLiteral(": ")))
        reasons += QStringLiteral("<div style='color:%1'>%2</div>").arg(warning, line), ++failures;
    }
    if (c.score.missed > 0 && (c.score.reason.empty() || c.score.matched > 0))
      said << QObject::tr("%1 missed").arg(c.score.missed);
    if (c.score.spurious > 0) said << QObject::tr("%1 spurious").arg(c.score.spurious);
    const bool any = c.score.matched > 0, selected = document.selection().model == c.model;
    const QString model = toQString(c.model).toHtmlEscaped();
    const bool shown = document.layerVisible(kModelLayer + c.model);
    rows +=
        QStringLiteral("<tr style='color:%1'>").arg(plain) +
        cell(link(QStringLiteral("show:") + model, toQColor(c.colour).name(), shown ? QStringLiteral("■") : QStringLiteral("□")) +
                 QStringLiteral("&nbsp;") +
                 link(QStringLiteral("select:") + model, shown ? plain : faded,
                      selected ? QStringLiteral("<b>%1</b>").arg(model) : model),
             "left") +
        error(c.score.errorPct) + error(c.score.errorPx) + share(any ? c.score.iou : std::nullopt) +
        QStringLiteral("<td style='color:%1; white-space:nowrap'>%2</td></tr>")
            .arg(warning, said.join(QStringLiteral(", ")).toHtmlEscaped());
  }
  QString html = problems;
  if (!rows.isEmpty())
    html += QStringLiteral("<table cellspacing='0' cellpadding='0'><tr style='color:%1'>").arg(faded) +
            cell(earlier ? QObject::tr("<span style='color:%1'>earlier state</span>").arg(warning) : QObject::tr("this frame"),
                 "left") +
            cell(QObject::tr("error %")) + cell(QObject::tr("px")) + cell(QObject::tr("IoU")) + QStringLiteral("<td></td></tr>") +
            rows + QStringLiteral("</table>") + reasons;
  return {html + lobes, failures, poor};
}

void keepErrors(const draw::FrameOverlay& results, draw::FrameOverlay& shown) {
  const auto ofModel = [](const draw::OverlayCaption& c) { return !c.model.empty(); };
  std::erase_if(shown.captions, ofModel);
  std::copy_if(results.captions.begin(), results.captions.end(), std::back_inserter(shown.captions), ofModel);
}

QString unreadableText(const Scene& scene, int frame, const QString& reason) {
  const QString named = QLatin1String(nameOf(Reason::FrameUnreadable)) + QStringLiteral(": ");
  return QObject::tr("Frame %1 has no image\n%2")
      .arg(nameText(scene.frames[std::size_t(frame)].id), toQString(withoutFolder(reason.toStdString(), scene)).remove(named));
}

}  // namespace glint::gui
