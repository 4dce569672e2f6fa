// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/known_lamp_check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "core/base/evenly.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/model/models.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/known_lamps.h"
#include "core/pipeline/training.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

constexpr std::size_t kMostFramesHeld = 24;  // more would take seconds and tell no more
constexpr int kRimPoints = 36;               // of a contour, for the angle that it reaches
// Share of the angle that the contour reaches: a right lamp leaves the shift of a wide lobe's peak, a wrong one about all of it.
constexpr double kOwnShare = 0.5;
constexpr double kMostOfThem = 0.8;  // of the highlights, before a cause is believed

/// The highlights of one frame, and the lamps that are on.
struct LitFrame {
  std::size_t frame = 0;
  std::vector<std::string> on;
  std::vector<TrainingView> views;  ///< world
};

/// Another statement of the same lamps. @return the lamp of that id in the world of a frame; nothing where it names no other
struct Statement {
  std::string words, advice;
  std::function<std::optional<Lamp>(const LitFrame&, const std::string& id)> lampOf;
};

/// What a statement leaves.
struct Held {
  int explained = 0, all = 0;
  double squares = 0;                                       ///< of the angles by which peaks miss, rad
  std::vector<std::pair<std::size_t, std::string>> missed;  ///< frame and lamp
  bool explainsMost() const { return all > 0 && explained >= kMostOfThem * all; }
};

class KnownLampCheck {
 public:
  KnownLampCheck(const Scene& scene, const ProgressFn& progress) : scene_(scene), surfaces_(scene), progress_(progress) {}

  std::optional<CameraCheck> run() {
    gather();
    if (lit_.empty()) return std::nullopt;
    const std::vector<Statement> list = statements();
    const Held given = held(list.front());
    CameraCheck check;
    check.views = static_cast<int>(lit_.size());
    check.lightFrame = "known, as the scene states";
    add(list.front(), given, check);
    check.missDeg = check.hypotheses.front().rmsPx;
    if (given.explained == given.all) return check;
    if (given.explainsMost()) {
      for (const auto& [frame, id] : given.missed) check.findings.push_back(singleText(frame, id, list.front()));
      return check;
    }
    const std::string begin = formatted("the known lamps do not make these highlights: %d of %d lie where their lamp mirrors",
                                        given.explained, given.all);
    for (std::size_t k = 1; k < list.size(); ++k) {
      const Held other = held(list[k]);
      add(list[k], other, check);
      if (!other.explainsMost()) continue;
      check.findings.push_back(begin +
                               formatted("; with %s %d do (%s)", list[k].words.c_str(), other.explained, list[k].advice.c_str()));
      return check;
    }
    check.findings.push_back(begin +
                             "; no change that was tried explains them: their places, their names, the cameras or the "
                             "surface may be wrong");
    return check;
  }

 private:
  void gather() {
    std::vector<std::size_t> frames;
    for (std::size_t f = 0; f < scene_.frames.size(); ++f)
      if (!scene_.frames[f].surface.empty() && knowsAllLamps(scene_, scene_.frames[f])) frames.push_back(f);
    const Settings settings;
    int done = 0;
    for (const std::size_t f : evenly(frames, kMostFramesHeld)) {
      if (!report(progress_, {"known lamps", done++, static_cast<int>(frames.size())})) throw Stopped{};
      const Frame& frame = scene_.frames[f];
      const FrameEvidence evidence = gatherEvidence(scene_, static_cast<int>(f), FrameSource::Radiance, settings);
      const Outcome<std::shared_ptr<const Surface>> surface = surfaces_.surfaceOf(static_cast<int>(f), meshPolicy(settings));
      if (evidence.failure || !surface) continue;
      LitFrame lit{f, frame.lightsOn, {}};
      for (int h = 0; h < static_cast<int>(evidence.highlights.size()); ++h)
        if (TrainingView v = trainingView(evidence, h, frame.camera, *surface); v.seen) lit.views.push_back(std::move(v));
      if (!lit.views.empty() && !lit.on.empty()) lit_.push_back(std::move(lit));
    }
  }

  const TrueLight* statedLight(const std::string& id) const {
    const auto at = std::find_if(scene_.lights.begin(), scene_.lights.end(), [&](const TrueLight& l) { return l.id == id; });
    return at == scene_.lights.end() ? nullptr : &*at;
  }
  Lamp lampIn(const LitFrame& lit, TrueLight light, LightFrame frame) const {
    light.frame = frame;
    return inWorld(light, scene_.frames[lit.frame]).lamp;
  }

  /// The scene's own first.
  std::vector<Statement> statements() const {
    std::vector<Statement> list;
    const auto changed = [&](const std::string& words, const std::string& advice, const std::function<Lamp(Lamp)>& change) {
      list.push_back({words, advice, [this, change](const LitFrame& lit, const std::string& id) -> std::optional<Lamp> {
                        TrueLight light = *statedLight(id);
                        light.lamp = change(light.lamp);
                        return lampIn(lit, light, light.frame);
                      }});
    };
    changed(CameraCheck::kAsStated, "", [](Lamp l) { return l; });
    changed("directions reversed", "a direction points from the scene to the light", [](Lamp l) {
      if (l.atInfinity()) l.centre *= -1;
      return l;
    });
    for (const int axis : {0, 1, 2})
      for (const int side : {1, -1}) {
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(side * EIGEN_PI / 2, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
        changed(formatted("lamps turned by %d degrees about %c", 90 * side, "xyz"[axis]), "are they stated with another axis up?",
                [turn](const Lamp& l) { return transformed(l, 1, turn, Eigen::Vector3d::Zero()); });
      }
    list.push_back({"the other frame of coordinates", "\"frame\": \"world\" or \"camera\"",
                    [this](const LitFrame& lit, const std::string& id) -> std::optional<Lamp> {
                      const TrueLight& light = *statedLight(id);
                      return lampIn(lit, light, light.frame == LightFrame::World ? LightFrame::Camera : LightFrame::World);
                    }});
    for (const int by : {1, -1})
      list.push_back({by > 0 ? "the names of the next frame" : "the names of the frame before", "are lights_on off by one?",
                      [this, by](const LitFrame& lit, const std::string& id) -> std::optional<Lamp> {
                        const std::ptrdiff_t other = static_cast<std::ptrdiff_t>(lit.frame) + by;
                        if (other < 0 || other >= std::ssize(scene_.frames) || lit.on.size() != 1 || id != lit.on.front())
                          return std::nullopt;
                        const std::vector<std::string>& on = scene_.frames[static_cast<std::size_t>(other)].lightsOn;
                        const TrueLight* const light = on.size() == 1 ? statedLight(on.front()) : nullptr;
                        return light ? std::optional(lampIn(lit, *light, light->frame)) : std::nullopt;
                      }});
    return list;
  }

  /// By how much the peak of the nearest highlight misses the lamp's mirror point, rad, and whether that is within the highlight.
  struct Miss {
    double angle = EIGEN_PI;
    bool own = false;
  };
  Miss missOf(const LitFrame& lit, const Lamp& lamp) const {
    Miss least;
    for (const TrainingView& v : lit.views) {
      const double angle = halfAngleAt(v.seen->brightest.point, v.camera, lamp);
      if (!(angle < least.angle)) continue;
      const double rim = medianContourAngle({v}, lightOf(lamp), kRimPoints);
      least = {angle, rim > 0 && angle < kOwnShare * rim};
    }
    return least;
  }

  Held held(const Statement& statement) const {
    Held result;
    for (const LitFrame& lit : lit_)
      for (const std::string& id : lit.on) {
        const std::optional<Lamp> lamp = statement.lampOf(lit, id);
        if (!lamp) continue;
        const Miss miss = missOf(lit, *lamp);
        ++result.all;
        result.explained += miss.own;
        result.squares += miss.angle * miss.angle;
        if (!miss.own) result.missed.emplace_back(lit.frame, id);
      }
    return result;
  }

  static void add(const Statement& statement, const Held& held, CameraCheck& check) {
    const double rms = held.all > 0 ? degrees(std::sqrt(held.squares / held.all)) : std::numeric_limits<double>::quiet_NaN();
    check.hypotheses.push_back({statement.words, std::isfinite(rms) ? std::optional(rms) : std::nullopt});
  }

  /// One lamp that is not where its highlight says, with the one that is.
  std::string singleText(std::size_t frame, const std::string& id, const Statement& given) const {
    const LitFrame& lit = *std::find_if(lit_.begin(), lit_.end(), [&](const LitFrame& l) { return l.frame == frame; });
    std::string text =
        formatted("frame %s: no highlight lies where the known lamp %s mirrors (the nearest is off by %.2g degrees)",
                  scene_.frames[frame].id.c_str(), id.c_str(), degrees(missOf(lit, *given.lampOf(lit, id)).angle));
    for (const TrueLight& other : scene_.lights)
      if (other.known && std::count(lit.on.begin(), lit.on.end(), other.id) == 0 && missOf(lit, *given.lampOf(lit, other.id)).own)
        return text + "; lamp " + other.id + " does: are their names or places swapped?";
    return text + ": its place, its name or the surface there may be wrong";
  }

  const Scene& scene_;
  const SurfaceCache surfaces_;
  const ProgressFn& progress_;
  std::vector<LitFrame> lit_;
};

}  // namespace

std::optional<CameraCheck> checkKnownLamps(const Scene& scene, const ProgressFn& progress) {
  return KnownLampCheck(scene, progress).run();
}

}  // namespace glint
