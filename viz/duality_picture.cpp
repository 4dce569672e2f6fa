// SPDX-License-Identifier: BSD-3-Clause
#include "viz/duality_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/number_text.h"
#include "core/draw/colours.h"

namespace glint::viz {
namespace {

constexpr int kAround = 72;           // vertices of an outline
constexpr double kConeShown = 3.2;    // longest semi-axes, from where a cone touches back towards its camera
constexpr double kPlaneShown = 1.25;  // longest semi-axes, half the side of the lit plane
constexpr double kTubeShown = 1.5;    // of its wider semi-axis, to either side
constexpr double kRoom = 0.42;        // of the shorter side of a pane, for what it must show
constexpr double kMostWide = 1.7;     // of that: dual points beyond are listed as outside

struct Pane {
  Box box;
  Eigen::Vector3d centre;
  double pxPerMetre = 1;
  Eigen::Matrix3d look;  ///< rows: right, up, towards the eye
  Eigen::Vector2d at(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d v = pxPerMetre * (look * (p - centre));
    return {box.x + box.width / 2 + v.x(), box.y + box.height / 2 - v.y()};
  }
  Eigen::Vector3d eye() const { return look.row(2).transpose(); }
};

/// The first look: the mean cone comes from the left, a little from the front.
Eigen::Matrix3d lookOf(const Duality& d, const DualityLook& look) {
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();
  for (const Duality::View& v : d.views) towards += (v.apex - d.ellipsoid.centre()).normalized();
  if (!(towards.norm() > 1e-6 * double(d.views.size()))) towards = Eigen::Vector3d::UnitX();  // cameras all around
  towards.normalize();
  const Eigen::Vector3d up = std::abs(towards.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d side = towards.cross(up).normalized();
  const Eigen::Vector3d eye = (0.5 * towards + side + 0.25 * side.cross(towards)).normalized();
  const Eigen::Vector3d right = (-towards + towards.dot(eye) * eye).normalized();
  Eigen::Matrix3d base;
  base << right.transpose(), eye.cross(right).transpose(), eye.transpose();
  return Eigen::AngleAxisd(look.tilt, Eigen::Vector3d::UnitX()).toRotationMatrix() *
         Eigen::AngleAxisd(look.turn, Eigen::Vector3d::UnitY()).toRotationMatrix() * base;
}

struct Artist {
  const Duality& d;
  const DualityLook& look;
  Colour ink, faint, model;
  int strong = 0;
  DualityPicture out;

  void line(std::vector<Eigen::Vector2d> points, const Colour& colour, double width, Dash dash = Dash::Solid) {
    out.drawn.lines.push_back({std::move(points), colour, width, dash});
  }
  void area(std::vector<Eigen::Vector2d> points, const Colour& colour, double opacity) {
    out.drawn.lines.push_back({std::move(points), colour, 1, Dash::Solid, true, opacity});
  }

  /// Its outline, filled, and its three principal sections.
  void solid(const Pane& pane, const Ellipsoid& e, const Colour& colour) {
    const Eigen::Vector3d right = pane.look.row(0).transpose(), up = pane.look.row(1).transpose();
    std::vector<Eigen::Vector2d> rim;
    for (int i = 0; i <= kAround; ++i) {
      const double t = 2 * std::numbers::pi * i / kAround;
      const Eigen::Vector3d n = std::cos(t) * right + std::sin(t) * up, towards = e.shape() * n;
      const double reach = std::sqrt(n.dot(towards));
      if (reach > 0) rim.push_back(pane.at(e.centre() + towards / reach));
    }
    area(rim, colour, 0.22);
    line(rim, colour, 1.5);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Matrix3d axes = e.worldFromBody().linear() * e.semiAxes().asDiagonal();
      std::vector<Eigen::Vector2d> section;
      for (int i = 0; i <= kAround; ++i) {
        const double t = 2 * std::numbers::pi * i / kAround;
        section.push_back(pane.at(e.centre() + std::cos(t) * axes.col((k + 1) % 3) + std::sin(t) * axes.col((k + 2) % 3)));
      }
      line(section, colour, 0.8, Dash::Dotted);
    }
  }

  /// Dual of a flat ellipsoid: a tube along the axis that the ellipsoid lacks, cut off where the pane ends.
  void tube(const Pane& pane, const Colour& colour) {
    const Eigen::Matrix3d axes = d.ellipsoid.worldFromBody().linear();
    const double square = d.chart.radius * d.chart.radius, reach = kTubeShown * square / d.ellipsoid.semiAxes()(1);
    for (const double end : {-reach, reach}) {
      std::vector<Eigen::Vector2d> rim;
      for (int i = 0; i <= kAround; ++i) rim.push_back(pane.at(onTube(axes, square, i) + end * axes.col(2)));
      line(rim, colour, 1.5);
      area(rim, colour, 0.15);
    }
    for (int i = 0; i < kAround; i += 6)
      line({pane.at(onTube(axes, square, i) - reach * axes.col(2)), pane.at(onTube(axes, square, i) + reach * axes.col(2))},
           colour, 0.8, Dash::Dotted);
  }
  Eigen::Vector3d onTube(const Eigen::Matrix3d& axes, double square, int i) const {
    const double t = 2 * std::numbers::pi * i / kAround;
    return square / d.ellipsoid.semiAxes()(0) * std::cos(t) * axes.col(0) +
           square / d.ellipsoid.semiAxes()(1) * std::sin(t) * axes.col(1);
  }

  void cone(const Pane& pane, int index) {
    const Duality::View& view = d.views[std::size_t(index)];
    const bool own = index == strong;
    const double longest = d.ellipsoid.semiAxes()(0);
    const Colour& colour = own ? ink : faint;
    const std::size_t n = view.planes.size();
    std::vector<Eigen::Vector2d> ring;
    for (std::size_t i = 0; i < n; ++i) {
      const Duality::Touch& t = view.planes[i];
      const Eigen::Vector3d& next = view.planes[(i + 1) % n].at;
      ring.push_back(pane.at(t.at));
      out.planes.push_back({ring.back(), {index, int(i)}});
      const double back = std::min((t.at - view.apex).norm(), kConeShown * longest);
      if (own || i % 6 == 0) line({ring.back(), pane.at(t.at - back * t.cone.along)}, colour, own ? 1.0 : 0.6);
      if (!own) continue;
      // A tile of the plane about the line in which it touches: what lies behind is fainter.
      const Eigen::Vector3d across = t.cone.plane.normal.cross(t.cone.along);
      const double half = 0.45 * (next - t.at).norm();
      const std::vector<Eigen::Vector2d> tile{
          pane.at(t.at + half * across + half * t.cone.along), pane.at(t.at - half * across + half * t.cone.along),
          pane.at(t.at - half * across - 2 * half * t.cone.along), pane.at(t.at + half * across - 2 * half * t.cone.along)};
      area(tile, kVirtualCamera, t.cone.plane.normal.dot(pane.eye()) > 0 ? 0.55 : 0.2);
    }
    ring.push_back(ring.front());
    line(ring, colour, own ? 1.8 : 0.8);
  }

  void slice(const Pane& pane, int index) {
    const Duality::View& view = d.views[std::size_t(index)];
    const bool own = index == strong;
    std::vector<Eigen::Vector2d> ring;
    bool whole = true;
    const double wide = kMostWide * kRoom * std::min(pane.box.width, pane.box.height);
    const Eigen::Vector2d middle = pane.at(pane.centre);
    for (std::size_t i = 0; i < view.planes.size(); ++i) {
      const std::optional<Eigen::Vector3d>& y = view.planes[i].dual;
      const Eigen::Vector2d at = y ? pane.at(*y) : Eigen::Vector2d::Zero();
      if (!y || !at.allFinite() || (at - middle).norm() > wide) {
        ++out.outside;
        whole = false;
        continue;
      }
      ring.push_back(at);
      out.points.push_back({at, {index, int(i)}});
      out.drawn.dots.push_back({at, own ? kVirtualCamera : faint, own ? 3.2 : 1.6});
    }
    if (!whole || ring.empty()) return;
    if (own) area(ring, kVirtualCamera, 0.3);
    ring.push_back(ring.front());
    line(ring, own ? ink : faint, own ? 1.8 : 0.8);
  }

  void lit(const Pane& primal, const Pane& dual) {
    const Duality::Touch& t = d.views[std::size_t(look.lit.view)].planes[std::size_t(look.lit.plane)];
    const Eigen::Vector3d c = d.ellipsoid.centre(), across = t.cone.plane.normal.cross(t.cone.along);
    const double side = kPlaneShown * d.ellipsoid.semiAxes()(0);
    const std::vector<Eigen::Vector2d> sheet{
        primal.at(t.at + side * (across + t.cone.along)), primal.at(t.at + side * (-across + t.cone.along)),
        primal.at(t.at + side * (-across - t.cone.along)), primal.at(t.at + side * (across - t.cone.along)),
        primal.at(t.at + side * (across + t.cone.along))};
    area(sheet, kFailed, 0.3);
    line(sheet, kFailed, 1.5);
    const Eigen::Vector3d foot = c + t.away * t.cone.plane.normal;
    line({primal.at(c), primal.at(foot)}, kFailed, 2);
    out.drawn.dots.push_back({primal.at(t.at), kFailed, 4.5});
    word(primal, primal.at(foot), "h");
    if (!t.dual) return;
    line({dual.at(dual.centre), dual.at(*t.dual)}, kFailed, 2);
    out.drawn.dots.push_back({dual.at(*t.dual), kFailed, 5});
    word(dual, dual.at(*t.dual), "y = ρ² n / h");
  }

  /// Beside a point, away from the pane's middle.
  void word(const Pane& pane, const Eigen::Vector2d& at, const char* text) {
    const bool right = at.x() > pane.box.x + pane.box.width / 2;
    out.drawn.texts.push_back(
        {at + Eigen::Vector2d(right ? 8 : -8, -0.4 * look.textPx), text, ink, right ? Align::Left : Align::Right});
  }

  void title(const Pane& pane, const std::string& above, const std::string& below) {
    const Box& b = pane.box;
    out.drawn.texts.push_back({{b.x + 8, b.y + 1.3 * look.textPx}, above, ink, Align::Left, true});
    out.drawn.texts.push_back({{b.x + 8, b.y + b.height - 0.6 * look.textPx}, below, faint});
  }
};

std::string inMm(double metres) { return formatted("%.3g mm", 1000 * metres); }

}  // namespace

DualityPicture dualityPicture(const Duality& duality, const DualityLook& look) {
  Artist artist{duality,
                look,
                look.dark ? kTextOnDark : kTextOnLight,
                look.dark ? Colour{0.60, 0.62, 0.66} : Colour{0.42, 0.44, 0.47},
                modelColour(duality.model),
                0,
                {}};
  for (std::size_t i = 0; i < duality.views.size(); ++i)
    if (duality.views[i].frame == look.frame) artist.strong = int(i);
  const bool beside = look.width >= look.height;
  const double w = beside ? look.width / 2 : look.width, h = beside ? look.height : look.height / 2;
  const double room = kRoom * std::min(w, h);
  const Eigen::Matrix3d turned = lookOf(duality, look);
  // The cones come from the left: the ellipsoid is right of the middle.
  Pane primal{{0, 0, w, h}, duality.ellipsoid.centre(), 0.75 * room / duality.ellipsoid.semiAxes()(0), turned};
  const double square = duality.chart.radius * duality.chart.radius;
  const double widest = duality.dual ? duality.dual->semiAxes()(0) : kTubeShown * square / duality.ellipsoid.semiAxes()(1);
  Pane dual{{beside ? w : 0, beside ? 0 : h, w, h}, Eigen::Vector3d::Zero(), 0.85 * room / widest, turned};
  artist.solid(primal, duality.ellipsoid, artist.model);
  duality.dual ? artist.solid(dual, *duality.dual, artist.model) : artist.tube(dual, artist.model);
  for (int i = 0; i < int(duality.views.size()); ++i)
    if (i != artist.strong) artist.cone(primal, i), artist.slice(dual, i);
  artist.cone(primal, artist.strong);
  artist.slice(dual, artist.strong);
  const bool lit = look.lit.view >= 0 && look.lit.view < int(duality.views.size()) && look.lit.plane >= 0 &&
                   look.lit.plane < int(duality.views[std::size_t(look.lit.view)].planes.size());
  if (lit) artist.lit(primal, dual);
  artist.line(beside ? std::vector<Eigen::Vector2d>{{w, 6}, {w, h - 6}} : std::vector<Eigen::Vector2d>{{6, h}, {w - 6, h}},
              artist.faint, 0.6);
  artist.title(primal, "Planes that touch the cones", "from the ellipsoid: rms " + inMm(duality.rmsGap));
  std::string off =
      formatted(duality.dual ? "from the dual quadric: rms %.3g %%" : "from the tube: rms %.3g %%; the ellipsoid is flat",
                100 * duality.rmsOffDual);
  if (artist.out.outside > 0) off += formatted("; %d points lie outside", artist.out.outside);
  artist.title(dual, "Their dual points", off);
  return std::move(artist.out);
}

std::optional<DualityPlane> planeAt(const DualityPicture& picture, const Eigen::Vector2d& at, double reach) {
  std::optional<DualityPlane> found;
  double least = reach;
  for (const auto* places : {&picture.planes, &picture.points})
    for (const DualityPicture::Place& p : *places)
      if (const double away = (p.at - at).norm(); away < least) {
        least = away;
        found = p.plane;
      }
  return found;
}

std::optional<DualityPlane> planeNearest(const Duality& duality, int frame, const Eigen::Vector3d& place) {
  std::optional<DualityPlane> found;
  double most = -1;  // cosine of the angle between the ray to the place and the line of touch
  for (std::size_t v = 0; v < duality.views.size(); ++v) {
    const Duality::View& view = duality.views[v];
    const Eigen::Vector3d ray = place - view.apex;
    if (view.frame != frame || !(ray.norm() > 0)) continue;
    for (std::size_t i = 0; i < view.planes.size(); ++i)
      if (const double c = ray.normalized().dot(view.planes[i].cone.along); c > most) {
        most = c;
        found = DualityPlane{static_cast<int>(v), static_cast<int>(i)};
      }
  }
  return found;
}

std::string dualityWords(const Duality& duality, const DualityPlane& lit, const std::string& frameId) {
  if (lit.view < 0)
    return "A photograph does not tell where a plane touches the ellipsoid, only that it does: πᵀ Q* π = 0, which is linear "
           "in Q*. (Points X on the ellipsoid have Xᵀ Q X = 0, but no photograph shows which points those are.) Each point on "
           "the right is one such equation. All planes of one cone go through its camera, so that their points lie in one "
           "plane: a view is one slice of the dual quadric. One view gives five equations; two views share two planes, and "
           "give eight; three give the nine that an ellipsoid needs.";
  const Duality::View& view = duality.views[std::size_t(lit.view)];
  const Duality::Touch& t = view.planes[std::size_t(lit.plane)];
  std::string words = "Frame " + frameId + ": this plane lies h = " + inMm(t.away) + " from the centre of the ellipsoid, ";
  words += t.gap >= 0 ? inMm(t.gap) + " beside the ellipsoid" : inMm(-t.gap) + " within it";
  if (t.dual)
    words += formatted("; its dual point lies ρ²/h = %s from the centre, %s the dual quadric.", inMm(t.dual->norm()).c_str(),
                       t.gap >= 0 ? "inside of" : "outside of");
  else
    words += "; it goes through the centre, and its dual point lies at infinity.";
  if (view.fitPx)
    words += formatted(" The outline of the ellipsoid is %.3g px (rms) from the contour of this view.", *view.fitPx);
  return words;
}

}  // namespace glint::viz
