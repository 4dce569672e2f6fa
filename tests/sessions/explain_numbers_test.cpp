// SPDX-License-Identifier: BSD-3-Clause
// Every number of every Explain step, in every frame of every lesson, against geometry of its own: the surfaces as equations F =
// 0, rays met by bisection, normals and curvatures by differences, ways on contours by search. A number without a check is a
// failure.
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <functional>
#include <numbers>

#include "tests/sessions/taught.h"

namespace glint::explain_numbers {

using namespace taught;
using Vec = Eigen::Vector3d;

constexpr double kDegree = 180 / std::numbers::pi;

/// A surface F = 0, positive towards the cameras.
using Body = std::function<double(const Vec&)>;

Body sheet(double k) {
  return [k](const Vec& p) { return k * (p.x() * p.x() + p.z() * p.z()) / 2 + p.z(); };
}
Body ball() {
  return [](const Vec& p) { return (p - Vec(0, 0, -0.5)).norm() - 0.5; };
}
Body vase() {
  return [](const Vec& p) { return std::hypot(p.x(), p.y()) - (0.22 - 0.05 * std::cos(2 * std::numbers::pi / 0.6 * p.z())); };
}

/// In the coordinates of a camera that goes around it.
Body turningBody(int frame) {
  return [bodyFromCamera = movingLampCamera(frame).inverse()](const Vec& p) {
    return (bodyFromCamera * p).cwiseQuotient(kMovingLampBody).norm() - 1;
  };
}

/// As the lessons' specifications say.
Body bodyOf(const std::string& id, int frame) {
  static const std::map<std::string, std::vector<double>> bends{
      {"moving-highlight", {0, 1}}, {"bent-mirror", {-0.2, 0, 0.5, 1, 2}}, {"plane-to-cylinder", {0, 0.5, 1, 1.5, 2}}};
  if (id == "sphere") return ball();
  if (id == "waist") return vase();
  if (id == "moving-lamp") return turningBody(frame);
  const auto it = bends.find(id);
  if (it == bends.end()) return sheet(0);
  const int each = id == "moving-highlight" ? 5 : id == "bent-mirror" ? 3 : 4;
  return sheet(it->second.at(std::size_t(frame / each)));
}

Vec normalAt(const Body& f, const Vec& p) {
  constexpr double h = 1e-6;
  return Vec(f(p + Vec(h, 0, 0)) - f(p - Vec(h, 0, 0)), f(p + Vec(0, h, 0)) - f(p - Vec(0, h, 0)),
             f(p + Vec(0, 0, h)) - f(p - Vec(0, 0, h)))
      .normalized();
}

/// First place where a ray meets the surface: in steps, then by bisection.
Vec meet(const Body& f, const Vec& eye, const Vec& direction) {
  constexpr double kStep = 2e-2;  // m
  double t = 0.3;
  while (t < 5 && f(eye + (t + kStep) * direction) > 0) t += kStep;
  double from = t, to = t + kStep;
  for (int i = 0; i < 60; ++i) (f(eye + (from + to) / 2 * direction) > 0 ? from : to) = (from + to) / 2;
  return eye + to * direction;
}

double angle(const Vec& a, const Vec& b) { return kDegree * std::atan2(a.cross(b).norm(), a.dot(b)); }

struct Bend {
  double most, least;  // by their size
  Vec mostAlong, leastAlong;
};

Bend bendAt(const Body& f, const Vec& p) {
  constexpr double h = 1e-4;  // m
  const Vec n = normalAt(f, p), u = n.unitOrthogonal(), v = n.cross(u);
  Eigen::Matrix2d shape;
  const Vec du = (normalAt(f, p + h * u) - normalAt(f, p - h * u)) / (2 * h),
            dv = (normalAt(f, p + h * v) - normalAt(f, p - h * v)) / (2 * h);
  shape << du.dot(u), (du.dot(v) + dv.dot(u)) / 2, 0, dv.dot(v);
  shape(1, 0) = shape(0, 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solved(shape);
  const auto along = [&](int i) { return Vec(solved.eigenvectors()(0, i) * u + solved.eigenvectors()(1, i) * v); };
  const int most = std::abs(solved.eigenvalues()(0)) > std::abs(solved.eigenvalues()(1)) ? 0 : 1;
  return {solved.eigenvalues()(most), solved.eigenvalues()(1 - most), along(most), along(1 - most)};
}

using Points = std::vector<Pixel>;

double areaOf(const Points& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    sum += (p[i].x() * p[(i + 1) % p.size()].y() - p[(i + 1) % p.size()].x() * p[i].y()) / 2;
  return std::abs(sum);
}

bool inside(const Points& p, const Pixel& at) {
  bool in = false;
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++)
    if ((p[i].y() > at.y()) != (p[j].y() > at.y()) &&
        at.x() < (p[j].x() - p[i].x()) * (at.y() - p[i].y()) / (p[j].y() - p[i].y()) + p[i].x())
      in = !in;
  return in;
}

/// Semi-axes of the ellipse with a polygon's second moments of area, the longer first.
Pixel axesOf(const Points& p) {
  Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
  Pixel first(0, 0);
  double area = 0;
  const Pixel origin = p[0];
  for (std::size_t i = 0; i < p.size(); ++i) {  // triangles from the first point
    const Pixel a = p[i] - origin, b = p[(i + 1) % p.size()] - origin;
    const double twice = a.x() * b.y() - a.y() * b.x();
    area += twice / 2;
    first += twice / 6 * (a + b);
    moments += twice / 24 * (a * a.transpose() + b * b.transpose() + (a + b) * (a + b).transpose());
  }
  const Pixel mean = first / area;
  const Eigen::Vector2d spread = (moments / area - mean * mean.transpose()).eval().selfadjointView<Eigen::Lower>().eigenvalues();
  return {2 * std::sqrt(spread(1)), 2 * std::sqrt(spread(0))};
}

double away(const Points& p, const Pixel& from) {
  double least = 1e9;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Pixel a = p[i], b = p[(i + 1) % p.size()] - a;
    const double t = b.squaredNorm() > 0 ? std::clamp((from - a).dot(b) / b.squaredNorm(), 0.0, 1.0) : 0;
    least = std::min(least, (a + t * b - from).norm());
  }
  return least;
}

/// Mean distance of one contour's arc from another, at steps of a pixel.
double meanAway(const Points& from, const Points& to) {
  double sum = 0, length = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Pixel a = from[i], b = from[(i + 1) % from.size()];
    const int steps = std::max(1, int((b - a).norm()));
    for (int k = 0; k < steps; ++k) {
      const double l = (b - a).norm() / steps;
      sum += l * away(to, a + (k + 0.5) / steps * (b - a));
      length += l;
    }
  }
  return sum / length;
}

/// One frame, highlight and model of a lesson, seen with this file's own means.
struct Seen {
  const std::string& id;
  const Inspection& in;
  const Explanation& e;
  Body body = bodyOf(id, e.frame);
  Vec lamp = in.scene->lights.at(0).lamp.position();
  const Camera& camera = in.scene->frames[std::size_t(e.frame)].camera;
  Eigen::Isometry3d pose{camera.camFromWorld};
  Vec eye = -(pose.linear().transpose() * pose.translation());
  const Highlight& highlight = e.view->highlight;
  const Points& contour = highlight.contour.points;
  Vec at = meet(body, eye, rayOf(highlight.peak)), normal = normalAt(body, at), view = (eye - at).normalized();
  Bend bend = bendAt(body, at);
  bool mesh() const { return id == "waist"; }
  bool umbilic() const { return std::abs(bend.most - bend.least) < 1e-3; }

  Vec rayOf(const Pixel& p) const {
    return (pose.linear().transpose() * (camera.pixelFromRay.inverse() * p.homogeneous())).normalized();
  }
  Pixel pixelOf(const Vec& p) const { return (camera.pixelFromRay * (pose * p)).hnormalized(); }
  Vec mirrored(const Vec& place) const {
    const Vec n = normalAt(body, place), v = (eye - place).normalized();
    return 2 * n.dot(v) * n - v;
  }
  double alpha(const Vec& place, const Vec& n) const {
    return angle(n, (eye - place).normalized() + (lamp - place).normalized());
  }
  Vec direction(bool first) const {
    if (!umbilic()) return first ? bend.mostAlong : bend.leastAlong;
    const Vec slant = (view - normal.dot(view) * normal).normalized();
    return first ? slant : Vec(normal.cross(slant));
  }
  /// Rays to both ends of the highlight in a direction: out from P_B until the pixel leaves the contour.
  std::array<Vec, 2> ends(bool first) const {
    std::array<Vec, 2> rays;
    for (const int side : {0, 1}) {
      const Vec out = (side ? -1 : 1) * direction(first);
      double from = 0, to = 0;
      for (double s = 0; s < 0.6; s += 4e-3)
        if (inside(contour, pixelOf(at + s * out))) from = s, to = s + 4e-3;
      for (int i = 0; i < 50; ++i) (inside(contour, pixelOf(at + (from + to) / 2 * out)) ? from : to) = (from + to) / 2;
      rays[std::size_t(side)] = (at + from * out - eye).normalized();
    }
    return rays;
  }
  double flatField(bool first) const { return angle(ends(first)[0], ends(first)[1]); }
  double bentField(bool first) const {
    const auto rays = ends(first);
    return angle(mirrored(meet(body, eye, rays[0])), mirrored(meet(body, eye, rays[1])));
  }
  /// Where two neighbouring rays that are reflected come from.
  double image(bool first) const {
    const Vec step = 2e-4 * direction(first);
    const Vec a = meet(body, eye, (at - step - eye).normalized()), b = meet(body, eye, (at + step - eye).normalized());
    const Vec ra = mirrored(a), rb = mirrored(b), chief = mirrored(at), apart = (b - a) - chief.dot(b - a) * chief;
    return apart.squaredNorm() / apart.dot(rb - ra);
  }
  double largestTurn() const {
    double most = 0;
    for (const Pixel& p : contour) most = std::max(most, angle(normal, normalAt(body, meet(body, eye, rayOf(p)))));
    return most;
  }
  std::pair<double, double> limits() const {
    double least = 1e9, most = 0;
    for (const Pixel& p : contour) {
      const Vec place = meet(body, eye, rayOf(p));
      least = std::min(least, alpha(place, normalAt(body, place)));
      most = std::max(most, alpha(place, normalAt(body, place)));
    }
    return {least, most};
  }
  /// What a flat mirror at P_B would show: on T, out to where the angle is the limit.
  Points flatContour() const {
    const double limit = (limits().first + limits().second) / 2;
    const Vec u = normal.unitOrthogonal(), v = normal.cross(u);
    Points all;
    for (int i = 0; i < 360; ++i) {
      const Vec out = std::cos(i / kDegree) * u + std::sin(i / kDegree) * v;
      double from = 0, to = 1;
      for (int k = 0; k < 50; ++k) (alpha(at + (from + to) / 2 * out, normal) < limit ? from : to) = (from + to) / 2;
      all.push_back(pixelOf(at + to * out));
    }
    return all;
  }
  const ModelResult& model() const { return in.models.at(e.model); }
  const FrameComparison* comparison() const {
    for (const FrameComparison& c : model().frames)
      if (c.frame == e.frame) return &c;
    return nullptr;
  }
  const PredictedHighlight* predicted() const {
    for (const FrameComparison::Row& row : comparison()->rows)
      if (row.observed == e.highlight && row.predicted >= 0)
        return &comparison()->prediction.highlights()[std::size_t(row.predicted)];
    return nullptr;
  }
};

/// What a number has to be, and how near: values may be an upper or lower bound of it.
struct Expected {
  std::vector<double> values;
  double tolerance;  // absolute
};
using Check = std::function<std::optional<Expected>(const Seen&)>;

Expected near(double value, double tolerance) { return {{value}, tolerance}; }
Expected near(const Vec& v, double tolerance) { return {{v.x(), v.y(), v.z()}, tolerance}; }
Expected near(const Pixel& p, double tolerance) { return {{p.x(), p.y()}, tolerance}; }

/// A contour that is an ellipse: what a fit to it and the moments of its area tell is the same then.
std::optional<Expected> axes(const Points& p) {
  const Pixel a = axesOf(p);
  if (std::abs(areaOf(p) / (std::numbers::pi * a.prod()) - 1) > 2e-3) return std::nullopt;
  return near(a, 0.01 * a.x());
}

double rmsAway(const Points& from, const Ellipse& ellipse) {
  const Points dense = ellipse.sample(2000);
  double sum = 0;
  for (const Pixel& p : from) sum += std::pow(away(dense, p), 2);
  return std::sqrt(sum / double(from.size()));
}

/// Tolerances: contours and peaks are stored to 0.001 px; the vase's mesh is 1e-4 m from its equation, and its bends are told by
/// facets.
void addGeometry(std::map<std::string, Check>& all) {
  const auto place = [](const Seen& s) { return s.mesh() ? 3e-4 : 1e-5; };  // m
  const auto turned = [](const Seen& s) { return s.mesh() ? 0.5 : 2e-3; };  // deg
  all["peak/peak in the photograph"] = [](const Seen& s) -> std::optional<Expected> {
    if (s.mesh()) return std::nullopt;  // mirror points of the vase come and go: WaistTheHighlightSplits...
    // The pixel at which the ray meets the lamp by reflection, from the tabled one by Newton's method on the surface.
    Vec p = s.at;
    for (int i = 0; i < 50; ++i) {
      const Vec n = normalAt(s.body, p), half = ((s.eye - p).normalized() + (s.lamp - p).normalized()).normalized();
      p += 0.3 * (half - n.dot(half) * n);
      p = meet(s.body, s.eye, (p - s.eye).normalized());
    }
    return near(s.pixelOf(p), 0.02);
  };
  all["peak/brightest point"] = [=](const Seen& s) { return near(s.at, place(s)); };
  for (const char* name : {"peak/distance from the camera", "virtual-camera/distance of the camera from P_B"})
    all[name] = [=](const Seen& s) { return near((s.eye - s.at).norm(), place(s)); };
  all["tangent-plane/normal at P_B"] = [=](const Seen& s) { return near(s.normal, turned(s) / kDegree); };
  for (const char* step : {"tangent-plane", "virtual-camera"})
    all[std::string(step) + "/angle between N and the view ray"] = [=](const Seen& s) {
      return near(angle(s.normal, s.view), turned(s));
    };
  all["tangent-plane/principal curvature"] = [](const Seen& s) {
    // One number has this name twice: the larger is k1.
    return Expected{{std::max(s.bend.most, s.bend.least), std::min(s.bend.most, s.bend.least)}, s.mesh() ? 0.3 : 1e-4};
  };
  all["virtual-camera/camera centre"] = [](const Seen& s) { return near(s.eye, 1e-9); };
  all["virtual-camera/centre of the virtual camera"] = [=](const Seen& s) {
    return near(Vec(s.eye - 2 * s.normal.dot(s.eye - s.at) * s.normal), 2 * turned(s) / kDegree + place(s));
  };
  all["virtual-camera/of the mirror's 3x3 block"] = [](const Seen&) { return near(-1, 1e-9); };
  all["virtual-camera/distance of the light from P_B"] = [](const Seen& s) { return near((s.lamp - s.at).norm(), 5e-3); };
  for (const bool first : {true, false})
    for (const bool umbilic : {true, false}) {
      const std::string way = umbilic ? (first ? "in the plane of incidence" : "across the plane of incidence")
                                      : (first ? "in the most bent direction" : "in the least bent direction");
      const auto own = [umbilic](const std::function<Expected(const Seen&)>& tell) -> Check {
        return [=](const Seen& s) -> std::optional<Expected> {
          EXPECT_EQ(s.umbilic(), umbilic);
          return tell(s);
        };
      };
      const auto share = [](const Seen& s) { return s.mesh() ? 0.03 : 1e-3; };
      all["virtual-camera/field of view " + way + ", flat mirror"] =
          own([=](const Seen& s) { return near(s.flatField(first), share(s) * s.flatField(first)); });
      all["virtual-camera/field of view " + way + ", this mirror"] =
          own([=](const Seen& s) { return near(s.bentField(first), share(s) * s.bentField(first) + (s.mesh() ? 0.5 : 0)); });
    }
  all["virtual-camera/image of the camera, behind P_B in that direction"] = [](const Seen& s) {
    const double a = s.image(true), b = s.image(false), most = std::max(std::abs(a), std::abs(b));
    // 1/d' takes twice the error of a curvature.
    return Expected{{a, b}, s.mesh() ? 2 * 0.3 * most * most : 2e-3 * most};
  };
  all["virtual-camera/largest turn of the normal from P_B to the contour"] = [](const Seen& s) {
    return near(s.largestTurn(), s.mesh() ? 0.5 : 5e-3);
  };
}

void addContours(std::map<std::string, Check>& all) {
  all["contour/level, share of the peak"] = [](const Seen&) { return near(0.5, 0); };
  all["contour/area"] = [](const Seen& s) { return near(areaOf(s.contour), 1e-6 * areaOf(s.contour)); };
  all["contour/semi-axes of its ellipse"] = [](const Seen& s) { return axes(s.contour); };
  all["contour/distance of the contour from its ellipse"] = [](const Seen& s) {
    return near(rmsAway(s.contour, *s.highlight.ellipse), 1e-3 + 0.02 * rmsAway(s.contour, *s.highlight.ellipse));
  };
  all["limit-angles/directions"] = [](const Seen&) { return near(36, 0); };
  all["limit-angles/reached the contour"] = [](const Seen& s) -> std::optional<Expected> {
    return s.mesh() ? std::nullopt : std::optional(near(36, 0));
  };
  // 36 directions see a little less than the whole contour does.
  all["limit-angles/smallest limit angle"] = [](const Seen& s) { return near(s.limits().first, s.mesh() ? 1.0 : 0.02); };
  all["limit-angles/largest limit angle"] = [](const Seen& s) { return near(s.limits().second, s.mesh() ? 1.0 : 0.02); };
  all["canonical-ellipse/semi-axes of the canonical ellipse"] = [](const Seen& s) -> std::optional<Expected> {
    return s.mesh() ? std::nullopt : axes(s.flatContour());
  };
  all["canonical-ellipse/relative to the observed"] = [](const Seen& s) -> std::optional<Expected> {
    const auto flat = s.mesh() ? std::nullopt : axes(s.flatContour()), own = axes(s.contour);
    if (!flat || !own) return std::nullopt;
    return Expected{{flat->values[0] / own->values[0], flat->values[1] / own->values[1]},
                    0.02 * flat->values[1] / own->values[1]};
  };
  all["canonical-ellipse/distance of the canonical points from it"] = [](const Seen& s) {
    const CanonicalContour& c = *s.e.view->canonical;
    return near(rmsAway(c.pixels, *c.ellipse), 1e-3 + 0.02 * rmsAway(c.pixels, *c.ellipse));
  };
}

void addLight(std::map<std::string, Check>& all) {
  all["light/light"] = [](const Seen& s) { return near(s.lamp, 5e-3); };
  const auto rays = [](const Seen& s) {
    std::vector<Vec> found;
    for (std::size_t i = 0; i < s.in.scene->frames.size(); ++i) {
      const int frame = int(i);
      if (!s.in.isTraining(frame) || !(s.in.keyFor(frame, "lamp") == s.in.keyFor(s.e.frame, "lamp"))) continue;
      for (int h = 0; h < int(s.in.evidence[i].highlights.size()); ++h) {
        const Explanation other = explain(s.in, frame, h, s.e.model);
        if (!other.view) continue;
        const Seen there{s.id, s.in, other};
        found.push_back(there.mirrored(there.at));
      }
    }
    return found;
  };
  all["light/reflected rays"] = [=](const Seen& s) { return near(double(rays(s).size()), 0); };
  all["light/widest angle between them"] = [=](const Seen& s) {
    double widest = 0;
    const std::vector<Vec> found = rays(s);
    for (const Vec& a : found)
      for (const Vec& b : found) widest = std::max(widest, angle(a, b));
    return near(widest, s.mesh() ? 1.0 : 0.01);
  };
  all["light/of L, largest axis: noise only"] = [](const Seen& s) {
    const Eigen::Matrix3d c = *s.in.lightFor(s.e.frame, "lamp")->covariance;
    return near(std::sqrt(Eigen::JacobiSVD<Eigen::Matrix3d>(c).singularValues()(0)), 1e-9);
  };
  all["light/distance from the true light"] = [](const Seen& s) {
    for (const ExplainNumber& n : stepOf(s.e, "light").numbers)
      if (n.name == "light") return near((Vec(n.values[0], n.values[1], n.values[2]) - s.lamp).norm(), 1e-9);
    return near(std::nan(""), 0);
  };
}

/// Predictions: what they are is the models' business; that the numbers are those of the contours that are drawn is checked here.
void addPredictions(std::map<std::string, Check>& all) {
  const auto drawn = [](const Seen& s) { return s.predicted()->contour.points; };
  all["projection/from the observed peak"] = [](const Seen& s) {
    return near((s.predicted()->brightest.pixel - s.highlight.peak).norm(), 1e-9);
  };
  all["comparison/offset of the peaks"] = all["comparison/its centre from the peak"] = all["projection/from the observed peak"];
  all["comparison/mean distance of the contours"] = [=](const Seen& s) {
    const double d = (meanAway(s.contour, drawn(s)) + meanAway(drawn(s), s.contour)) / 2;
    return near(d, 2e-3 + 0.02 * d);
  };
  all["comparison/of the equivalent diameter"] = [=](const Seen& s) {
    const double d = (meanAway(s.contour, drawn(s)) + meanAway(drawn(s), s.contour)) / 2,
                 pct = 100 * d / (2 * std::sqrt(areaOf(s.contour) / std::numbers::pi));
    return near(pct, 0.02 + 0.02 * pct);
  };
  all["comparison/overlap of all regions of this light"] = [=](const Seen& s) -> std::optional<Expected> {
    if (s.in.evidence[std::size_t(s.e.frame)].highlights.size() > 1 || s.comparison()->prediction.highlights().size() > 1)
      return std::nullopt;
    Eigen::AlignedBox2d box;
    for (const Points& points : {s.contour, drawn(s)})
      for (const Pixel& p : points) box.extend(p);
    double both = 0, either = 0;
    for (double x = box.min().x(); x < box.max().x(); x += 0.25)
      for (double y = box.min().y(); y < box.max().y(); y += 0.25) {
        const bool a = inside(s.contour, {x, y}), b = inside(drawn(s), {x, y});
        both += a && b;
        either += a || b;
      }
    return near(both / either, 0.01);
  };
}

/// Those of a fit, of no view's geometry: the tests of the models and of this folder's lessons hold them against truth.
const std::vector<std::string>& ofTheFit() {
  static const std::vector<std::string> names{"ellipsoid/highlights used",
                                              "ellipsoid/centre",
                                              "ellipsoid/semi-axes",
                                              "ellipsoid/limit angle",
                                              "ellipsoid/last over second-last singular value",
                                              "ellipsoid/largest mean distance in a training frame",
                                              "ellipsoid/largest distance from a training contour to its outline, one way",
                                              "ellipsoid/largest distance of a training contour from its level set",
                                              "projection/predicted brightest point",
                                              "projection/centre of the predicted outline",
                                              "projection/semi-axes of the predicted ellipse",
                                              "projection/semi-axes of the ellipse that a flat mirror would show",
                                              "inverse-walk/points of the predicted contour",
                                              "inverse-walk/of directions gave a point",
                                              "inverse-walk/semi-axes of the resulting ellipse"};
  return names;
}

const std::map<std::string, Check>& checks() {
  static const std::map<std::string, Check> all = [] {
    std::map<std::string, Check> made;
    addGeometry(made);
    addContours(made);
    addLight(made);
    addPredictions(made);
    return made;
  }();
  return all;
}

class ExplainNumbers : public testing::TestWithParam<const char*> {};

TEST_P(ExplainNumbers, AreThoseOfTheScenesGeometry) {
  const std::string id = GetParam();
  const Inspection& in = lesson(id).inspection;
  std::map<std::string, int> checked;
  for (int frame = 0; frame < int(in.scene->frames.size()); ++frame)
    for (int h = 0; h < int(in.evidence[std::size_t(frame)].highlights.size()); ++h)
      for (const auto& [model, result] : in.models) {
        const Explanation e = explain(in, frame, h, model);
        ASSERT_TRUE(e.view && e.view->seen);
        const Seen seen{id, in, e};
        for (const ExplainStep& step : e.steps) {
          // What does not depend on the model is checked with one of them.
          if (model != in.models.begin()->first && step.id != "comparison" && step.id != "projection") continue;
          std::map<std::string, std::size_t> before;  // of the same name: k1 and k2
          for (const ExplainNumber& n : step.numbers) {
            const std::string name = step.id + '/' + n.name;
            if (std::find(ofTheFit().begin(), ofTheFit().end(), name) != ofTheFit().end()) continue;
            const auto check = checks().find(name);
            ASSERT_TRUE(check != checks().end()) << "no check of \"" << name << '"';
            if ((step.id == "comparison" || step.id == "projection") && (!seen.predicted() || !seen.predicted()->gaps.empty()))
              continue;  // missed, or not drawn all around
            const std::optional<Expected> expected = check->second(seen);
            const std::size_t from = before[name];
            before[name] += n.values.size();
            if (!expected) continue;
            ++checked[name];
            for (std::size_t i = 0; i < n.values.size(); ++i)
              EXPECT_NEAR(n.values[i], expected->values.at(from + i), expected->tolerance)
                  << id << " frame " << frame << " highlight " << h << ' ' << model << ' ' << name;
          }
        }
      }
  for (const auto& [name, count] : checked) RecordProperty(std::string(name), count);  // the list
  EXPECT_GT(checked.size(), 25u);
}

INSTANTIATE_TEST_SUITE_P(Lessons, ExplainNumbers,
                         testing::Values("moving-highlight", "mirror", "plane", "sphere", "bent-mirror", "plane-to-cylinder",
                                         "waist", "moving-lamp"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace glint::explain_numbers
