// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/figure_actions.h"

#include <vtkRenderer.h>

#include <QBuffer>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QFontMetricsF>
#include <QMessageBox>
#include <QPageSize>
#include <QPainter>
#include <QPdfWriter>
#include <QRegularExpression>
#include <QSvgGenerator>
#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/atomic_file.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/to_qimage.h"
#include "gui/base/vtk_canvas.h"
#include "gui/base/write_png.h"
#include "gui/document/figure.h"
#include "gui/document/own_files.h"
#include "gui/export/figure_caption.h"
#include "gui/export/long_job.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/pair_bar.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "viz/offscreen.h"
#include "viz/style.h"

namespace glint::gui {

namespace {
constexpr int kDotsPerInch = 96;  // of SVG and PDF: a figure px is 1/96 inch, as in web pages
constexpr int kBetweenPx = 2;     // two frames side by side

/// Device px of a widget; of a hidden one, which has no size, something usual.
QSize shownSize(const QWidget& widget) {
  return widget.isVisible() ? widget.size() * widget.devicePixelRatioF() : QSize(1280, 800);
}

void writeBytes(const QString& file, const QByteArray& bytes) {
  atomicWrite(file.toStdString(), std::string_view(bytes.constData(), std::size_t(bytes.size())));
}
}  // namespace

namespace {
/// The folder of the last export, for the input that it was of: the next one starts there.
std::pair<QString, QString> theLastExport;
}  // namespace

void rememberExport(const Document& document, const QString& file) {
  theLastExport = {document.inputFile(), QFileInfo(file).absolutePath()};
}

QString notUpToDate() { return QObject::tr("Results on screen are of an earlier state; export when they are up to date"); }

QString suggestedFile(const Document& document, const QString& what, const QString& ending) {
  const QFileInfo input(document.sessionFile().isEmpty() ? document.inputFile() : document.sessionFile());
  const QString base = input.fileName() == QLatin1String("scene.json") ? input.dir().dirName() : input.completeBaseName();
  const bool before = theLastExport.first == document.inputFile() && QFileInfo(theLastExport.second).isDir();
  return QDir(before ? theLastExport.second : input.absolutePath()).filePath(QStringLiteral("%1-%2%3").arg(base, what, ending));
}

namespace {
/// A file of the input stays as it is. @param unasked  the dialog has not seen this name, and has not asked.
bool mayReplace(QWidget* window, const Document& document, const QString& file, bool unasked) {
  if (!QFileInfo::exists(file)) return true;
  const QString shown = shownText(QDir::toNativeSeparators(file));
  if (isOfInput(document, file) || isShipped(file)) {
    QMessageBox refusal(
        QMessageBox::Warning, QObject::tr("File not replaced"),
        QObject::tr("%1 is an input file or came with the program, so it is not overwritten. Choose another name.").arg(shown),
        QMessageBox::Ok, window);
    refusal.setObjectName(QStringLiteral("inputRefusal"));
    refusal.exec();
    return false;
  }
  if (!unasked) return true;
  QMessageBox question(QMessageBox::Warning, QObject::tr("Replace file?"),
                       QObject::tr("%1 already exists. Replace it?").arg(shown), QMessageBox::Yes | QMessageBox::No, window);
  question.setObjectName(QStringLiteral("replaceQuestion"));
  question.setDefaultButton(QMessageBox::No);
  return question.exec() == QMessageBox::Yes;
}
}  // namespace

QString askForFile(QWidget* window, const Document& document, const QString& title, const QString& suggestion,
                   const QString& filters) {
  QString proposed = suggestion;
  while (true) {
    QString filter;
    const QString chosen = QFileDialog::getSaveFileName(window, title, proposed, filters, &filter);
    if (chosen.isEmpty()) return {};
    QString file = chosen;
    if (QFileInfo(file).suffix().isEmpty()) file += QRegularExpression(QStringLiteral("\\*(\\.\\w+)")).match(filter).captured(1);
    if (mayReplace(window, document, file, file != chosen)) {
      rememberExport(document, file);
      return file;
    }
    proposed = file;
  }
}

FigureActions::FigureActions(const Engine& engine, Document& document, ScenePanel& scene, FramePanel& frame, LongJob& job,
                             QWidget* window)
    : QObject(window), engine_(engine), document_(document), scene_(scene), frame_(frame), job_(job), window_(window) {}

void FigureActions::addActions(Actions& actions, QMenu* menu) {
  actions.add("export.scene", menu, tr("&3D view…"),
              [this] {
                if (document_.shownStale()) return void(emit problem(notUpToDate()));
                if (!document_.inspection()) return;
                FigureDialog dialog(tr("3D view as picture"), QStringLiteral("scene"), shownSize(*scene_.views().widget()),
                                    window_);
                dialog.proposeCaption(proposedCaption(document_, tr("3D view")));
                if (dialog.exec() != QDialog::Accepted) return;
                const QString file = askForFile(window_, document_, dialog.windowTitle(), suggestedFile(document_, "3d", ".png"),
                                                tr("Pictures with embedded session (*.png)"));
                if (!file.isEmpty()) writeScene(dialog.look(), file);
              },
              {{}, {}, tr("As on screen, at any size, optionally with a transparent background")});
  actions.add("export.frame-view", menu, tr("Frame &view…"),
              [this] {
                if (document_.shownStale()) return void(emit problem(notUpToDate()));
                if (document_.frameCount() == 0) return;
                QSize shown = shownSize(*frame_.canvas());
                if (frame_.secondCanvas()->isVisible()) shown.rwidth() *= 2;
                FigureDialog dialog(tr("Frame view as picture"), QStringLiteral("frame"), shown, window_);
                const int frame = document_.selection().frame;
                dialog.proposeCaption(proposedCaption(
                    document_, tr("Highlights in frame %1").arg(nameText(document_.scene()->frames[std::size_t(frame)].id))));
                if (dialog.exec() != QDialog::Accepted) return;
                const QString file = askForFile(
                    window_, document_, dialog.windowTitle(), suggestedFile(document_, "frame", ".png"),
                    tr("Pictures with embedded session (*.png);;Vector overlays, SVG (*.svg);;Vector overlays, PDF (*.pdf)"));
                if (!file.isEmpty()) writeFrame(dialog.look(), file);
              },
              {{}, {}, tr("As on screen, at any size; SVG and PDF keep the contours as vector strokes over the photograph")});
}

void FigureActions::write(const QString& file, std::function<void()> work) {
  job_.start(tr("Writing %1").arg(QFileInfo(file).fileName()), [this, file, work = std::move(work)](const ProgressFn&) {
    work();
    return [this, file] { emit written(file); };
  });
}

void FigureActions::writeScene(const FigureLook& look, const QString& file) {
  if (!file.endsWith(QStringLiteral(".png"), Qt::CaseInsensitive))
    return void(emit problem(tr("%1: the 3D view can only be saved as .png").arg(file)));
  QImage picture;
  try {
    const FigureCaption caption(look);
    picture = caption.under(sceneFigure(caption.above()));
    setDpi(picture, look.dpi);
  } catch (const InputError& e) {
    return void(emit problem(toQString(e.what())));
  }
  write(file, [this, picture, state = snapshot_(), file] { writeFigure(picture, state, engine_, file); });
}

QImage FigureActions::sceneFigure(const FigureLook& look) const {
  SceneViews& views = scene_.views();
  const auto render = [&](int at, const QSize& size) {
    const std::unique_ptr<viz::SceneView> view = views.viewCount() > 1 ? views.copyOf(at) : views.copyOfActive();
    view->setDarkBackground(look.dark);
    view->setLegendVisible(views.hasLegend(at), at == 0);
    if (views.wiping() && views.hasLegend(1)) {  // the legend of each side is in its own part
      const std::array<double, 4> v = views.placeOf(at);
      view->renderer()->SetViewport(v[0], v[1], v[2], v[3]);
      view->setPartOfWindow(true);
    }
    if (views.viewCount() > 1) view->setFrame(!views.wiping(), false, sceneOptions(document_).views[std::size_t(at)].name);
    const Outcome<std::unique_ptr<viz::Offscreen>> target = viz::Offscreen::onOwnDisplay(size.width(), size.height());
    if (!target) throw InputError("", "", target.failure().message());
    return toQImage((*target)->render(*view, look.transparent));
  };
  if (views.viewCount() == 1) return render(0, look.size);
  QImage all(look.size, look.transparent ? QImage::Format_ARGB32 : QImage::Format_RGB32);
  all.fill(Qt::transparent);
  QPainter painter(&all);
  for (int i = 0; i < views.viewCount(); ++i) {
    const std::array<double, 4> v = views.placeOf(i);
    const QRect part(QPoint(qRound(v[0] * all.width()), qRound((1 - v[3]) * all.height())),
                     QPoint(qRound(v[2] * all.width()) - 1, qRound((1 - v[1]) * all.height()) - 1));
    // Both sides of a wipe are the same picture, of which each shows its columns.
    const QImage picture = render(i, views.wiping() ? all.size() : part.size());
    painter.drawImage(part.topLeft(), picture, views.wiping() ? part : QRect({0, 0}, part.size()));
    if (views.wiping() && i == 1) painter.fillRect(part.left(), 0, 1, all.height(), QColor(128, 128, 128));
  }
  painter.end();
  return all;
}

void FigureActions::paintFrames(QPainter& painter, const FigureLook& look) const {
  const QColor background = backgroundOf(look);
  const QRectF all({0, 0}, QSizeF(look.size));
  const double key = paintKey(painter, look);
  if (!frame_.secondCanvas()->isVisible()) return frame_.canvas()->drawFigure(painter, all.adjusted(0, key, 0, 0), background);
  const QSizeF half((all.width() - kBetweenPx) / 2, all.height() - key);
  frame_.canvas()->drawFigure(painter, {QPointF(0, key), half}, background);
  frame_.secondCanvas()->drawFigure(painter, {QPointF(half.width() + kBetweenPx, key), half}, background);
}

void FigureActions::paintFigure(QPainter& painter, const FigureLook& look) const {
  const FigureCaption caption(look);
  paintFrames(painter, caption.above());
  caption.paint(painter);
}

double FigureActions::paintKey(QPainter& painter, const FigureLook& look) const {
  const QList<PairBar::KeyEntry> key = frame_.figureKey();
  if (key.isEmpty()) return 0;
  // In px of the window, whose texts the pictures below have; as large as those where the figure is larger.
  const FrameCanvas &first = *frame_.canvas(), &second = *frame_.secondCanvas();
  const int beside = second.isVisible() ? second.width() + kBetweenPx : 0;
  const double scale = std::min(double(look.size.width()) / std::max(1, first.width() + beside),
                                double(look.size.height()) / std::max(1, first.height()));
  const QFontMetricsF metrics(first.font());
  const double line = 1.5 * metrics.height(), square = 0.6 * metrics.height(), width = look.size.width() / scale;
  std::vector<QPointF> places;
  QPointF at(square, 0);
  for (const PairBar::KeyEntry& entry : key) {
    const double wide = 2 * square + metrics.horizontalAdvance(entry.text);
    if (!places.empty() && at.x() + wide > width) at = {square, at.y() + line};
    places.push_back(at);
    at.rx() += wide + 2 * square;
  }
  const double height = scale * (at.y() + line);
  if (const QColor background = backgroundOf(look); background.isValid())
    painter.fillRect(QRectF(0, 0, look.size.width(), height), background);
  painter.save();
  painter.scale(scale, scale);
  painter.setFont(first.font());
  for (int i = 0; i < key.size(); ++i) {
    const QRectF box(places[std::size_t(i)] + QPointF(0, (line - square) / 2), QSizeF(square, square));
    painter.fillRect(box, key[i].colour);
    painter.setPen(toQColor(look.dark ? draw::kTextOnDark : draw::kTextOnLight));
    if (key[i].colour == toQColor(draw::kObserved)) painter.drawRect(box);  // white on a white page
    painter.drawText(QPointF(box.right() + square, box.center().y() + (metrics.ascent() - metrics.descent()) / 2), key[i].text);
  }
  painter.restore();
  return height;
}

void FigureActions::writeFrame(const FigureLook& look, const QString& file) {
  const QString ending = QFileInfo(file).suffix().toLower();
  if (ending == QLatin1String("png")) {
    QImage picture(look.size, QImage::Format_ARGB32);
    picture.fill(Qt::transparent);
    {
      QPainter painter(&picture);
      paintFigure(painter, look);
    }
    if (!look.transparent) picture = picture.convertToFormat(QImage::Format_RGB32);
    setDpi(picture, look.dpi);
    return write(file, [this, picture, state = snapshot_(), file] { writeFigure(picture, state, engine_, file); });
  }
  QBuffer bytes;
  bytes.open(QIODevice::WriteOnly);
  const QString title = QFileInfo(document_.inputFile()).fileName();
  if (ending == QLatin1String("svg")) {
    QSvgGenerator svg;
    svg.setOutputDevice(&bytes);
    svg.setSize(look.size);
    svg.setViewBox(QRect({0, 0}, look.size));
    svg.setResolution(kDotsPerInch);
    QPainter painter(&svg);
    paintFigure(painter, look);
  } else if (ending == QLatin1String("pdf")) {
    QPdfWriter pdf(&bytes);
    pdf.setPageSize(QPageSize(QSizeF(look.size) * 72.0 / kDotsPerInch, QPageSize::Point, QString(), QPageSize::ExactMatch));
    pdf.setPageMargins({});
    pdf.setResolution(kDotsPerInch);
    pdf.setTitle(title);
    QPainter painter(&pdf);
    paintFigure(painter, look);
  } else {
    return void(emit problem(tr("%1: the frame view can only be saved as .png, .svg or .pdf").arg(file)));
  }
  const bool svg = ending == QLatin1String("svg");
  const QByteArray content = svg ? withTitle(bytes.data(), title, look.caption.trimmed()) : bytes.data();
  write(file, [content, file] { writeBytes(file, content); });
}

}  // namespace glint::gui
