// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/movie_actions.h"

#include <QFileInfo>
#include <utility>

#include "core/pipeline/photograph.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/export/figure_actions.h"
#include "gui/export/long_job.h"
#include "gui/frame/frame_panel.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "viz/convert.h"
#include "viz/offscreen.h"
#include "viz/pictures.h"

namespace glint::gui {

namespace {
constexpr int kPhotographPx = 4096;  // widest photograph while looking through a camera
}  // namespace

/// A 3D view and the window that it is drawn in; both live and die on the interface thread.
struct MovieActions::Stage {
  std::unique_ptr<viz::SceneView> view;
  std::unique_ptr<viz::Offscreen> target;
};

MovieActions::MovieActions(Document& document, ScenePanel& scene, FramePanel& frame, LongJob& job, QWidget* window)
    : QObject(window), document_(document), scene_(scene), frame_(frame), job_(job), window_(window) {
  // It shares photographs and triangles with the views, which forget them with the scene.
  connect(&document_, &Document::sceneOpened, this, [this] {
    if (!stage_.expired()) job_.cancel();
  });
}

void MovieActions::addActions(Actions& actions, QMenu* menu) {
  actions.add("export.movie", menu, tr("&Movie of timeline…"), [this] { ask(MovieOf::FrameView); },
              {{}, {}, tr("Frame by frame: photographs with contours, or the scene through each camera")});
  actions.add("export.turntable", menu, tr("Movie of &turntable…"), [this] { ask(MovieOf::Turntable); },
              {{}, {}, tr("One turn of the 3D view about the up axis")});
}

void MovieActions::ask(MovieOf of) {
  if (document_.shownStale()) return void(emit problem(notUpToDate()));
  if (!document_.inspection()) return;
  MovieDialog dialog(of, document_.frameCount(), currentTheme() == Theme::Dark, window_);
  if (dialog.exec() != QDialog::Accepted) return;
  const MovieLook look = dialog.look();
  const QString file = askForFile(
      window_, document_, tr("Movie"), suggestedFile(document_, look.of == MovieOf::Turntable ? "turntable" : "timeline", ".mp4"),
      tr("H.264 (*.mp4);;VP8 (*.webm);;Motion JPEG (*.avi);;Lossless (*.mkv);;Image sequence (*.png)"));
  if (!file.isEmpty()) write(look, file);
}

void MovieActions::start(const MovieLook& look, const QString& file, std::function<Image(int)> picture) {
  job_.start(tr("Writing %1").arg(QFileInfo(file).fileName()),
             [this, look, file, picture = std::move(picture)](const ProgressFn& progress) {
               viz::writeMovie(file.toStdString(), look.format, look.frames, picture, progress);
               return [this, file] { emit written(file); };
             });
}

void MovieActions::write(const MovieLook& look, const QString& file) {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection) return;
  if (job_.busy()) return void(emit problem(tr("Another export is still running")));
  const int width = look.format.width, height = look.format.height;
  if (look.of == MovieOf::FrameView) {
    const draw::OverlayOptions shown = frame_.overlayOptions();
    viz::PictureOptions options;
    options.dark = look.dark;
    options.hidden = shown.hidden;
    for (const std::string& model : inspection->request.models)
      if (!shown.hiddenModels.count(model)) options.models.insert(model);
    return start(look, file, [inspection, options, width, height](int frame) {
      return viz::framePicture(*inspection, frame, photographOf(*inspection, frame), width, height, options);
    });
  }
  auto stage = std::shared_ptr<Stage>(new Stage, [this](Stage* s) {
    // The job's thread lets go of it last.
    QMetaObject::invokeMethod(
        this, [s] { delete s; }, Qt::QueuedConnection);
  });
  stage_ = stage;
  stage->view = scene_.views().copyOfActive();
  stage->view->setDarkBackground(look.dark);
  Outcome<std::unique_ptr<viz::Offscreen>> target = viz::Offscreen::onOwnDisplay(width, height);
  if (!target) return void(emit problem(toQString(target.failure().message())));
  stage->target = std::move(*target);
  if (look.of == MovieOf::Turntable) {
    stage->view->setEye(viz::Eye::Outside);
    return start(look, file, [this, stage, views = viz::turntable(*stage->view, look.frames)](int i) {
      Image picture;
      job_.onInterface([&] {
        stage->view->setViewPoint(views[std::size_t(i)]);
        picture = stage->target->render(*stage->view);
      });
      return picture;
    });
  }
  stage->view->setEye(viz::Eye::Camera);
  start(look, file, [this, stage, inspection, selection = document_.selection()](int frame) {
    const Outcome<Image> photograph = photographOf(*inspection, frame);
    const vtkSmartPointer<vtkImageData> texture = photograph ? viz::toTexture(*photograph, kPhotographPx) : nullptr;
    Image picture;
    job_.onInterface([&] {
      draw::Selection there = selection;
      there.frame = frame;
      there.direction.reset();
      stage->view->setSelection(there);
      stage->view->setPhotograph(frame, texture);
      picture = stage->target->render(*stage->view);
    });
    return picture;
  });
}

}  // namespace glint::gui
