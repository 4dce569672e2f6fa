// SPDX-License-Identifier: BSD-3-Clause
// No parameter is dead: each is turned by its widget on a scene where it matters, and the results change. They are computed from
// the earlier ones, as the program does, so that a stage which forgets that it depends on a setting is found too.
#include <QAbstractSpinBox>
#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QLineEdit>
#include <QSignalSpy>
#include <QToolButton>
#include <map>

#include "core/app/session.h"
#include "core/pipeline/summary.h"
#include "core/synth/synth.h"
#include "gui/base/number_box.h"
#include "gui/base/text.h"
#include "gui/panels/parameter_panel.h"
#include "tests/core/model/bumpy_mesh.h"
#include "tests/gui/fixture.h"
#include "tests/sanitizers/cases.h"

namespace glint::gui {

namespace {
/// The value to which one setting is turned, the scene, and what else is set there.
struct Turn {
  const char* key;
  const char* value;
  const char* scene;
  std::map<std::string, std::string> base = {};
  std::vector<std::string> models = {"limit-angle"};
};

const std::vector<Turn>& turns() {
  const std::map<std::string, std::string> kPoses{{"light.refine_poses", "true"}}, kDepth{{"light.refine_depth", "true"}},
      kNormals{{"light.refine_normals", "true"}}, kStar{{"predict.contour", "star"}},
      kPosesOfSmooth{{"light.refine_poses", "true"},
                     {"detect.background", "smooth"}};  // with the lobe's background nothing is left to refine
  // Noise, so that the wrong depth of the frames is not told from motion and they are fused all the same.
  const std::map<std::string, std::string> kBlurred{
      {"surface.depth_noise", "4"}, {"surface.depth_smoothing", "fit"}, {"surface.depth_radius", "0.2"}};
  static const std::vector<Turn> all{
      {"detect.level", "0.3", "noisy"},
      {"detect.min_area", "5000", "noisy"},
      {"detect.min_contrast", "50", "grainy"},
      {"detect.peak_window", "0.6", "noisy"},
      {"detect.clip", "0.2", "noisy"},
      {"detect.background", "smooth", "noisy"},
      {"surface.normals", "facet", "vase"},
      {"surface.rays", "single", "vase"},
      {"surface.depth_smoothing", "fit", "depth"},
      {"surface.depth_normals", "integral", "depth"},
      {"surface.depth_radius", "0.05", "depth"},
      {"surface.depth_fuse", "2", "depth", kBlurred},
      {"surface.depth_noise", "0.1", "depth"},
      {"surface.depth_seed", "2", "depth", {{"surface.depth_noise", "0.1"}}},
      {"light.solver", "triangulated", "noisy"},
      {"light.bundle_points", "24", "noisy"},
      {"light.robust_px", "0.02", "noisy"},
      {"light.limit_orders", "1", "noisy"},
      {"light.refine_poses", "true", "noisy"},
      {"light.pose_sigma", "2", "noisy", kPosesOfSmooth},
      {"light.refine_depth", "true", "depth"},
      {"light.depth_sigma", "0.05", "depth", kDepth},
      {"light.refine_normals", "true", "bumpy"},
      {"light.normal_sigma", "0.001", "bumpy", kNormals},
      {"fit.solver", "linear", "noisy", {}, {"canonical"}},
      {"fit.prior_bias", "3", "noisy", {}, {"canonical"}},
      {"fit.evidence", "contours", "noisy", {}, {"reflectance"}},
      {"fit.levels", "0.2,0.5", "noisy", {{"fit.evidence", "levels"}}, {"reflectance"}},
      {"fit.lobe", "phong", "noisy", {}, {"reflectance"}},
      {"fit.light_size", "point", "large lamp", {}, {"reflectance"}},
      {"fit.most_residual", "1", "noisy", {}, {"primal"}},  // poor at a tenth: the surface is no plane
      {"fit.directions", "12", "noisy", {}, {"canonical"}},
      {"fit.walk_tolerance", "0.001", "noisy", {}, {"canonical"}},
      {"predict.directions", "12", "noisy", {}, {"canonical"}},
      {"predict.query", "local-quadric", "noisy", kStar},
      {"predict.contour", "star", "noisy"},
      {"predict.search", "hints", "noisy"},
      {"predict.seed_step", "3", "noisy"},
      {"predict.level_set_step", "24", "noisy"},
      {"predict.walk_tolerance", "0.001", "noisy", {}, {"canonical"}},
      {"predict.band", "true", "noisy"},
      {"predict.filter_area", "true", "given", {{"detect.min_area", "5000"}}},
      {"input.scale_tolerance", "0.01", "noisy", {{"predict.band", "true"}}},
      {"input.focal_tolerance", "0.01", "noisy", {{"predict.band", "true"}}},
  };
  return all;
}

/// The values that are set in one turn. A lobe that is fitted to pixels on every other surface takes most of the time of the rows
/// that change one: `surface.normals` and the settings of the detection tell whether it follows.
std::map<std::string, std::string> baseOf(const Turn& t) {
  std::map<std::string, std::string> base = t.base;
  const std::string key = t.key;
  const auto isOf = [&](const char* group) { return key.rfind(group, 0) == 0; };
  if ((isOf("surface.") && key != "surface.normals") || isOf("light.") || isOf("predict.") || isOf("input.")) {
    base.emplace("detect.background", "smooth");
    base.emplace("fit.evidence", "contours");
  }
  return base;
}

/// Settings of which no result depends, with the reason why they are settings all the same.
const std::map<std::string, const char*>& changeNothing() {
  static const std::map<std::string, const char*> some{
      {"detect.motion", "nothing is painted on the surfaces here; tests of core paint them"},
      {"detect.texture", "the surfaces here are plain; tests of core print on them"},
      {"light.frame", "the lamps here stand still, which is found; tests of core let them move"},
      {"light.smooth_mesh", "the meshes here have no noise; tests of core give them some"},
      {"predict.filter_brightness", "one highlight is predicted here; tests of core predict fainter ones"},
      {"predict.filter_shadow", "nothing shadows itself here; tests of core put a ball in the way"},
      {"surface.depth_fill", "the depth maps here have no holes; tests of core fill and leave some"}};
  return some;
}

/// Small photographs of an ellipsoid, five to fit and one to predict, %1 = radius of the lamp, %2 = noise.
const char* const kSpec = R"({"glint_scene": 1, "name": "ellipsoid",
  "camera": {"width": 200, "height": 150, "fx": 250, "fy": 250, "cx": 99.5, "cy": 74.5},
  "surfaces": {"body": {"analytic": {"type": "ellipsoid", "semi_axes": [0.6, 0.45, 0.35]}}},
  "lights": [{"id": "lamp", "position": [0.9, -0.8, 1.6], "radius": %1}],
  "path": {"orbit": {"centre": [0, 0, 0], "radius": 1.6, "from": -1.6, "to": -0.17, "height": 0.9, "count": 6}},
  "render": {"reflectance": "torrance-sparrow", "roughness": 0.12, "diffuse": [0.3, 0.4, 0.6], "noise": %2, "bits": 8,
             "seed": 3}})";

/// All numbers and the words about each fit: the border between ok and poor changes only words.
std::string results(const Inspection& inspection) {
  std::string all = digestOf(inspection);
  for (const auto& [name, model] : inspection.models)
    for (const ModelResult::Fit& fit : model.fits) all += fitStatus(fit);
  return all;
}
}  // namespace

class ParametersTest : public QObject {
  Q_OBJECT
 private slots:
  /// A number that is shown shortened stays exact; while it is edited all digits are there, and none is cut.
  void numbersAreShortAndExact() {
    ParamSpec spec = paramSpec("detect.level");
    spec.min = -10;
    spec.max = 10;
    spec.step = 1e-6;
    // Angles alone have no blank before their sign.
    for (const auto& [unit, suffix] : {std::pair("deg", "°"), std::pair("px^2", " px²"), std::pair("", "")}) {
      spec.unit = unit;
      QCOMPARE(NumberBox(spec).suffix(), QString::fromUtf8(suffix));
      QVERIFY(valueText(2.5, spec) == QStringLiteral("2.5") + QString::fromUtf8(suffix));
    }
    spec.unit = "m^-1";
    QWidget window;
    NumberBox box(spec, &window);
    auto* other = new QLineEdit(&window);
    window.show();
    const auto shown = [&] { return box.text(); };
    const std::pair<double, const char*> cases[] = {{-0.3979442, "-0.39794 m^-1"},
                                                    {0.5, "0.5 m^-1"},
                                                    {1.23456e-7, "1.23e-07 m^-1"},
                                                    {-0.00123456, "-0.00123 m^-1"},
                                                    {9.87654321, "9.8765 m^-1"}};
    for (const auto& [value, text] : cases) {
      box.setValue(value);
      QCOMPARE(shown(), QString::fromLatin1(text));
      QVERIFY(box.fontMetrics().horizontalAdvance(shown()) < box.sizeHint().width() - 16);  // the arrows
    }
    box.setValue(-0.3979442);
    QFocusEvent in(QEvent::FocusIn), out(QEvent::FocusOut);
    QSignalSpy changed(&box, QOverload<double>::of(&QDoubleSpinBox::valueChanged));
    QApplication::sendEvent(&box, &in);
    QCOMPARE(shown(), QStringLiteral("-0.3979442 m^-1"));
    QApplication::sendEvent(&box, &out);
    QCOMPARE(shown(), QStringLiteral("-0.39794 m^-1"));
    QTest::keyClick(&box, Qt::Key_Return);  // nothing was typed
    QCOMPARE(box.value(), -0.3979442);
    QCOMPARE(changed.count(), 0);
    QApplication::sendEvent(&box, &in);
    box.selectAll();
    QTest::keyClicks(&box, "0.123456789");
    QTest::keyClick(&box, Qt::Key_Return);
    QCOMPARE(box.value(), 0.123456789);
    QApplication::sendEvent(&box, &out);
    QCOMPARE(box.value(), 0.123456789);
    delete other;
  }

  void everySettingIsTurnedOrExplained() {
    for (const ParamSpec& spec : allParams()) {
      const auto count = std::count_if(turns().begin(), turns().end(), [&](const Turn& t) { return spec.key == t.key; });
      QVERIFY2(count + long(changeNothing().count(spec.key)) == 1, spec.key.c_str());
    }
    QCOMPARE(turns().size() + changeNothing().size(), allParams().size());
  }

  void everyToolTipHasSymbolAndEquation() {
    Document document(parseTrainSpec);
    ParameterPanel panel(document);
    for (const ParamSpec& spec : allParams()) {
      QStringList tips;
      for (const QWidget* w : panel.findChildren<QWidget*>())
        if (w->toolTip().contains("<tt>" + toQString(spec.key) + "</tt>")) tips << w->toolTip();
      QVERIFY2(!tips.isEmpty(), spec.key.c_str());
      for (const QString& tip : tips) {
        QVERIFY2(tip.contains("<i>" + toQString(spec.symbol).toHtmlEscaped() + "</i>"), qPrintable(tip));
        QVERIFY2(tip.contains(toQString(spec.help).toHtmlEscaped()), qPrintable(tip));
      }
    }
  }

  void turnedByItsWidgetItChangesTheResults_data() {
    QTest::addColumn<int>("turn");
    for (std::size_t i = 0; i < turns().size(); ++i) QTest::newRow(turns()[i].key) << int(i);
  }
  void turnedByItsWidgetItChangesTheResults() {
    QFETCH(int, turn);
    const Turn& t = turns()[std::size_t(turn)];
    Document document(parseTrainSpec);
    ParameterPanel panel(document);
    Opened opened;
    opened.scene = scene(t.scene);
    QVERIFY(opened.scene);
    opened.request.models = t.models;
    opened.request.train = "first:5";
    for (const auto& [key, value] : baseOf(t)) opened.request.settings.setFromText(key, value);
    document.open(opened);
    panel.resize(420, 900);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    panel.activateWindow();

    turnTo(panel, t);
    if (QTest::currentTestFailed()) return;
    InspectionRequest wanted = opened.request;
    wanted.settings.setFromText(t.key, t.value);
    QVERIFY(document.request() == wanted);
    if (!testing_support::kSanitized) {  // else an hour of fits, which other tests make, too
      const Inspection& before = inspected(t.scene, opened.request);
      const Inspection after = inspect(opened.scene, document.request(), {}, &before);
      QVERIFY(results(after) != results(before));
    }

    QTest::mouseClick(panel.findChild<QToolButton*>("reset:" + toQString(t.key)), Qt::LeftButton);
    QVERIFY(document.request() == opened.request);  // the same request has the same results: core_inspect
  }

 private:
  static void turnTo(ParameterPanel& panel, const Turn& t) {
    QVERIFY(panel.showParameter(t.key));
    auto* control = panel.findChild<QWidget*>("value:" + toQString(t.key));
    QVERIFY(control && control->isVisible());
    control->setFocus();
    if (auto* check = qobject_cast<QCheckBox*>(control)) {
      QTest::mouseClick(check, Qt::LeftButton, {}, {8, check->height() / 2});
    } else if (auto* combo = qobject_cast<QComboBox*>(control)) {
      QTest::keyClick(combo, Qt::Key_Home);
      for (int i = 0; i < combo->count() && combo->currentText() != QLatin1String(t.value); ++i)
        QTest::keyClick(combo, Qt::Key_Down);
    } else {
      auto* box = qobject_cast<QAbstractSpinBox*>(control);
      QVERIFY(box);
      box->selectAll();
      QTest::keyClicks(box, QLatin1String(t.value));
      QTest::keyClick(box, Qt::Key_Return);
    }
  }

  /// Results of a request, once for all rows that start from it.
  const Inspection& inspected(const std::string& name, const InspectionRequest& request) {
    std::string key = name;
    for (const std::string& model : request.models) key += ' ' + model;
    for (const auto& [setting, value] : request.settings.values())
      key += ' ' + setting + '=' + valueText(value, paramSpec(setting)).toStdString();
    auto it = inspections_.find(key);
    if (it == inspections_.end()) it = inspections_.emplace(key, inspect(scene(name), request)).first;
    return it->second;
  }

  std::shared_ptr<const Scene> scene(const std::string& name) {
    std::shared_ptr<const Scene>& kept = scenes_[name];
    if (kept) return kept;
    auto made = std::make_shared<Scene>();
    if (name == "vase") {
      *made = readScene(GLINT_SOURCE_DIR "/sessions/vase/scene.json");
      made->frames.resize(6);
    } else {
      const QDir folder(folder_.filePath(toQString(name)));
      folder.mkpath(QStringLiteral("."));
      QFile file(folder.filePath(QStringLiteral("spec.json")));
      if (!file.open(QIODevice::WriteOnly)) return nullptr;
      file.write(
          QString(QLatin1String(kSpec)).arg(name == "large lamp" ? 0.5 : 0.0).arg(name == "grainy" ? 0.06 : 0.01).toUtf8());
      file.close();
      *made = synthesise(readSynthSpec(file.fileName().toStdString()), folder.path().toStdString());
      for (Frame& frame : made->frames) {
        if (name != "given") frame.highlights.clear();  // to be detected
        if (name == "depth") makeDepthWrong(frame);
      }
      if (name == "bumpy") {
        const QString mesh = folder.filePath(QStringLiteral("body.ply"));
        test::writePly(test::bumpyMesh(*made->surfaces.at("body").analytic(), 0.02, 0.2, 5), mesh.toStdString());
        made->surfaces["body"] = MeshFile{{mesh.toStdString()}};
      }
    }
    return kept = made;
  }

  /// The frame sees its own depth map, which is off by up to 2 % towards the image's border.
  static void makeDepthWrong(Frame& frame) {
    constexpr double kMetresPerUnit = 5e-5;
    const Outcome<std::optional<Image>> depth = readDepth(frame);
    QVERIFY(depth && *depth);
    QImage wrong((*depth)->width, (*depth)->height, QImage::Format_Grayscale16);
    for (int y = 0; y < wrong.height(); ++y) {
      auto* row = reinterpret_cast<quint16*>(wrong.scanLine(y));
      for (int x = 0; x < wrong.width(); ++x) {
        const double u = 2.0 * x / wrong.width() - 1, v = 2.0 * y / wrong.width() - 0.75;
        row[x] = quint16(std::lround(double((*depth)->at(x, y)) * (1 + 0.02 * (u * u - 0.5 * v * v)) / kMetresPerUnit));
      }
    }
    frame.depth += ".png";
    QVERIFY(wrong.save(toQString(frame.depth.string())));
    frame.depthScale = kMetresPerUnit;
    frame.surface.clear();
  }

  QTemporaryDir folder_;
  std::map<std::string, std::shared_ptr<const Scene>> scenes_;
  std::map<std::string, Inspection> inspections_;
};

QObject* makeParametersTest() { return new ParametersTest; }

}  // namespace glint::gui

#include "parameters_test.moc"
