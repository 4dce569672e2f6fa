// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/advise/explain_case.h"
#include "core/base/numeric.h"
#include "core/light/estimate.h"

// The step of the virtual camera: what the tangent plane shows, and how far the surface is from it within the highlight.
namespace glint::explain_steps {
namespace {

constexpr double kFlatShare = 0.05;     // of the limit angle: a normal that turns less across the highlight is that of a plane
constexpr double kSameCurvature = 0.2;  // of the largest one: below, the same bend describes all views
constexpr double kRoundTurn = 1e-5;  // rad across the highlight: two curvatures that differ less have no directions of their own
constexpr double kEdgePx = 1.5;      // px: a contour lies this near to the edge of the surface that cuts it

/// Where a plane through the camera and P_B meets the contour, farthest out on one side of P_B.
struct End {
  double out = 0;  // m from P_B, along the direction
  Eigen::Vector3d seen{0, 0, 0}, reflected{0, 0, 0};
};

/// Both ends of the highlight along a tangent direction; empty if the contour leaves the surface there.
std::optional<std::array<End, 2>> endsAlong(const TrainingView& v, const Surface& surface, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d eye = v.camera.centreInWorld(), at = v.seen->brightest.point.position;
  const Eigen::Vector3d beside = (at - eye).cross(direction);
  const std::vector<Pixel>& points = v.highlight.contour.points;
  std::array<std::optional<End>, 2> ends;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Pixel &p = points[i], &q = points[(i + 1) % points.size()];
    const double here = beside.dot(v.camera.ray(p).direction), there = beside.dot(v.camera.ray(q).direction);
    if ((here < 0) == (there < 0)) continue;
    const Ray ray = v.camera.ray(p + here / (here - there) * (q - p));
    const Outcome<SurfacePoint> hit = surface.firstHit(ray);
    if (!hit) return std::nullopt;
    const double out = direction.dot(hit->position - at);
    std::optional<End>& end = ends[out < 0];
    if (!end || std::abs(out) > end->out)
      end = End{std::abs(out), ray.direction, reflect(-ray.direction, facing(*hit, eye).normal)};
  }
  if (!ends[0] || !ends[1]) return std::nullopt;
  return std::array<End, 2>{*ends[0], *ends[1]};
}

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Largest angle between the normal at P_B and those at contour points on the surface, rad; 0 without any.
double largestTurn(const TrainingView& v, const Surface& surface) {
  const Eigen::Vector3d eye = v.camera.centreInWorld();
  double most = 0;
  for (const Pixel& p : v.highlight.contour.points)
    if (const Outcome<SurfacePoint> hit = surface.firstHit(v.camera.ray(p)))
      most = std::max(most, angleBetween(v.seen->tangentPlane.normal, facing(*hit, eye).normal));
  return most;
}

/// Size of the highlight in a direction, m.
double lengthOf(const std::optional<std::array<End, 2>>& ends) { return ends ? (*ends)[0].out + (*ends)[1].out : 0; }

/// What the camera sees within the highlight in two directions, by a flat mirror and by this one, and how far behind the mirror
/// its image lies there: 1/d' = 1/d + 2 kappa cos(theta) / (1 - (e . V)^2), Coddington's equations for any tangent direction e.
void fieldsOfView(const Case& c, const Curvature& k, ExplainStep& step) {
  const TrainingView& v = *c.out.view;
  const Eigen::Vector3d toCamera = v.camera.centreInWorld() - v.seen->brightest.point.position, view = toCamera.normalized(),
                        normal = v.seen->tangentPlane.normal;
  struct Direction {
    Eigen::Vector3d along;
    double curvature;
    const char *field, *image;
  };
  const bool first = std::abs(k.k1) >= std::abs(k.k2);
  std::array<Direction, 2> directions{
      {{first ? k.direction1 : k.direction2, first ? k.k1 : k.k2, "field of view in the most bent direction",
        "image of the camera, behind P_B in that direction"},
       {first ? k.direction2 : k.direction1, first ? k.k2 : k.k1, "field of view in the least bent direction",
        "image of the camera, behind P_B in that direction"}}};
  const auto bent = endsAlong(v, *c.surface, directions[0].along);
  if (const Eigen::Vector3d slant = view - normal.dot(view) * normal;
      (k.k1 - k.k2) * lengthOf(bent) < kRoundTurn && slant.norm() > kRoundTurn) {
    // Equally bent in all directions, none is special but those of the light's way.
    directions[0] = {slant.normalized(), k.k1, "field of view in the plane of incidence", directions[0].image};
    directions[1] = {normal.cross(directions[0].along), k.k2, "field of view across the plane of incidence", directions[1].image};
  }
  for (const Direction& direction : directions) {
    const std::string field = direction.field;
    const std::optional<std::array<End, 2>> ends = endsAlong(v, *c.surface, direction.along);
    if (ends) {
      step.numbers.push_back(one("", field + ", flat mirror", degrees(angleBetween((*ends)[0].seen, (*ends)[1].seen)), "deg"));
      step.numbers.push_back(
          one("", field + ", this mirror", degrees(angleBetween((*ends)[0].reflected, (*ends)[1].reflected)), "deg"));
    }
    const double along = direction.along.dot(view);
    const double vergence = 1 / toCamera.norm() + 2 * direction.curvature * normal.dot(view) / (1 - along * along);
    if (const double image = 1 / vergence; std::isfinite(image)) step.numbers.push_back(one("d′", direction.image, image, "m"));
  }
}

/// What dual takes for the same in all views: the bend. It differs from place to place, or only between the directions.
void addBend(const Case& c, const Curvature& here, ExplainStep& step) {
  Eigen::Array2d least(here.k1, here.k2), most = least;  // here, and where the model was trained
  for (const TrainingView& other : c.inspection.views) {
    if (!other.seen || !other.surface || !c.sharesModel(other.frame)) continue;
    const Outcome<Curvature> there = other.surface->curvatureAt(other.seen->brightest.point);
    if (!there) continue;
    const Eigen::Array2d both(there->k1, there->k2);
    least = least.min(both);
    most = most.max(both);
  }
  const double size = std::max(least.abs().maxCoeff(), most.abs().maxCoeff());
  const Eigen::Array2d spread = most - least;
  if (const int worst = spread(1) > spread(0); spread(worst) > kSameCurvature * size)
    step.broken.push_back({"dual-curvature-varies",
                           {one(worst ? "κ₂" : "κ₁", "smallest at the brightest points", least(worst), "1/m"),
                            one(worst ? "κ₂" : "κ₁", "largest at the brightest points", most(worst), "1/m")}});
  else if (here.k1 - here.k2 > kSameCurvature * std::max(std::abs(here.k1), std::abs(here.k2)))
    step.broken.push_back(
        {"dual-bends-one-way",
         {one("κ₁", "largest curvature here", here.k1, "1/m"), one("κ₂", "smallest curvature here", here.k2, "1/m")}});
}

/// How far the surface is from a plane within the highlight: the normal's turn against the limit angle.
void addTurn(const Case& c, const Curvature& k, ExplainStep& step) {
  const double turn = largestTurn(*c.out.view, *c.surface);
  step.numbers.push_back(one("", "largest turn of the normal from P_B to the contour", degrees(turn), "deg"));
  const double limit = c.fit && c.fit->fit ? c.fit->fit->limitAngle().value_or(0) : 0;
  const LightEstimate* common = c.common();
  const double alpha = limit > 0 ? limit : common ? common->limitAngle : 0;
  if (!(alpha > 0) || !(turn > kFlatShare * alpha)) return;
  // Said of such models whichever one is explained: that they fail here is why the steps that follow exist.
  using Assumes = ModelTraits::Assumes;
  const auto wasComputed = [&](Assumes assumed) {
    const auto& models = c.inspection.models;
    return std::any_of(models.begin(), models.end(), [&](const auto& m) { return assumes(m.first) == assumed; });
  };
  if (wasComputed(Assumes::Plane))
    step.broken.push_back({"primal-off-plane",
                           {one("", "turn of the normal", degrees(turn), "deg"), one("", "limit angle", degrees(alpha), "deg")}});
  if (wasComputed(Assumes::ConstantCurvature)) addBend(c, k, step);
}

}  // namespace

ModelTraits::Assumes assumes(const std::string& model) { return modelByName(model).traits().surface; }

bool reached(const Case& c, ExplainStep& step) {
  if (!c.highlight) {
    const std::optional<Failure>& why = c.inspection.evidence[std::size_t(c.out.frame)].failure;
    step.failure = why ? *why : Failure{Reason::NoHighlight, "the frame shows none"};
  } else if (!c.out.view) {
    step.failure = Failure{Reason::NoSurface, ""};
  } else {
    step.failure = c.out.view->failure();
  }
  return !step.failure;
}

int endsAtEdge(const TrainingView& view) {
  constexpr int kAround = 72;
  if (!view.surface) return 0;
  const std::vector<Pixel> around = resample(view.highlight.contour, kAround);
  return int(std::count_if(around.begin(), around.end(), [&](const Pixel& p) {
    const Pixel out = p - view.highlight.peak;
    return out.norm() > 0 && !view.surface->firstHit(view.camera.ray(p + kEdgePx * out.normalized()));
  }));
}

void virtualCameraStep(const Case& c, ExplainStep& step) {
  if (!reached(c, step) || !c.out.view->seen) return;
  const TrainingView& v = *c.out.view;
  const Eigen::Vector3d eye = v.camera.centreInWorld(), at = v.seen->brightest.point.position,
                        normal = v.seen->tangentPlane.normal;
  step.numbers.push_back(point("C", "camera centre", eye));
  step.numbers.push_back(point("C_v", "centre of the virtual camera", v.seen->tangentPlane.reflected(eye)));
  step.numbers.push_back(
      one("det M", "of the mirror's 3x3 block", v.seen->tangentPlane.reflection().topLeftCorner<3, 3>().determinant()));
  step.numbers.push_back(one("d", "distance of the camera from P_B", (eye - at).norm(), "m"));
  if (c.out.lightUsed && !c.out.lightUsed->atInfinity())
    step.numbers.push_back(one("r", "distance of the light from P_B", (c.out.lightUsed->position() - at).norm(), "m"));
  step.numbers.push_back(one("θ", "angle between N and the view ray", degrees(angleBetween(eye - at, normal)), "deg"));
  if (!c.surface) return;
  const Outcome<Curvature> k = c.surface->curvatureAt(v.seen->brightest.point);
  if (!k) return;
  fieldsOfView(c, *k, step);
  addTurn(c, *k, step);
}

}  // namespace glint::explain_steps
