// SPDX-License-Identifier: BSD-3-Clause
#include "tests/core/properties/answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace glint::testing_support {
namespace {

class Comparison {
 public:
  Comparison(const Back& back, const std::string& scene, Differences& differences)
      : back_(back), scene_(scene), d_(differences) {}

  void light(const std::string& model, const Light& a, const Light& b) {
    if (a.atInfinity() || b.atInfinity()) {
      EXPECT_EQ(a.atInfinity(), b.atInfinity()) << scene_ << ": " << model;
      if (a.atInfinity() && b.atInfinity())
        note(model, Quantity::Light, (a.homogeneous().head<3>() - back_.linear * b.homogeneous().head<3>()).norm());
      return;
    }
    note(model, Quantity::Light, (a.position() - back_.point(b.position())).norm() / a.position().norm());
  }
  void ellipsoid(const std::string& model, const Ellipsoid& a, const Ellipsoid& b) {
    note(model, Quantity::Centre, (a.centre() - back_.point(b.centre())).norm() / a.centre().norm());
    const Eigen::Matrix3d there = back_.scale * back_.scale * back_.linear * b.shape() * back_.linear.transpose();
    note(model, Quantity::Shape, (a.shape() - there).norm() / a.shape().norm());
  }
  void relative(const std::string& model, Quantity quantity, double a, double b) { note(model, quantity, std::abs(b / a - 1)); }
  void absolute(const std::string& model, Quantity quantity, double a, double b, const std::string& frame) {
    if (!(std::isnan(a) && std::isnan(b))) note(model, quantity, std::abs(a - b), frame);
  }
  /// As curves: vertices of each from the other one, whatever the start and the sense.
  void contour(const std::string& model, const Polyline& a, const Polyline& there, const std::string& frame) {
    Polyline b = there;
    for (Pixel& p : b.points) p = back_.pixel(p);
    ++d_.contours[model];
    double worst = 0;
    for (const Pixel& p : b.points) worst = std::max(worst, distance(a, p));
    for (const Pixel& p : a.points) worst = std::max(worst, distance(b, p));
    note(model, Quantity::ContourPx, worst, frame);
  }

 private:
  void note(const std::string& model, Quantity quantity, double difference, const std::string& frame = "") {
    Differences::Worst& worst = d_.worst[{model, quantity}];
    // NaN is the worst: it stays, and no tolerance admits it.
    if (std::isnan(worst.difference) || difference <= worst.difference) return;
    worst = {difference, scene_ + (frame.empty() ? "" : ", frame " + frame)};
  }
  const Back& back_;
  const std::string& scene_;
  Differences& d_;
};

std::string textOf(const Failure* failure) { return failure ? failure->message() : "answered"; }

const FrameComparison* comparisonOf(const Inspection& r, const ModelResult& model, const std::string& frame,
                                    const std::string& light) {
  for (const FrameComparison& c : model.frames)
    if (c.light == light && r.scene->frames[static_cast<std::size_t>(c.frame)].id == frame) return &c;
  return nullptr;
}

void compareFits(const ModelFit& a, const ModelFit& b, const std::string& model, const std::string& place, Comparison& c) {
  EXPECT_EQ(a.solver, b.solver) << place;
  EXPECT_EQ(a.family.index(), b.family.index()) << place;
  EXPECT_EQ(!a.ellipsoid(), !b.ellipsoid()) << place;
  EXPECT_EQ(a.lightEstimate.has_value(), b.lightEstimate.has_value()) << place;
  if (a.ellipsoid() && b.ellipsoid()) c.ellipsoid(model, *a.ellipsoid(), *b.ellipsoid());
  if (a.lightEstimate && b.lightEstimate) c.light(model, *a.lightEstimate, *b.lightEstimate);
  if (a.limitAngle() && b.limitAngle()) c.relative(model, Quantity::LimitAngle, *a.limitAngle(), *b.limitAngle());
  if (const LimitAngleFit* p = a.as<LimitAngleFit>(), *q = b.as<LimitAngleFit>(); p && q) {
    EXPECT_EQ(p->extent.has_value(), q->extent.has_value()) << place;
  }
  if (const ReflectanceFit* p = a.as<ReflectanceFit>(), *q = b.as<ReflectanceFit>(); p && q) {
    EXPECT_EQ(p->lobe, q->lobe) << place;
    EXPECT_STREQ(nameOf(p->shape), nameOf(q->shape)) << place;
    c.relative(model, Quantity::Roughness, p->roughness, q->roughness);
  }
}

void compareFrames(const FrameComparison& a, const FrameComparison& b, const Back& back, const std::string& model,
                   const std::string& frame, const std::string& place, Comparison& c) {
  const auto &h = a.prediction.highlights(), &k = b.prediction.highlights();
  EXPECT_EQ(h.size(), k.size()) << place << ": " << textOf(a.prediction.failure()) << " | " << textOf(b.prediction.failure());
  for (std::size_t i = 0; i < std::min(h.size(), k.size()); ++i) c.contour(model, h[i].contour, k[i].contour, frame);
  EXPECT_EQ(a.rows.size(), b.rows.size()) << place;
  for (std::size_t i = 0; i < std::min(a.rows.size(), b.rows.size()); ++i) {
    EXPECT_EQ(a.rows[i].metrics.has_value(), b.rows[i].metrics.has_value()) << place;
    if (!a.rows[i].metrics || !b.rows[i].metrics) continue;
    const ContourMetrics &m = *a.rows[i].metrics, &n = *b.rows[i].metrics;
    const double factor = std::abs(back.pixelFactor.y());
    c.absolute(model, Quantity::ErrorPx, m.contourErrorPx, factor * n.contourErrorPx, frame);
    c.absolute(model, Quantity::PeakPx, m.peakOffsetPx, factor * n.peakOffsetPx, frame);
    c.absolute(model, Quantity::EllipsePct, m.ellipseErrorPct, n.ellipseErrorPct, frame);
    c.absolute(model, Quantity::Iou, m.iou, n.iou, frame);
  }
}

}  // namespace

const char* nameOf(Quantity quantity) {
  constexpr const char* kNames[kQuantities] = {
      "light",       "limit angle",      "roughness",           "ellipsoid's centre", "ellipsoid's shape",
      "contour, px", "peak's error, px", "contour's error, px", "ellipse's error, %", "IoU"};
  return kNames[static_cast<int>(quantity)];
}

void compare(const Inspection& a, const Inspection& b, const Back& back, const std::string& scene, Differences& d,
             const std::vector<std::string>& models) {
  Comparison c(back, scene, d);
  ASSERT_EQ(a.lights.size(), b.lights.size()) << scene;
  for (const auto& [key, light] : a.lights) {
    ASSERT_TRUE(b.lights.count(key) && bool(b.lights.at(key)) == bool(light)) << scene << ": light " << textOf(key);
    if (!models.empty() || !light) continue;
    c.light("all", light->light, b.lightOf(key)->light);
    c.relative("all", Quantity::LimitAngle, light->limitAngle, b.lightOf(key)->limitAngle);
  }
  for (const auto& [name, model] : a.models) {
    if (!models.empty() && std::find(models.begin(), models.end(), name) == models.end()) continue;
    const std::string place = scene + ": " + name;
    const ModelResult& other = b.models.at(name);
    for (const ModelResult::Fit& f : model.fits) {
      const auto twin =
          std::find_if(other.fits.begin(), other.fits.end(), [&](const ModelResult::Fit& o) { return o.light == f.light; });
      ASSERT_TRUE(twin != other.fits.end()) << place;
      EXPECT_EQ(bool(f.fit), bool(twin->fit)) << place << ": " << textOf(f.failure()) << " | " << textOf(twin->failure());
      if (f.failure() && twin->failure()) {
        EXPECT_EQ(f.failure()->reason, twin->failure()->reason) << place;
      }
      if (!f.fit || !twin->fit) continue;
      ++d.fits[name];
      compareFits(*f.fit, *twin->fit, name, place, c);
    }
    for (const FrameComparison& here : model.frames) {
      const std::string frame = a.scene->frames[static_cast<std::size_t>(here.frame)].id;
      const FrameComparison* there = comparisonOf(b, other, frame, here.light);
      ASSERT_TRUE(there) << place << ", frame " << frame;
      compareFrames(here, *there, back, name, frame, place + ", frame " + frame, c);
    }
  }
}

}  // namespace glint::testing_support
