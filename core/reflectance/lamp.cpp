// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/lamp.h"

#include <Eigen/Geometry>
#include <array>

#include "core/base/numeric.h"
#include "core/base/outcome.h"
#include "core/base/overload.h"

namespace glint {
namespace {

/// @param f  takes every shape
template <class F>
decltype(auto) of(const LampShape& shape, F&& f) {
  return std::visit(std::forward<F>(f), shape);
}

template <std::size_t... I>
LampChoices choicesNamed(const std::string& name, std::index_sequence<I...>) {
  LampChoices choices;
  ((choices[I] = name == "auto" || name == std::variant_alternative_t<I, LampShape>::kName), ...);
  choices[0] = false;
  return choices;
}

template <std::size_t... I>
constexpr int mostUnknowns(std::index_sequence<I...>) {
  return std::max({std::variant_alternative_t<I, LampShape>::kUnknowns...});
}
static_assert(mostUnknowns(std::make_index_sequence<std::variant_size_v<LampShape>>()) == kMostShapeUnknowns);

template <std::size_t... I>
std::vector<LampShape> shapesOf(std::index_sequence<I...>) {
  return {LampShape(std::in_place_index<I + 1>)..., PointShape<>{}};
}

/// No search looks for this shape.
template <class Shape>
std::vector<LampShape> startsLike(const Shape&, const ExtentGuess&) {
  return {};
}

/// Five axes across the direction to the lamp and towards it, and the one that is promised.
std::vector<LampShape> startsLike(const SegmentShape<>&, const ExtentGuess& guess) {
  constexpr double kStartLength = 0.1;  // half the lamp's length over its distance
  const Eigen::Vector3d &towards = guess.towards, u = towards.unitOrthogonal(), v = towards.cross(u);
  std::vector<LampShape> starts;
  if (guess.halfAxes) starts.emplace_back(SegmentShape<>{guess.halfAxes->col(0), 0});
  for (int k = 0; k < 4; ++k)
    starts.emplace_back(
        SegmentShape<>{kStartLength * guess.distance * (std::cos(k * M_PI / 4) * u + std::sin(k * M_PI / 4) * v), 0});
  starts.emplace_back(SegmentShape<>{kStartLength * guess.distance * (towards + u).normalized(), 0});
  return starts;
}

Eigen::RowVector3d row(const Eigen::Vector3d& v) { return v.transpose(); }

/// Sums leave round-off behind that no file should show: the number of at most 15 digits within that round-off is what was meant.
double withoutRoundOff(double sum) {
  const double size = std::abs(sum);
  if (!(size > 0) || !std::isfinite(sum)) return sum;
  const int decimals = 14 - static_cast<int>(std::floor(std::log10(size)));
  if (decimals < 0 || decimals > 22) return sum;  // powers of ten up to 22 are exact
  const double power = std::pow(10.0, decimals), typed = std::round(sum * power) / power;
  return std::abs(typed - sum) <= 4 * std::numeric_limits<double>::epsilon() * size ? typed : sum;
}

}  // namespace

Light lightOf(const Lamp& lamp) {
  constexpr double kRoundOff = 4 * std::numeric_limits<double>::epsilon();
  const bool unit = lamp.centre.w() >= 0 && std::abs(lamp.centre.norm() - 1) <= kRoundOff;
  return unit ? Light::ofUnit(lamp.centre) : Light::homogeneous(lamp.centre);
}

Lamp lampAt(const Eigen::Vector3d& position) { return {position.homogeneous(), PointShape<>{}}; }

Lamp lampTowards(const Eigen::Vector3d& fromScene) {
  require(fromScene.norm() > 0, "Lamp: no direction");
  Lamp lamp;
  lamp.centre << fromScene.normalized(), 0;
  return lamp;
}

Lamp sphereLamp(const Light& centre, double radius) {
  require(radius >= 0 && std::isfinite(radius), "Lamp: the radius must not be negative");
  require(radius == 0 || !centre.atInfinity(), "Lamp: a light at infinity has no radius");
  return withRadius(centre, radius);
}

Lamp segmentLamp(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  require(from.allFinite() && to.allFinite() && (to - from).norm() > 0, "Lamp: a segment has two ends");
  return {Eigen::Vector3d(0.5 * (from + to)).homogeneous(), SegmentShape<>{0.5 * (to - from), 0}};
}

Lamp withRadius(Lamp lamp, double radius) {
  require(radius >= 0 && std::isfinite(radius), "Lamp: the radius must not be negative");
  if (auto* const segment = std::get_if<SegmentShape<>>(&lamp.shape))
    segment->radius = radius;
  else
    lamp.shape = radius > 0 ? LampShape(SphereShape<>::of(radius)) : LampShape(PointShape<>{});
  return lamp;
}

double radiusOf(const Lamp& lamp) {
  return of(lamp.shape, Overload{[](const PointShape<>&) { return 0.0; }, [](const SphereShape<>& s) { return s.reach(); },
                                 [](const SegmentShape<>& s) { return s.radius; }});
}

std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> endsOf(const Lamp& lamp) {
  const auto* const segment = std::get_if<SegmentShape<>>(&lamp.shape);
  if (!segment) return std::nullopt;
  const Eigen::Vector3d middle = lamp.position();
  return std::pair(Eigen::Vector3d(middle - segment->halfAxis), Eigen::Vector3d(middle + segment->halfAxis));
}

double reachOf(const LampShape& shape) {
  return of(shape, [](const auto& s) { return s.reach(); });
}

std::vector<Eigen::Vector3d> extremesOf(const Lamp& lamp) {
  const auto ends = endsOf(lamp);
  return ends ? std::vector<Eigen::Vector3d>{ends->first, ends->second} : std::vector<Eigen::Vector3d>();
}

Lamp moved(const Lamp& lamp, const Eigen::Vector3d& by) {
  Lamp there = lamp;
  if (lamp.atInfinity())
    there.centre.head<3>() = (lamp.centre.head<3>() + by).normalized();
  else
    there.centre.head<3>() += lamp.centre.w() * by;
  return there;
}

Lamp transformed(const Lamp& lamp, double scale, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift) {
  Lamp there = lamp;
  there.shape = of(lamp.shape, [&](const auto& s) { return LampShape(s.times(scale).rotated(rotation)); });
  there.centre.head<3>() = rotation * lamp.centre.head<3>();
  if (!lamp.atInfinity()) there.centre.head<3>() = scale * there.centre.head<3>() + lamp.centre.w() * shift;
  return there;
}

Lamp normalised(const Lamp& lamp, const Eigen::Vector3d& origin, double scale) {
  Eigen::Vector4d l;
  l << (lamp.centre.head<3>() - lamp.centre.w() * origin) / scale, lamp.centre.w();
  require(l.norm() > 0, "Lamp: no light");
  return {l.normalized(), of(lamp.shape, [&](const auto& s) { return LampShape(s.over(scale)); })};
}

Lamp fromNormalised(const Lamp& lamp, const Eigen::Vector3d& origin, double scale) {
  Eigen::Vector4d world;
  world << scale * lamp.centre.head<3>() + lamp.centre.w() * origin, lamp.centre.w();
  return {Light::homogeneous(world).homogeneous(), of(lamp.shape, [&](const auto& s) { return LampShape(s.times(scale)); })};
}

std::span<double> unknownsOf(LampShape& shape) {
  return std::visit([](auto& s) { return std::span<double>(s.unknowns(), std::size_t(s.kUnknowns)); }, shape);
}

int unknownCount(const LampShape& shape) {
  return of(shape, [](const auto& s) { return s.kUnknowns; });
}

const char* nameOf(const LampShape& shape) {
  return of(shape, [](const auto& s) { return s.kName; });
}

std::vector<LampShape> startsOf(const LampShape& kind, const ExtentGuess& guess) {
  return of(kind, [&](const auto& s) { return startsLike(s, guess); });
}

bool isSearched(const LampShape& kind) {
  return of(kind, [](const auto& s) { return s.kSearched; });
}

std::vector<LampShape> aliasesOf(const LampShape& shape) {
  return of(shape, [](const auto& s) {
    const auto aliases = s.aliases();
    return std::vector<LampShape>(aliases.begin(), aliases.end());
  });
}

std::vector<LampShape> allLampShapes() { return shapesOf(std::make_index_sequence<std::variant_size_v<LampShape> - 1>()); }

LampChoices lampChoices(const std::string& name) {
  return choicesNamed(name, std::make_index_sequence<std::variant_size_v<LampShape>>());
}

std::vector<LampField> fieldsOf(const Lamp& lamp) {
  std::vector<LampField> fields;
  if (const auto ends = endsOf(lamp)) {
    Eigen::Matrix<double, 2, 3> points;
    points << row(ends->first), row(ends->second);
    fields.push_back({"segment", points.unaryExpr(&withoutRoundOff)});
  } else if (lamp.atInfinity()) {
    fields.push_back({"direction", row(lamp.centre.head<3>())});
  } else {
    fields.push_back({"position", row(lamp.position())});
  }
  if (const double radius = radiusOf(lamp); radius > 0) fields.push_back({"radius", Eigen::MatrixXd::Constant(1, 1, radius)});
  return fields;
}

const std::vector<PlacedShape>& placedShapes() {
  static const std::vector<PlacedShape> shapes{
      {"segment", 2, "must have two ends",
       [](const std::vector<Eigen::Vector3d>& ends) { return std::string(ends[0] == ends[1] ? "the two ends must differ" : ""); },
       [](const std::vector<Eigen::Vector3d>& ends) { return segmentLamp(ends[0], ends[1]); }}};
  return shapes;
}

std::vector<LampFact> factsOf(const Lamp& lamp) {
  std::vector<LampFact> facts;
  if (const double radius = radiusOf(lamp); radius > 0) facts.push_back({"radius", Eigen::VectorXd::Constant(1, radius)});
  if (const auto ends = endsOf(lamp)) {
    facts.push_back({"length", Eigen::VectorXd::Constant(1, (ends->second - ends->first).norm())});
    facts.push_back({"end", ends->first});
    facts.push_back({"end", ends->second});
  }
  return facts;
}

std::vector<std::vector<Eigen::Vector3d>> outlineOf(const Lamp& lamp) {
  constexpr int kSteps = 96;  // of a circle: rounder than any screen shows
  std::vector<std::vector<Eigen::Vector3d>> chains;
  if (lamp.atInfinity()) return chains;
  if (const auto ends = endsOf(lamp)) chains.push_back({ends->first, ends->second});
  const double radius = radiusOf(lamp);
  if (!(radius > 0)) return chains;
  const Eigen::Vector3d middle = lamp.position();
  for (int k = 0; k < 3; ++k) {
    std::vector<Eigen::Vector3d>& circle = chains.emplace_back();
    for (int i = 0; i <= kSteps; ++i) {
      const double t = 2 * M_PI * (i % kSteps) / kSteps;
      circle.push_back(middle +
                       radius * (std::cos(t) * Eigen::Vector3d::Unit(k) + std::sin(t) * Eigen::Vector3d::Unit((k + 1) % 3)));
    }
  }
  return chains;
}

namespace lobe {
namespace {

const std::vector<DiscRule::Node>& alongRuleFor(double ratio) {
  // Fewest nodes whose log I agrees with 400 nodes to 1e-5, for Gaussian and GGX lobes beside and beyond the segment down to a
  // thousandth of the peak.
  struct Rung {
    double ratio;  // largest that the rule serves
    std::vector<DiscRule::Node> nodes;
  };
  const auto rung = [](double ratio, int n) {
    Rung r{ratio, {}};
    for (const QuadratureNode& node : gaussLegendre(n)) r.nodes.push_back({node.x, 0, 0.5 * node.weight});
    return r;
  };
  static const std::array<Rung, 13> ladder{rung(0.1, 3),  rung(0.35, 4), rung(0.5, 6),  rung(0.75, 8), rung(1.0, 10),
                                           rung(1.5, 12), rung(2.0, 16), rung(3.0, 24), rung(4.0, 32), rung(5.0, 40),
                                           rung(6.5, 56), rung(8.0, 64), rung(12.0, 96)};
  for (const Rung& r : ladder)
    if (ratio <= r.ratio) return r.nodes;
  return ladder.back().nodes;
}

}  // namespace

bool State::isFinite() const {
  LampShape shape = lamp.shape;
  bool finite = lamp.centre.allFinite() && std::isfinite(logRoughness) && std::isfinite(logRatio);
  for (const double x : unknownsOf(shape)) finite = finite && std::isfinite(x);
  return finite;
}

Eigen::VectorXd State::place() const {
  LampShape shape = lamp.shape;
  const std::span<const double> own = unknownsOf(shape);
  Eigen::VectorXd all(5 + static_cast<Eigen::Index>(own.size()));
  all.head<5>() << lamp.centre, logRoughness;
  std::copy(own.begin(), own.end(), all.data() + 5);
  return all;
}

LampRule lampRuleFor(const LampShape& shape, double ratio) {
  return of(shape, Overload{[](const PointShape<>&) { return LampRule{}; },
                            [&](const SphereShape<>&) { return LampRule{&discRuleFor(ratio).nodes}; },
                            [&](const SegmentShape<>&) { return LampRule{&alongRuleFor(ratio)}; }});
}

double lampRatio(double roughness, const Eigen::Vector3d& position, const Eigen::Vector3d& toCamera, const Lamp& lamp) {
  return lamp.isPoint() ? 0 : sizeRatio(roughness, position, toCamera, lamp.centre, reachOf(lamp.shape));
}

Nearest nearestTo(const Lamp& lamp, const Eigen::Vector3d& position, const Eigen::Vector3d& direction) {
  Nearest nearest{lamp.centre.head<3>() - lamp.centre.w() * position};
  if (const auto* const segment = std::get_if<SegmentShape<>>(&lamp.shape)) {
    const Eigen::Vector3d axis = lamp.centre.w() * segment->halfAxis, &offset = nearest.offset;
    const Eigen::Vector3d acrossAxis = axis - axis.dot(direction) * direction,
                          across = offset - offset.dot(direction) * direction;
    const double squared = acrossAxis.squaredNorm();
    nearest.offset += (squared > 0 ? std::clamp(-across.dot(acrossAxis) / squared, -1.0, 1.0) : 0.0) * axis;
  }
  nearest.extent = std::atan2(radiusOf(lamp) * std::abs(lamp.centre.w()), nearest.offset.norm());
  return nearest;
}

}  // namespace lobe
}  // namespace glint
