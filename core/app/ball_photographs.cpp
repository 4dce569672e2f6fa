// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/ball_photographs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/app/ball_highlights.h"
#include "core/app/ball_outline.h"
#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/base/found_file.h"
#include "core/base/image_header.h"
#include "core/base/number_text.h"
#include "core/base/progress.h"
#include "core/geometry/camera.h"
#include "core/scene/frame_name.h"
#include "core/scene/scene.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr std::array kEndings{".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp"};
constexpr double kAround = 1.3;                       // radii: what finding edges and highlights looks at
constexpr double kAroundPx = 8;                       // of a small ball
constexpr std::size_t kMostForOutline = 24;           // photographs: noise then is a fifth, and shadows of one lamp are averaged
constexpr std::size_t kBytesForOutline = 256u << 20;  // of memory, for one ball at a time
constexpr float kWhite = 255;

std::set<std::string> photographsIn(const fs::path& folder) {
  std::set<std::string> names;
  try {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (entry.is_regular_file() && std::count(kEndings.begin(), kEndings.end(), lowerEnding(entry.path())) > 0)
        names.insert(entry.path().filename().string());
  } catch (const fs::filesystem_error& e) {
    throw InputError(folder.string(), "", "cannot be read as a folder: " + e.code().message());
  }
  return names;
}

std::vector<double> numbersOf(const std::string& text, std::size_t count, const std::string& place, const char* wanted) {
  std::vector<double> numbers;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const std::optional<double> n = numberFrom(std::string_view(text).substr(from, comma - from));
    if (!n || !(std::abs(*n) <= kFarthestPx)) throw InputError("", place, std::string("expected ") + wanted);
    numbers.push_back(*n);
    from = comma + 1;
  }
  if (numbers.size() != count) throw InputError("", place, std::string("expected ") + wanted);
  return numbers;
}

fs::path folderOf(const fs::path& input, const NamedBall& ball) {
  if (ball.folder.empty()) return input;
  const fs::path as = ball.folder, in = input / ball.folder;
  std::error_code ignored;  // unreadable counts as missing
  const bool here = fs::is_directory(as, ignored), inside = as.is_relative() && fs::is_directory(in, ignored);
  const std::string place = "--ball " + ball.text;
  if (here && inside && !fs::equivalent(as, in, ignored))
    throw InputError("", place,
                     "there are two such folders, '" + as.string() + "' and '" + in.string() + "'; name it by its whole path");
  if (!here && !inside)
    throw InputError("", place, "the folder '" + ball.folder + "' does not exist, nor is it in '" + input.string() + "'");
  return here ? as : in;
}

/// Folders beside those that balls name, with photographs of the same names.
std::vector<std::string> foldersLeftOut(const std::vector<fs::path>& used, const std::vector<Shot>& shots) {
  std::set<fs::path> named, parents, found;
  std::error_code ignored;  // unreadable counts as missing
  for (const fs::path& folder : used) named.insert(fs::weakly_canonical(folder, ignored));
  for (const fs::path& folder : named) parents.insert(folder.parent_path());
  for (const fs::path& parent : parents)
    for (const fs::directory_entry& entry : fs::directory_iterator(parent, ignored))
      if (entry.is_directory(ignored) && !named.count(entry.path()) &&
          std::any_of(shots.begin(), shots.end(), [&](const Shot& s) { return fs::exists(entry.path() / s.name, ignored); }))
        found.insert(entry.path());
  std::vector<std::string> names;
  for (const fs::path& folder : found) names.push_back(folder.filename().string());
  return names;
}

Failure unreadableShot(const fs::path& file, const std::string& reason) {
  return Failure{Reason::FrameUnreadable, file.filename().string() + ": " + reason};
}

/// 0 to 255, three channels. @param like  a photograph whose size it must have; empty = any
Outcome<Image> readShot(const fs::path& file, const CameraResponse& response, const Image* like) {
  Frame frame;
  frame.response = response;
  frame.id = file.filename().string();
  frame.image = file;
  try {
    const ImageHeader header = readImageHeader(readFile(file, Limit::ImageMegabytes));
    if (!header.problem.empty()) return unreadableShot(file, header.problem);
    constexpr double kMega = 1e6;
    requireWithin(Limit::ImageMegapixels, double(header.width) * double(header.height) / kMega, file.string());
    frame.camera.width = static_cast<int>(header.width);
    frame.camera.height = static_cast<int>(header.height);
  } catch (const InputError& e) {
    return Failure{Reason::FrameUnreadable, e.what()};
  }
  if (like && (frame.camera.width != like->width || frame.camera.height != like->height))
    return unreadableShot(file, formatted("has %d x %d pixels, the first photograph %d x %d: one fixed camera is expected",
                                          frame.camera.width, frame.camera.height, like->width, like->height));
  Outcome<Image> image = readPhotograph(frame);
  if (!image) return image.failure();
  for (float& v : image->data) v *= kWhite;
  return image;
}

/// A part of a photograph and the place of its first pixel in the shot.
struct Cutting {
  Image image;
  Eigen::Vector2d corner;
};
Cutting around(const Image& image, const Eigen::Vector2d& corner, const BallOutline& ball) {
  const Eigen::Vector2d centre = ball.centre - corner;
  const double reach = kAround * ball.radius + kAroundPx;
  const auto within = [](double v, int size) { return static_cast<int>(std::clamp(v, 0.0, double(size - 1))); };
  const int x0 = within(std::floor(centre.x() - reach), image.width), y0 = within(std::floor(centre.y() - reach), image.height),
            x1 = within(std::ceil(centre.x() + reach), image.width), y1 = within(std::ceil(centre.y() + reach), image.height);
  Image part(x1 - x0 + 1, y1 - y0 + 1, image.channels);
  const auto row = static_cast<std::ptrdiff_t>(part.width) * image.channels;
  for (int y = 0; y < part.height; ++y) {
    const auto from = image.data.begin() + (static_cast<std::ptrdiff_t>(y + y0) * image.width + x0) * image.channels;
    std::copy(from, from + row, part.data.begin() + y * row);
  }
  return {std::move(part), corner + Eigen::Vector2d(x0, y0)};
}

/// Where other reflections may be the lamp's as well, its direction is known to their spread and its distance is not.
void widenByRivals(LampAnswer& lamp) {
  double squares = 0;
  auto all = static_cast<double>(lamp.sightings.size());
  for (const DroppedSighting& d : lamp.dropped) {
    if (!d.direction) continue;
    const double angle = std::atan2(d.direction->cross(lamp.direction).norm(), d.direction->dot(lamp.direction));
    squares += angle * angle, all += 1;
  }
  if (lamp.failure || squares == 0) return;
  lamp.directionSigma = std::hypot(lamp.directionSigma, std::sqrt(squares / all));
  lamp.position.reset(), lamp.covariance.reset();
  lamp.withoutPosition = "which of the bright reflections is the lamp's is not known";
}

class ShotReader {
 public:
  ShotReader(const BallShots& shots, Outlines outlines, double givenSigmaPx, const ProgressFn& progress)
      : s_(shots), outlines_(outlines), givenSigmaPx_(givenSigmaPx), progress_(progress) {}

  Outcome<PhotographLamps> run(BallPhotographs photographs) {
    constexpr double kSquare = 1e-3;  // of the focal length: over an outline of 1000 px that is half a pixel
    if (const std::optional<Camera>& c = photographs.camera; c && !c->hasDistortion()) {
      const Eigen::Matrix3d& k = c->pixelFromRay;
      if (std::abs(k(1, 1) / k(0, 0) - 1) < kSquare) outlineCamera_ = OutlineCamera{k(0, 0), {k(0, 2), k(1, 2)}};
    }
    for (std::size_t k = 0; k < s_.balls.size(); ++k) {
      if (!report(progress_, {"outlines", static_cast<int>(k), static_cast<int>(s_.balls.size())})) throw Stopped{};
      Outcome<RefinedOutline> outline = outlineOf(k);
      if (!outline) return outline.failure();
      photographs.balls.push_back(*std::move(outline));
    }
    for (const RefinedOutline& o : photographs.balls) found_.push_back(o.outline);
    const std::vector<Seen> seen = highlights();
    for (const Seen& s : seen) photographs.seen.insert(photographs.seen.end(), s.observations.begin(), s.observations.end());
    if (photographs.seen.empty()) return named({}, seen);
    if (!report(progress_, {"lamps", 0, 1})) throw Stopped{};
    Outcome<BallLamps> fit = fitBallLamps(photographs, outlines_ == Outlines::Fitted);
    if (!fit) return fit.failure();
    PhotographLamps result = named(*std::move(fit), seen);
    if (s_.balls.size() == 1 && showsLobes(photographs.seen, found_.front()))
      refineByLobe(s_, size_.at(0).width, size_.at(0).height, photographs.camera, result.fit, progress_);
    for (LampAnswer& lamp : result.fit.lamps) widenByRivals(lamp);
    for (std::size_t k = 0; k < s_.balls.size(); ++k)
      if (const std::string doubt = unmoved_[k] ? doubtOf(k, result.fit.lamps) : ""; !doubt.empty())
        result.warnings.push_back(doubt);
    return result;
  }

 private:
  struct Seen {
    std::vector<LampObservation> observations;
    std::vector<std::string> remarks;
    std::optional<Failure> failure;  ///< the first ball's
  };

  Outcome<RefinedOutline> outlineOf(std::size_t k);
  std::vector<Cutting> cuttingsForOutline(std::size_t k);
  std::vector<Seen> highlights();
  std::vector<Seen> look();
  Seen highlightsOf(const Shot& shot);
  PhotographLamps named(BallLamps fit, const std::vector<Seen>& seen);
  std::string doubtOf(std::size_t k, const std::vector<LampAnswer>& lamps) const;

  const BallShots& s_;
  Outlines outlines_;
  double givenSigmaPx_;
  const ProgressFn& progress_;
  std::map<std::size_t, Image> size_;  ///< of each ball's photographs, without pixels
  /// None if a lens bends outlines: the edge points alone then tell the ellipse.
  std::optional<OutlineCamera> outlineCamera_;
  std::vector<BallOutline> found_;
  std::vector<StillReflections> still_;  ///< of each ball
  std::vector<bool> unmoved_;            ///< of each ball: nothing on it was seen to move, so nothing tells a lamp from a window
  std::vector<std::string> warnings_;
};

/// Evenly spread photographs of one ball. The first one that can be read tells the size of all.
std::vector<Cutting> ShotReader::cuttingsForOutline(std::size_t k) {
  const NamedBall& ball = s_.balls[k];
  std::vector<fs::path> files;
  for (const Shot& shot : s_.shots)
    if (!shot.files[k].empty()) files.push_back(shot.files[k]);
  std::vector<Cutting> cuttings;
  std::size_t most = std::min(kMostForOutline, files.size()), stride = 1;
  std::optional<Failure> first;
  for (std::size_t i = 0; i < files.size() && cuttings.size() < most; i += cuttings.empty() ? 1 : stride) {
    if (!report(progress_, {"outlines", static_cast<int>(i), static_cast<int>(files.size())})) throw Stopped{};
    const auto known = size_.find(k);
    Outcome<Image> image = readShot(files[i], s_.response, known == size_.end() ? nullptr : &known->second);
    if (!image) {
      if (!first) first = image.failure();
      continue;
    }
    if (known == size_.end()) {
      Image size;
      size.width = image->width;
      size.height = image->height;
      size_[k] = size;
      const Eigen::Vector2d at = ball.outline.centre - ball.corner;
      if (at.x() < 0 || at.y() < 0 || at.x() >= size.width || at.y() >= size.height)
        throw InputError("", "--ball " + ball.text,
                         formatted("the middle of the ball lies outside of its photographs, which have %d x %d pixels",
                                   size.width, size.height));
    }
    cuttings.push_back(around(*image, ball.corner, ball.outline));
    const std::size_t bytes = cuttings.front().image.data.size() * sizeof(float);
    most = std::max<std::size_t>(1, std::min(most, kBytesForOutline / std::max<std::size_t>(1, bytes)));
    stride = std::max<std::size_t>(1, files.size() / most);
  }
  if (cuttings.empty() && first) warnings_.push_back(first->message());
  return cuttings;
}

Outcome<RefinedOutline> ShotReader::outlineOf(std::size_t k) {
  const NamedBall& ball = s_.balls[k];
  RefinedOutline given;
  given.outline = ball.outline;
  given.covariance = givenSigmaPx_ * givenSigmaPx_ * Eigen::Matrix3d::Identity();
  std::vector<Cutting> cuttings = cuttingsForOutline(k);
  if (cuttings.empty())
    return Failure{Reason::FrameUnreadable, "no photograph of ball " + std::to_string(k + 1) + " can be read" +
                                                (warnings_.empty() ? "" : "; first: " + warnings_.back())};
  const Eigen::Vector2d corner = cuttings.front().corner;
  std::vector<Image> images;
  for (Cutting& c : cuttings) images.push_back(std::move(c.image));
  still_.push_back(stillReflections(images, corner, ball.outline));
  unmoved_.push_back(images.size() < 2);
  if (outlines_ == Outlines::Given) return given;
  OutlineChoice choice = chosenOutline(refineBallOutline(images, corner, ball.outline, outlineCamera_), given);
  const std::string outline = "the outline of ball " + std::to_string(k + 1);
  if (!choice.refused.empty()) warnings_.push_back(outline + " is taken as given: " + choice.refused);
  if (choice.withinPx > 0)
    warnings_.push_back(outline +
                        formatted(" was found %.2g px inside of the given one all around: it may be a reflection's edge, so its "
                                  "radius is uncertain by that; give --ball as found (%.2f,%.2f,%.2f) to rely on it",
                                  choice.withinPx, choice.outline.outline.centre.x() - ball.corner.x(),
                                  choice.outline.outline.centre.y() - ball.corner.y(), choice.outline.outline.radius));
  return choice.outline;
}

std::vector<ShotReader::Seen> ShotReader::look() {
  std::vector<Seen> seen(s_.shots.size());
  parallelFor(
      static_cast<int>(seen.size()),
      [&](int i) { seen[static_cast<std::size_t>(i)] = highlightsOf(s_.shots[static_cast<std::size_t>(i)]); }, progress_,
      "highlights");
  return seen;
}

/// Beside what stays where it is. Where nothing else is bright on a ball, every photograph may show one and the same lamp.
std::vector<ShotReader::Seen> ShotReader::highlights() {
  std::vector<Seen> seen = look();
  bool again = false;
  for (std::size_t k = 0; k < still_.size(); ++k) {
    const bool moves = std::any_of(seen.begin(), seen.end(), [k](const Seen& s) {
      return std::any_of(s.observations.begin(), s.observations.end(), [k](const LampObservation& o) { return o.object == k; });
    });
    if (!moves && !still_[k].places.empty()) still_[k] = {}, unmoved_[k] = again = true;
    for (const Eigen::Vector2d& place : still_[k].places)
      warnings_.push_back(
          formatted("ball %zu: the bright reflection at %.0f, %.0f does not move between photographs, so it is not "
                    "the lamp's: what moves is taken",
                    k + 1, place.x() - s_.balls[k].corner.x(), place.y() - s_.balls[k].corner.y()));
  }
  return again ? look() : seen;
}

ShotReader::Seen ShotReader::highlightsOf(const Shot& shot) {
  Seen seen;
  const auto failed = [&](std::size_t k, const Failure& why) {
    seen.remarks.push_back("ball " + std::to_string(k + 1) + ": " + why.message());
    if (!seen.failure) seen.failure = Failure{why.reason, "ball " + std::to_string(k + 1) + ": " + why.detail};
  };
  fs::path last;
  Outcome<Image> image = Failure{Reason::FrameUnreadable, ""};
  for (std::size_t k = 0; k < s_.balls.size(); ++k) {
    if (shot.files[k].empty()) {
      failed(k, {Reason::FrameUnreadable, "has no photograph of this name"});
      continue;
    }
    if (shot.files[k] != last) image = readShot(last = shot.files[k], s_.response, &size_.at(k));
    if (!image) {
      failed(k, image.failure());
      continue;
    }
    const Cutting part = around(*image, s_.balls[k].corner, found_[k]);
    Outcome<LampObservation> found = findLampHighlight(part.image, part.corner, found_, k, still_[k]);
    if (!found) {
      failed(k, found.failure());
      continue;
    }
    for (DroppedHighlight& d : found->dropped) d.onlySmaller = d.onlySmaller && unmoved_[k];
    found->frame = shot.id;
    found->object = k;
    seen.observations.push_back(*std::move(found));
  }
  return seen;
}

/// What makes it doubtful that a reflection which was not seen to move is the lamp's; "" = nothing does.
std::string ShotReader::doubtOf(std::size_t k, const std::vector<LampAnswer>& lamps) const {
  // A lamp that appears 20 degrees wide is as near as three of its own widths; a window is seldom below 5. An ellipse fills
  // pi / 4 of its rectangle: well more is a rectangle, less has streaks.
  constexpr double kWideDeg = 20, kShapedDeg = 5, kElongated = 1.5, kRectangular = 0.87, kCompact = 0.72;
  const auto at = [&](const Pixel& place, const Eigen::Vector3d& towards) {
    const Pixel p = place - s_.balls[k].corner;
    return formatted("%.0f, %.0f (towards %.3f %.3f %.3f)", p.x(), p.y(), towards.x(), towards.y(), towards.z());
  };
  for (const LampAnswer& lamp : lamps)
    for (const LampSighting& s : lamp.sightings) {
      if (lamp.failure || s.ball != k) continue;
      std::string others;
      for (const DroppedSighting& d : lamp.dropped)
        if (d.ball == k && d.direction) others += (others.empty() ? "" : ", ") + at(d.place, *d.direction);
      const LampExtent e = s.extent.value_or(LampExtent{});
      const bool rectangular = e.filled > kRectangular, elongated = e.filled > kCompact && e.longDeg > kElongated * e.shortDeg;
      const char* shape = rectangular ? ", rectangular" : elongated ? ", elongated" : "";
      if (others.empty() && !(e.longDeg > (*shape ? kShapedDeg : kWideDeg))) return "";
      std::string text = formatted("ball %zu: the reflection at ", k + 1) + at(s.peak, s.direction) +
                         formatted(" may be a window's: it is %.2g x %.2g degrees wide%s", e.longDeg, e.shortDeg, shape);
      if (!others.empty()) text += ", taken as the largest; the lamp's may be the one at " + others;
      return text + ". Only motion tells: add a photograph with the lamp elsewhere";
    }
  return "";
}

PhotographLamps ShotReader::named(BallLamps fit, const std::vector<Seen>& seen) {
  PhotographLamps result;
  std::vector<LampAnswer> all;
  for (std::size_t i = 0; i < s_.shots.size(); ++i) {
    const Shot& shot = s_.shots[i];
    const auto found =
        std::find_if(fit.lamps.begin(), fit.lamps.end(), [&](const LampAnswer& l) { return l.frames.front() == shot.id; });
    LampAnswer lamp;
    if (found != fit.lamps.end())
      lamp = *found;
    else
      lamp.failure = seen[i].failure.value_or(Failure{Reason::NoHighlight, ""});
    lamp.id = "lamp-" + shot.id;
    lamp.frames = {shot.id};
    lamp.remarks.insert(lamp.remarks.end(), seen[i].remarks.begin(), seen[i].remarks.end());
    all.push_back(std::move(lamp));
    result.fileNames.push_back(shot.name);
  }
  fit.lamps = std::move(all);
  result.fit = std::move(fit);
  result.warnings = warnings_;
  return result;
}

}  // namespace

NamedBall namedBall(const std::string& text) {
  const std::string place = "--ball " + text;
  constexpr const char* kWanted = "[DIR:]CX,CY,R[@X0,Y0], all in pixels";
  NamedBall ball;
  ball.text = text;
  const std::size_t colon = text.rfind(':');
  std::string rest = colon == std::string::npos ? text : text.substr(colon + 1);
  if (colon != std::string::npos) ball.folder = text.substr(0, colon);
  if (colon == 0) throw InputError("", place, std::string("expected ") + kWanted);
  if (const std::size_t at = rest.find('@'); at != std::string::npos) {
    const std::vector<double> corner = numbersOf(rest.substr(at + 1), 2, place, kWanted);
    ball.corner = {corner[0], corner[1]};
    rest.resize(at);
  }
  const std::vector<double> numbers = numbersOf(rest, 3, place, kWanted);
  if (!(numbers[2] > 0)) throw InputError("", place, "the radius must be above 0");
  ball.outline = {ball.corner + Eigen::Vector2d(numbers[0], numbers[1]), numbers[2]};
  return ball;
}

std::vector<fs::path> BallShots::files() const {
  std::set<fs::path> all;
  for (const Shot& shot : shots)
    for (const fs::path& file : shot.files)
      if (!file.empty()) all.insert(file);
  return {all.begin(), all.end()};
}

BallShots ballShotsIn(const fs::path& input, const std::vector<NamedBall>& balls, const std::string& exclude) {
  require(!balls.empty(), "ballShotsIn: no ball");
  BallShots result;
  result.balls = balls;
  std::map<std::string, Shot> shots;
  std::vector<fs::path> folders;
  for (std::size_t k = 0; k < balls.size(); ++k) {
    folders.push_back(folderOf(input, balls[k]));
    for (std::size_t other = 0; other < k; ++other)
      if (folders[other] == folders[k] && (balls[other].outline.centre - balls[k].outline.centre).norm() <
                                              std::max(balls[other].outline.radius, balls[k].outline.radius))
        throw InputError("", "--ball " + balls[k].text, "is the same ball as --ball " + balls[other].text);
    const std::set<std::string> names = photographsIn(folders[k]);
    if (names.empty())
      throw InputError(folders[k].string(), "--ball " + balls[k].text,
                       "the folder has no photographs (PNG, JPEG, TIFF, BMP or WebP)");
    for (const std::string& name : names) {
      Shot& shot = shots[name];
      shot.name = name;
      shot.files.resize(balls.size());
      shot.files[k] = folders[k] / name;
    }
  }
  std::map<std::string, int> stems;
  for (const auto& [name, shot] : shots) ++stems[fs::path(name).stem().string()];
  Scene named;  // parseFrames() looks ids up in a scene
  for (auto& [name, shot] : shots) {
    const std::string stem = fs::path(name).stem().string();
    shot.id = stems[stem] > 1 ? name : stem;
    named.frames.emplace_back().id = shot.id;
    result.shots.push_back(shot);
  }
  if (std::all_of(balls.begin(), balls.end(), [](const NamedBall& b) { return !b.folder.empty(); }))
    result.leftOut = foldersLeftOut(folders, result.shots);
  if (exclude.empty()) return result;
  const std::vector<int> out = parseFrames(exclude, named, "--exclude");
  for (auto i = out.rbegin(); i != out.rend(); ++i) result.shots.erase(result.shots.begin() + *i);
  if (result.shots.empty()) throw InputError("", "--exclude " + exclude, "excludes every photograph");
  return result;
}

std::optional<Camera> cameraOfExif(const BallShots& shots, double& mm) {
  for (const NamedBall& ball : shots.balls)
    if (!ball.folder.empty() || !ball.corner.isZero(0)) return std::nullopt;
  std::optional<Camera> camera;
  for (const Shot* shot : {&shots.shots.front(), &shots.shots.back()}) {
    try {
      const std::string bytes = readFile(shot->files.front(), Limit::ImageMegabytes);
      const ImageHeader header = readImageHeader(bytes);
      const std::optional<double> focal = focalLength35mm(bytes);
      if (!header.problem.empty() || !focal || (camera && *focal != mm)) return std::nullopt;
      mm = *focal;
      camera = filmCamera(mm, static_cast<int>(header.width), static_cast<int>(header.height));
    } catch (const InputError&) {
      return std::nullopt;  // the search of the photograph reports it
    }
  }
  return camera;
}

Outcome<PhotographLamps> lampsOfShots(const BallShots& shots, const std::optional<Camera>& camera, bool focalAlone,
                                      const std::optional<double>& ballRadius, Outlines outlines, double givenSigmaPx,
                                      const ProgressFn& progress) {
  BallPhotographs photographs;
  photographs.camera = camera;
  photographs.focalAlone = focalAlone;
  photographs.ballRadius = ballRadius;
  return ShotReader(shots, outlines, givenSigmaPx, progress).run(std::move(photographs));
}

}  // namespace glint
