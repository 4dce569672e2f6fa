// SPDX-License-Identifier: BSD-3-Clause
#include "tests/gui/fixture.h"

#include <QImage>
#include <QMouseEvent>
#include <algorithm>
#include <cmath>
#include <mutex>

namespace glint::gui {

namespace {
Polyline circle(const Pixel& centre, double radius) {
  Polyline line;
  for (int i = 0; i < 72; ++i) {
    const double t = 2 * 3.14159265358979323846 * i / 72;
    line.points.push_back(centre + radius * Pixel(std::cos(t), std::sin(t)));
  }
  return line;
}
}  // namespace

Fixture::Fixture(int frames) : scene_(std::make_shared<Scene>()) {
  scene_->name = "circles";
  scene_->folder = folder_.path().toStdString();
  scene_->file = scene_->folder / "scene.json";
  for (int i = 0; i < frames; ++i) {
    const QString file = folder_.filePath(QStringLiteral("%1.png").arg(i, 4, 10, QLatin1Char('0')));
    QImage photograph(160, 120, QImage::Format_RGB888);
    photograph.fill(QColor(std::min(255, 10 + 5 * i), 30, 40));
    photograph.save(file);
    Frame frame;
    frame.id = QStringLiteral("%1").arg(i, 4, 10, QLatin1Char('0')).toStdString();
    frame.image = file.toStdString();
    frame.camera.pixelFromRay << 200, 0, 79.5, 0, 200, 59.5, 0, 0, 1;
    frame.camera.camFromWorld = Eigen::Translation3d(0, 0, 2);
    frame.camera.width = 160;
    frame.camera.height = 120;
    frame.surface = "ball";
    scene_->frames.push_back(frame);
  }
  AnalyticSpec ball;
  ball.type = "sphere";
  ball.radius = 0.4;
  scene_->surfaces["ball"] = ball;
}

Opened Fixture::opened() const {
  Opened o;
  o.path = scene_->file.string();
  o.scene = scene_;
  return o;
}

namespace {
/// A session as it was opened, and its first results.
struct KnownSession {
  Opened opened;
  std::shared_ptr<const Inspection> result;
  std::optional<ConventionReport> report;
};

class Known {
 public:
  /// Calls use(KnownSession&) where the scene is that of a known session.
  template <class Use>
  void with(const Scene* scene, const Use& use) {
    const std::lock_guard lock(mutex_);
    for (auto& [path, session] : sessions_)
      if (session.opened.scene.get() == scene) use(session);
  }
  std::shared_ptr<const Inspection> resultOf(const std::shared_ptr<const Scene>& scene) {
    std::shared_ptr<const Inspection> result;
    with(scene.get(), [&](const KnownSession& session) { result = session.result; });
    return result;
  }
  Opened open(const std::string& path, const std::function<Opened()>& read) {
    const std::lock_guard lock(mutex_);
    if (!sessions_.count(path)) sessions_[path].opened = read();
    return sessions_[path].opened;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, KnownSession> sessions_;
};
}  // namespace

Engine knownEngine(const QString& folder) {
  static Known known;
  Engine engine = coreEngine();
  engine.open = [open = engine.open, below = folder.isEmpty() ? GLINT_SOURCE_DIR "/sessions/" : folder.toStdString()](
                    const std::string& path, const Relinked& instead) {
    if (path.rfind(below, 0) != 0 || instead.any()) return open(path, instead);
    return known.open(path, [&] { return open(path, instead); });
  };
  engine.ask = [ask = engine.ask](Pipeline& pipeline, const Question& question, const ProgressFn& progress) {
    const auto before = known.resultOf(pipeline.scene());
    if (before && !pipeline.known(before->request)) pipeline.remember({before->request}, before);
    const Pipeline::Answer result = ask(pipeline, question, progress);
    known.with(pipeline.scene().get(), [&](KnownSession& session) {
      if (!session.result && question.part == Question::Part::Everything) session.result = result;
    });
    return result;
  };
  engine.check = [check = engine.check](const Scene& scene, const ProgressFn& progress) {
    std::optional<ConventionReport> report;
    known.with(&scene, [&](const KnownSession& session) { report = session.report; });
    if (!report) report = check(scene, progress);
    known.with(&scene, [&](KnownSession& session) { session.report = report; });
    return *report;
  };
  return engine;
}

Inspection drawnCircles(std::shared_ptr<const Scene> scene, const InspectionRequest& request) {
  Inspection result;
  result.scene = result.given = scene;
  result.request = request;
  result.train = parseTrainSpec(request.train, *scene);
  const int n = int(scene->frames.size());
  for (int i = 0; i < n; ++i) {
    Highlight h;
    h.light = "lamp";
    h.level = request.settings.number("detect.level");
    h.contour = circle(Fixture::centre(i), Fixture::kRadius);
    h.peak = Fixture::centre(i);
    FrameEvidence evidence;
    evidence.frame = i;
    evidence.highlights = {h};
    result.evidence.push_back(evidence);
  }
  double offset = 8;
  for (const std::string& name : request.models) {
    ModelResult& model = result.models[name];
    model.model = name;
    model.fits.push_back({"lamp", {}, Failure{Reason::TooFewViews, "a stand-in"}, {}});
    for (int i = 0; i < n; ++i) {
      FrameComparison c;
      c.frame = i;
      c.light = "lamp";
      c.fit = 0;
      if (i == n - 1) {
        c.prediction = Failure{Reason::NoBrightestPoint, "not visible"};
        c.rows.push_back({0, -1, {}, *c.prediction.failure(), {}});
      } else {
        PredictedHighlight p;
        p.contour = circle(Fixture::centre(i) + Pixel(offset, 0), Fixture::kRadius);
        p.brightest.pixel = Fixture::centre(i) + Pixel(offset, 0);
        c.prediction = std::vector{p};
        ContourMetrics m;
        m.contourErrorPct = offset + 0.1 * ((i * 5) % n);  // not in the order of the frames: sorting must show
        m.contourErrorPx = m.contourErrorPct * 0.4;
        m.iou = 0.9;
        c.rows.push_back({0, 0, m, {}, {}});
        c.iou = 0.9;
      }
      model.frames.push_back(c);
    }
    offset /= 2;
  }
  return result;
}

void drag(QWidget* widget, const std::vector<QPoint>& points) {
  const auto send = [widget](QEvent::Type type, const QPoint& at, Qt::MouseButton button, Qt::MouseButtons held) {
    QMouseEvent event(type, QPointF(at), QPointF(widget->mapToGlobal(at)), button, held, Qt::NoModifier);
    QCoreApplication::sendEvent(widget, &event);
  };
  send(QEvent::MouseButtonPress, points.front(), Qt::LeftButton, Qt::LeftButton);
  for (const QPoint& at : points) send(QEvent::MouseMove, at, Qt::NoButton, Qt::LeftButton);
  send(QEvent::MouseButtonRelease, points.back(), Qt::LeftButton, Qt::NoButton);
}

Pipeline::Answer drawn(const Pipeline& pipeline, const Question& question) {
  return std::make_shared<const Inspection>(drawnCircles(pipeline.scene(), question.request));
}

Engine Fixture::engine() const {
  Engine engine;
  engine.open = [opened = opened()](const std::string& path, const Relinked&) {
    if (path != opened.path) throw InputError(path, "", "no such file");
    return opened;
  };
  engine.ask = [](Pipeline& pipeline, const Question& question, const ProgressFn&) -> Pipeline::Answer {
    if (question.part != Question::Part::Everything) return nullptr;
    return drawn(pipeline, question);
  };
  engine.parseTrain = parseTrainSpec;
  return engine;
}

}  // namespace glint::gui
