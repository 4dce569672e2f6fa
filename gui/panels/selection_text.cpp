// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/selection_text.h"

#include <Eigen/Core>
#include <QObject>
#include <QStringList>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/advise/conditioning.h"
#include "core/advise/highlight_evidence.h"
#include "core/advise/polar_residual.h"
#include "core/draw/selection.h"
#include "core/scene/scene_files.h"
#include "gui/base/text.h"
#include "gui/base/unit_text.h"

namespace glint::gui {

namespace {
constexpr double kDegPerRad = 57.29577951308232;

class Lines {
 public:
  void add(const QString& name, const QString& value, const char* unit = "") {
    lines_ << name + QStringLiteral(" = ") + value + unitAfter(unit);
  }
  void add(const QString& name, double value, const char* unit = "") { add(name, numberText(value, 6), unit); }
  template <class Vector>
  void addVector(const QString& name, const Vector& v, const char* unit = "") {
    QStringList parts;
    for (Eigen::Index i = 0; i < v.size(); ++i) parts << numberText(v[i], 6);
    add(name, parts.join(QStringLiteral("  ")), unit);
  }
  void note(const QString& text) { lines_ << text; }
  /// With a line below that says what it is: two px of one contour may be two different things.
  template <class Value>
  void addWithMeaning(const QString& name, const Value& value, const char* unit, const QString& meaning) {
    add(name, value, unit);
    note(QStringLiteral("(%1: %2)").arg(name, meaning));
  }
  QString text() const { return lines_.join('\n'); }

 private:
  QStringList lines_;
};

void addLight(Lines& lines, const Light& light) {
  if (light.atInfinity())
    lines.addVector(QObject::tr("L direction"), light.homogeneous().head<3>().eval());
  else
    lines.addVector(QObject::tr("L"), light.position(), "m");
}

NumberGroup observation(const FrameEvidence& evidence, int index, bool synthesised) {
  Lines lines;
  if (evidence.failure) lines.note(toQString(evidence.failure->message()));
  if (index >= 0) {
    const Highlight& h = evidence.highlights[std::size_t(index)];
    if (!h.light.empty()) lines.add(QObject::tr("light"), nameText(h.light));
    lines.addVector(QObject::tr("peak"), h.peak, "px");
    lines.add(QObject::tr("level"), h.level);
    lines.add(QObject::tr("area"), h.areaPx2, "px²");
    if (h.ellipse) {
      lines.addVector(QObject::tr("centre"), h.ellipse->centre, "px");
      lines.addVector(QObject::tr("semi-axes"), h.ellipse->semiAxes, "px");
      lines.add(QObject::tr("angle"), h.ellipse->angle * kDegPerRad, "deg");
    }
    if (h.clipped) lines.note(QObject::tr("clipped: the peak is the ellipse centre"));
    if (!h.byHand.empty()) lines.note(toQString(h.byHand));
    if (h.touchesBorder) lines.note(QObject::tr("cut by the image border"));
    if (h.peakCut) lines.note(QObject::tr("its peak lies beyond the image"));
    if (h.fromScene) lines.note(synthesised ? QObject::tr("synthesised (what-if)") : QObject::tr("given in the scene file"));
  }
  const int count = int(evidence.highlights.size());
  return {index >= 0 ? QObject::tr("Highlight %1 of %2").arg(index + 1).arg(count) : QObject::tr("Highlights: %1").arg(count),
          lines.text()};
}

NumberGroup trainingView(const TrainingView& view) {
  Lines lines;
  if (!view.seen) lines.note(toQString(view.seen.failure().message()));
  if (view.seen) {
    lines.addVector(QObject::tr("P"), view.seen->brightest.point.position, "m");
    lines.addVector(QObject::tr("N"), view.seen->brightest.point.normal);
  }
  if (view.seen) {
    lines.addVector(QObject::tr("T normal"), view.seen->tangentPlane.normal);
    lines.add(QObject::tr("T offset"), view.seen->tangentPlane.offset, "m");
  }
  if (view.canonical) {
    const auto& d = view.canonical->directions;
    const auto answered = std::count_if(d.begin(), d.end(), [](const DirectionResult& r) { return r.limitAngle.has_value(); });
    lines.add(QObject::tr("directions"), QStringLiteral("%1 of %2").arg(answered).arg(d.size()));
    if (view.canonical->ellipse) lines.addVector(QObject::tr("semi-axes on T"), view.canonical->ellipse->semiAxes, "px");
  }
  return {QObject::tr("Training view"), lines.text()};
}

NumberGroup lightGroup(const std::string& id, const LightEstimate& estimate, const LightFrameChoice& frame) {
  Lines lines;
  addLight(lines, estimate.light);
  if (frame.frameOf(id) == LightFrame::Camera) lines.note(QObject::tr("in the camera's frame: %1").arg(toQString(frame.reason)));
  lines.add(QObject::tr("solver"), toQString(estimate.solver));
  lines.add(QObject::tr("limit angle"), estimate.limitAngle * kDegPerRad, "deg");
  lines.add(QObject::tr("condition"), estimate.condition);
  if (estimate.rmsPx > 0)
    lines.addWithMeaning(QObject::tr("residual"), estimate.rmsPx, "px", QString::fromStdString(residualMeaning(estimate)));
  return {lightTitle(id), lines.text()};
}

/// Where a lamp that moves with the camera is, by the model on show or else by all contours, and what speaks for it.
NumberGroup movingLamp(const Inspection& in, const std::string& id, const LightEstimate* estimate, const ModelFit* fit) {
  Lines lines;
  const bool own = fit && fit->lightEstimate;
  const std::optional<Eigen::Matrix3d> covariance = own ? fit->lightCovariance : estimate ? estimate->covariance : std::nullopt;
  if (own || estimate) addLight(lines, own ? *fit->lightEstimate : estimate->light);
  if (covariance && covariance->allFinite()) {
    QStringList sigma;
    for (int i = 0; i < 3; ++i) sigma << numberText(std::sqrt(std::max(0.0, (*covariance)(i, i))), 2);
    lines.addWithMeaning(QString::fromUtf8("±"), sigma.join(QStringLiteral("  ")), "m",
                         QObject::tr("one standard deviation by noise, %1").arg(toQString(own ? fit->model : estimate->solver)));
  }
  const auto left = [&](const QString& name, const std::optional<double>& px) {
    lines.add(name, px ? QObject::tr("misses the peaks by %1 px").arg(numberText(*px, 2)) : QObject::tr("no such lamp"));
  };
  if (const auto r = in.lightFrame.byLight.find(id); r != in.lightFrame.byLight.end()) {
    left(QObject::tr("with camera"), r->second.camera);
    left(QObject::tr("at rest"), r->second.world);
  }
  const bool carried = in.lightFrame.frameOf(id) == LightFrame::Camera;
  return {carried ? QObject::tr("%1, in the camera's coordinates").arg(lightTitle(id)) : lightTitle(id), lines.text()};
}

NumberGroup fitGroup(const std::string& model, const ModelResult::Fit& f, int frame) {
  Lines lines;
  if (f.failure()) lines.note(toQString(f.failure()->message()));
  if (f.fit) {
    if (!f.fit->poor.empty()) lines.note(QObject::tr("poor: %1").arg(toQString(f.fit->poor)));
    lines.add(QObject::tr("solver"), toQString(f.fit->solver));
    const EllipsoidFit* const fitted = f.fit->as<EllipsoidFit>();
    if (f.fit->ellipsoid()) {
      lines.addVector(QObject::tr("ellipsoid centre"), f.fit->ellipsoid()->centre(), "m");
      lines.addVector(QObject::tr("semi-axes"), f.fit->ellipsoid()->semiAxes(), "m");
    } else if (fitted) {
      lines.note(QObject::tr("Q* is a %1").arg(QString::fromUtf8(describe(fitted->quadric))));
    }
    if (f.fit->lightEstimate) addLight(lines, *f.fit->lightEstimate);
    if (f.fit->limitAngle()) lines.add(QObject::tr("limit angle"), *f.fit->limitAngle() * kDegPerRad, "deg");
    if (const ReflectanceFit* const lobe = f.fit->as<ReflectanceFit>()) {
      lines.add(QObject::tr("lobe"), QLatin1String(nameOf(lobe->lobe)));
      lines.add(QObject::tr("roughness m"), lobe->roughness.mean);
    }
    if (fitted && !fitted->singularValues.empty()) {
      lines.add(QObject::tr("gap ratio"), fitted->gapRatio);
      lines.add(QObject::tr("condition"), f.fit->condition);
    }
    const auto used = std::find(f.fit->frames.begin(), f.fit->frames.end(), frame);
    const auto index = std::size_t(used - f.fit->frames.begin());
    if (used != f.fit->frames.end() && index < f.fit->residualPx.size())
      lines.addWithMeaning(QObject::tr("residual, this frame"), f.fit->residualPx[index], "px",
                           QString::fromStdString(residualMeaning(*f.fit)));
    for (const std::string& remark : f.fit->remarks) lines.note(QObject::tr("Warning: %1").arg(nameText(remark)));
  }
  return {QObject::tr("Fit: %1").arg(toQString(model)), lines.text()};
}

NumberGroup comparison(const FrameComparison& c, int observed) {
  Lines lines;
  if (c.prediction.failure()) lines.note(toQString(c.prediction.failure()->message()));
  for (const FrameComparison::Row& row : c.rows) {
    if (observed >= 0 && row.observed >= 0 && row.observed != observed) continue;
    if (row.predicted >= 0 && row.predicted < int(c.prediction.highlights().size())) {
      const PredictedHighlight& p = c.prediction.highlights()[std::size_t(row.predicted)];
      lines.addVector(QObject::tr("P"), p.brightest.point.position, "m");
      lines.addVector(QObject::tr("N"), p.brightest.point.normal);
      // A model without a tangent plane (primal) has no incident angle either.
      if (p.tangentPlane) lines.add(QObject::tr("alpha"), p.brightest.alpha * kDegPerRad, "deg");
      lines.addVector(QObject::tr("peak"), p.brightest.pixel, "px");
      lines.add(QObject::tr("coverage"), p.coverage);
    }
    if (row.metrics) {
      lines.addWithMeaning(QObject::tr("error"), row.metrics->contourErrorPct, "%",
                           QObject::tr("mean contour distance, symmetric, relative to the diameter"));
      lines.add(QObject::tr("mean distance"), row.metrics->contourErrorPx, "px");
      lines.add(QObject::tr("Hausdorff"), row.metrics->hausdorffPx, "px");
      lines.add(QObject::tr("peak offset"), row.metrics->peakOffsetPx, "px");
    }
    if (row.failure) lines.note(toQString(row.failure->message()));
  }
  if (!c.rows.empty()) lines.add(QObject::tr("IoU"), c.iou);
  return {QObject::tr("Prediction"), lines.text()};
}
/// What is selected of the frame, beside its model: highlight, light, point of the contours.
NumberGroup selectedParts(const Inspection& inspection, const draw::Selection& selection, const std::string& model) {
  Lines lines;
  if (selection.highlight >= 0) lines.add(QObject::tr("highlight"), QString::number(selection.highlight + 1));
  if (selection.predicted >= 0 && draw::selectedSpurious(inspection, selection))
    lines.add(QObject::tr("predicted highlight"), QString::number(selection.predicted + 1));
  if (!selection.light.empty()) lines.add(QObject::tr("light"), nameText(selection.light));
  if (const draw::UnmatchedRow found = draw::selectedUnmatched(inspection, selection, model); found.row) {
    const bool missed = found.row->observed >= 0;
    lines.note((missed ? QObject::tr("missed by %1: %2") : QObject::tr("spurious, predicted by %1: %2"))
                   .arg(toQString(selection.model.empty() ? model : selection.model),
                        toQString(whyUnmatched(inspection, *found.comparison, *found.row))));
  }
  if (selection.direction) {
    lines.add(QObject::tr("direction"),
              numberText(*selection.direction * kDegPerRad, 6) + QStringLiteral("° (0 right, 90 down)"));
    if (inspection.models.count(model))
      for (const PolarResidual& residual : polarResiduals(inspection, selection.frame, model)) {
        if (residual.samples.empty() || (selection.highlight >= 0 && residual.observed != selection.highlight)) continue;
        const auto distance = [&](const DirectionSample& sample) {
          return std::abs(std::remainder(sample.direction - *selection.direction, 2 * std::numbers::pi));
        };
        const auto nearest = std::min_element(residual.samples.begin(), residual.samples.end(),
                                              [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
        lines.addVector(QObject::tr("observed contour"), nearest->at, "px");
        if (nearest->value) lines.add(QObject::tr("signed distance to %1").arg(toQString(model)), *nearest->value, "px");
      }
  }
  return {QObject::tr("Selected"), lines.text()};
}
}  // namespace

std::vector<NumberGroup> describeSelection(const Inspection& inspection, const draw::Selection& selection,
                                           const std::string& model) {
  std::vector<NumberGroup> groups;
  const int frame = selection.frame;
  if (frame < 0 || frame >= int(inspection.evidence.size())) return groups;
  const FrameEvidence& evidence = inspection.evidence[std::size_t(frame)];
  if (selection.highlight >= 0 || selection.predicted >= 0 || !selection.light.empty() || selection.direction)
    groups.push_back(selectedParts(inspection, selection, model));
  const int count = int(evidence.highlights.size());
  const int observed = selection.highlight >= 0 && selection.highlight < count ? selection.highlight : count > 0 ? 0 : -1;
  groups.push_back(observation(evidence, observed, inspection.request.whatIf.synthesise));
  const std::string light = observed >= 0 ? evidence.highlights[std::size_t(observed)].light : std::string();
  for (const TrainingView& view : inspection.views)
    if (view.frame == frame && (observed < 0 || view.highlight.peak == evidence.highlights[std::size_t(observed)].peak))
      groups.push_back(trainingView(view));
  const auto result = inspection.models.find(model);
  const ModelFit* shown = nullptr;
  if (result != inspection.models.end()) {
    for (const FrameComparison& c : result->second.frames) {
      if (c.frame != frame || (!light.empty() && c.light != light)) continue;
      groups.push_back(comparison(c, observed));
      if (c.fit < 0 || c.fit >= int(result->second.fits.size())) continue;
      const ModelResult::Fit& fit = result->second.fits[std::size_t(c.fit)];
      groups.push_back(fitGroup(model, fit, frame));
      if (fit.fit) shown = &*fit.fit;
    }
  }
  const LightFrameChoice& choice = inspection.lightFrame;
  const bool tellsWhere = choice.anyMoves() || !choice.doubt.empty();  // first: no other number says that
  for (const auto& [id, estimate] : inspection.lightsFor(frame)) {
    if (*estimate && !light.empty() && id != light) continue;
    const LightEstimate* const common = *estimate ? &**estimate : nullptr;
    if (tellsWhere)
      groups.insert(groups.begin(), movingLamp(inspection, id, common, shown && shown->light == id ? shown : nullptr));
    groups.push_back(common ? lightGroup(id, *common, choice)
                            : NumberGroup{lightTitle(id), toQString(estimate->failure().message())});
  }
  for (NumberGroup& group : groups) group.lines = toQString(withoutFolder(group.lines.toStdString(), *inspection.scene));
  return groups;
}

}  // namespace glint::gui
