// SPDX-License-Identifier: BSD-3-Clause
#include "tests/core/properties/answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace glint::testing_support {
namespace {

class Comparison {
 public:
  Comparison(const Back& back, const std::string& scene, Differences& differences) : back_(back), scene_(scene), d_(differences) {}

  void light(const std::string& name, const Light& a, const Light& b) {
    if (a.atInfinity() || b.atInfinity()) {
      EXPECT_EQ(a.atInfinity(), b.atInfinity()) << scene_ << ": " << name;
      if (a.atInfinity() && b.atInfinity())
        note(name, (a.homogeneous().head<3>() - back_.linear * b.homogeneous().head<3>()).norm(), "");
      return;
    }
    note(name, (a.position() - back_.point(b.position())).norm() / a.position().norm(), "");
  }
  void ellipsoid(const std::string& name, const Ellipsoid& a, const Ellipsoid& b) {
    note(name + " centre", (a.centre() - back_.point(b.centre())).norm() / a.centre().norm(), "");
    const Eigen::Matrix3d there = back_.scale * back_.scale * back_.linear * b.shape() * back_.linear.transpose();
    note(name + " shape", (a.shape() - there).norm() / a.shape().norm(), "");
  }
  void number(const std::string& name, double a, double b, const std::string& where = "") { note(name, std::abs(b / a - 1), where); }
  void pixels(const std::string& name, double a, double b, const std::string& where) {
    if (std::isnan(a) && std::isnan(b)) return;
    note(name, std::abs(a - b), where);
  }
  /// Vertices one by one where both have as many, whatever the start and the sense; else distances of vertices from the other contour.
  void contour(const std::string& name, const Polyline& a, const Polyline& there, const std::string& where) {
    Polyline b = there;
    for (Pixel& p : b.points) p = back_.pixel(p);
    ++d_.contours;
    double worst = 0;
    for (const Pixel& p : b.points) worst = std::max(worst, distance(a, p));
    for (const Pixel& p : a.points) worst = std::max(worst, distance(b, p));
    note(name, worst, where);
  }

 private:
  void note(const std::string& name, double difference, const std::string& where) {
    double& worst = d_.worst[name];
    if (difference <= worst) return;
    worst = difference;  // NaN too: it stays, and no tolerance admits it
    d_.where[name] = scene_ + (where.empty() ? "" : ", frame " + where);
  }
  const Back& back_;
  const std::string& scene_;
  Differences& d_;
};

std::string reasonOf(const std::optional<Failure>& failure) { return failure ? failure->message() : "answered"; }

const FrameComparison* comparisonOf(const Inspection& r, const ModelResult& model, const std::string& frame, const std::string& light) {
  for (const FrameComparison& c : model.frames)
    if (c.light == light && r.scene->frames[static_cast<std::size_t>(c.frame)].id == frame) return &c;
  return nullptr;
}

}  // namespace

void compare(const Inspection& a, const Inspection& b, const Back& back, const std::string& scene, Differences& d) {
  Comparison c(back, scene, d);
  ASSERT_EQ(a.lights.size(), b.lights.size()) << scene;
  for (const auto& [key, light] : a.lights) {
    ASSERT_TRUE(b.lights.count(key)) << scene << ": light " << key;
    c.light("light", light.light, b.lights.at(key).light);
    c.number("limit angle", light.limitAngle, b.lights.at(key).limitAngle);
  }
  for (const auto& [name, model] : a.models) {
    const ModelResult& other = b.models.at(name);
    for (const ModelResult::Fit& f : model.fits) {
      const auto twin = std::find_if(other.fits.begin(), other.fits.end(), [&](const ModelResult::Fit& o) { return o.light == f.light; });
      ASSERT_TRUE(twin != other.fits.end()) << scene << ": " << name;
      EXPECT_EQ(f.fit.has_value(), twin->fit.has_value()) << scene << ": " << name << ": " << reasonOf(f.failure) << " | " << reasonOf(twin->failure);
      if (f.failure && twin->failure) {
        EXPECT_EQ(f.failure->reason, twin->failure->reason) << scene << ": " << name;
      }
      if (!f.fit || !twin->fit) continue;
      ++d.fits;
      ++d.answered[name];
      EXPECT_EQ(f.fit->solver, twin->fit->solver) << scene << ": " << name;
      EXPECT_EQ(f.fit->ellipsoid.has_value(), twin->fit->ellipsoid.has_value()) << scene << ": " << name;
      if (f.fit->ellipsoid && twin->fit->ellipsoid) c.ellipsoid(name + ": ellipsoid's", *f.fit->ellipsoid, *twin->fit->ellipsoid);
      if (f.fit->lightEstimate && twin->fit->lightEstimate) c.light(name + ": light", *f.fit->lightEstimate, *twin->fit->lightEstimate);
      if (f.fit->limitAngle && twin->fit->limitAngle) c.number(name + ": limit angle", *f.fit->limitAngle, *twin->fit->limitAngle);
      EXPECT_EQ(f.fit->lobe, twin->fit->lobe) << scene << ": " << name;
      if (f.fit->roughness && twin->fit->roughness) c.number(name + ": roughness", *f.fit->roughness, *twin->fit->roughness);
      EXPECT_EQ(f.fit->lightRadius.has_value(), twin->fit->lightRadius.has_value()) << scene << ": " << name;
      EXPECT_EQ(f.fit->lightSegment.has_value(), twin->fit->lightSegment.has_value()) << scene << ": " << name;
      EXPECT_EQ(f.fit->extent.has_value(), twin->fit->extent.has_value()) << scene << ": " << name;
    }
    for (const FrameComparison& here : model.frames) {
      const std::string frame = a.scene->frames[static_cast<std::size_t>(here.frame)].id;
      const FrameComparison* there = comparisonOf(b, other, frame, here.light);
      ASSERT_TRUE(there) << scene << ": " << name << ", frame " << frame;
      EXPECT_EQ(here.prediction.highlights.size(), there->prediction.highlights.size())
          << scene << ": " << name << ", frame " << frame << ": " << reasonOf(here.prediction.failure) << " | " << reasonOf(there->prediction.failure);
      for (std::size_t i = 0; i < std::min(here.prediction.highlights.size(), there->prediction.highlights.size()); ++i)
        c.contour(name + ": contour, px", here.prediction.highlights[i].contour, there->prediction.highlights[i].contour, frame);
      EXPECT_EQ(here.rows.size(), there->rows.size()) << scene << ": " << name << ", frame " << frame;
      for (std::size_t i = 0; i < std::min(here.rows.size(), there->rows.size()); ++i) {
        EXPECT_EQ(here.rows[i].metrics.has_value(), there->rows[i].metrics.has_value()) << scene << ": " << name << ", frame " << frame;
        if (!here.rows[i].metrics || !there->rows[i].metrics) continue;
        const ContourMetrics &m = *here.rows[i].metrics, &n = *there->rows[i].metrics;
        const double zoom = std::abs(back.pixelFactor.y());
        c.pixels(name + ": error, px", m.contourErrorPx, zoom * n.contourErrorPx, frame);
        c.pixels(name + ": peak offset, px", m.peakOffsetPx, zoom * n.peakOffsetPx, frame);
        c.pixels(name + ": ellipse error, %", m.ellipseErrorPct, n.ellipseErrorPct, frame);
        c.pixels(name + ": IoU", m.iou, n.iou, frame);
      }
    }
  }
}

}  // namespace glint::testing_support
