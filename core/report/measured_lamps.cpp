// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/measured_lamps.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/app/lamp_answer.h"
#include "core/base/atomic_file.h"
#include "core/base/image_header.h"
#include "core/base/number_text.h"
#include "core/pipeline/inspection.h"
#include "core/report/texts.h"

namespace glint {

namespace {

constexpr int kLensNumbers = 5;  // k1 k2 p1 p2 k3: those that --camera takes
constexpr double kMuchMore = 2;  // times the residuals that detection promises: it is right to about that

void sayHowManyFailed(LampsReport& report) {
  const auto failed = [](const LampAnswer& lamp) { return lamp.failure.has_value(); };
  const auto first = std::find_if(report.lamps.begin(), report.lamps.end(), failed);
  const auto without = std::count_if(report.lamps.begin(), report.lamps.end(), failed);
  const auto all = static_cast<std::ptrdiff_t>(report.lamps.size());
  if (without == 0 || without == all) return;
  report.warnings.insert(report.warnings.begin(), std::to_string(without) + " of " + std::to_string(all) +
                                                      " lamps have no answer; first: " + first->id + ": " +
                                                      first->failure->message());
}

void sayWhatIsMissing(const BallQuestion& q, bool camera, LampsReport& report) {
  if (!camera)
    report.warnings.emplace_back(
        "no focal length is known: directions assume a distant camera, which costs up to about the angle between the ball's far "
        "edge and the image's middle, and lamps have no positions; state the camera to get them");
  if (!camera && q.ballRadius)
    report.warnings.emplace_back("the balls' radius has no use without a focal length: state the camera, too");
  if (camera && q.balls.size() > 1 && !q.ballRadius)
    report.warnings.emplace_back("all balls are taken to be of one size, whose radius is the unit of length");
  if (report.balls && report.balls->noiseFactor > kMuchMore)
    report.warnings.push_back(
        formatted("the highlights disagree %.2g times as much as their detection promises; every standard "
                  "deviation is widened by that",
                  report.balls->noiseFactor));
}

/// Places of two cut-outs of one shot that have the same corner are those of no shot: a camera would take them for its own.
void requireCorners(const BallShots& shots) {
  for (std::size_t j = 1; j < shots.balls.size(); ++j)
    for (std::size_t i = 0; i < j; ++i)
      for (const Shot& shot : shots.shots)
        if (!shot.files[i].empty() && !shot.files[j].empty() && shot.files[i] != shot.files[j] &&
            shots.balls[i].corner == shots.balls[j].corner)
          throw InputError("", "--ball " + shots.balls[j].text,
                           formatted("its photographs have the same corner in the shot, %g,%g, as those of another ball: with a "
                                     "camera, state the place of each cut-out by @X0,Y0",
                                     shots.balls[j].corner.x(), shots.balls[j].corner.y()));
}

/// What EXIF data of photographs tell viewers to do; "" if all are shown as they are stored.
std::string turnedByViewers(const BallShots& shots) {
  int turned = 0, first = 1;
  const std::vector<std::filesystem::path> files = shots.files();
  for (const std::filesystem::path& file : files) {
    try {
      const int orientation = exifOrientation(readFile(file, Limit::ImageMegabytes));
      if (orientation != 1 && turned++ == 0) first = orientation;
    } catch (const InputError&) {
      continue;  // the search of the photograph reports it
    }
  }
  if (turned == 0) return "";
  return formatted(
      "%d of %zu photographs have an EXIF orientation (%d): viewers turn them, Glint does not; outlines and directions "
      "are those of the stored pixels, not of what a viewer shows",
      turned, files.size(), first);
}

/// All lamps that have an answer in one direction: several lamps are not.
void sayOneDirection(LampsReport& report) {
  constexpr double kOneDirectionDeg = 1;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const LampAnswer& lamp : report.lamps)
    if (!lamp.failure) mean += lamp.direction;
  int answers = 0;
  double widest = 0;
  for (const LampAnswer& lamp : report.lamps)
    if (!lamp.failure)
      ++answers, widest = std::max(widest, std::atan2(lamp.direction.cross(mean).norm(), lamp.direction.dot(mean)) * 180 / M_PI);
  if (answers < 2 || widest > kOneDirectionDeg) return;
  report.warnings.insert(
      report.warnings.begin(),
      formatted("all %d lamps have one direction, to within %.2g degrees: either every photograph shows the same "
                "lamp, or the reflection is not the lamp's but that of a window or another fixed thing",
                answers, std::max(widest, 0.01)));
}

std::string ballText(const NamedBall& ball) {
  const Eigen::Vector2d at = ball.outline.centre - ball.corner;
  std::string text = ball.folder.empty() ? "" : ball.folder + ":";
  text += shortestText(at.x()) + "," + shortestText(at.y()) + "," + shortestText(ball.outline.radius);
  if (!ball.corner.isZero(0)) text += "@" + shortestText(ball.corner.x()) + "," + shortestText(ball.corner.y());
  return text;
}

}  // namespace

InspectionRequest lampsRequest(const InspectionRequest& asked, const Scene& scene) {
  InspectionRequest request = asked;
  request.models.clear();
  request.noisePx = 0;
  request.train = "first:" + std::to_string(scene.frames.size());
  return request;
}

LampsReport lampsReportOf(const Inspection& inspection, const std::string& input, const ProgressFn& progress) {
  LampsReport report;
  report.input = input;
  report.lengthUnit = "m";
  report.lamps = lampsOfScene(inspection, progress);
  for (const LampAnswer& lamp : report.lamps)
    if (!lamp.remarks.empty()) report.warnings.push_back(lamp.id + ": " + lamp.remarks.front());
  sayHowManyFailed(report);
  return report;
}

Outlines outlinesOf(const std::string& text) {
  for (const Outlines o : {Outlines::Fitted, Outlines::Edges, Outlines::Given})
    if (text == toText(o)) return o;
  throw std::invalid_argument("outlinesOf: " + text);
}

const char* toText(Outlines outlines) {
  return outlines == Outlines::Given ? "given" : outlines == Outlines::Edges ? "edges" : "fitted";
}

Outcome<LampsReport> lampsReportOf(const BallQuestion& q, const BallShots& shots, const ProgressFn& progress) {
  if (q.camera) requireCorners(shots);
  const std::string turned = turnedByViewers(shots);
  double filmMm = 0;
  std::optional<Camera> camera = q.camera;
  if (!camera) camera = cameraOfExif(shots, filmMm);
  const bool focalAlone = camera && !q.camera;
  Outcome<PhotographLamps> found = lampsOfShots(shots, camera, focalAlone, q.ballRadius, q.outlines, q.outlineSigmaPx, progress);
  if (!found && turned.empty()) return found.failure();
  if (!found) return Failure{found.failure().reason, found.failure().detail + "; " + turned};
  LampsReport report;
  report.input = q.input;
  report.lengthUnit = !camera ? "" : q.ballRadius ? "m" : "ball radius";
  report.lamps = std::move(found->fit.lamps);
  for (std::size_t i = 0; i < report.lamps.size(); ++i)
    if (!report.lamps[i].failure) report.lines.push_back({found->fileNames[i], report.lamps[i].direction});
  report.balls = std::move(found->fit);
  report.warnings = found->warnings;
  for (const std::string& folder : shots.leftOut)
    report.warnings.push_back("the folder '" + folder +
                              "' has photographs of the same shots and no ball is outlined in it: it is not measured");
  if (!turned.empty()) report.warnings.push_back(turned);
  sayOneDirection(report);
  if (const std::string doubt = shots.response.doubt(); !doubt.empty()) report.warnings.push_back(doubt);
  if (focalAlone)
    report.warnings.push_back(
        formatted("the focal length is that of EXIF, %g mm on 35 mm film, with the principal point in the "
                  "middle and no lens distortion: directions only, good to about half a degree; state the camera for positions",
                  filmMm));
  sayWhatIsMissing(q, camera.has_value(), report);
  sayHowManyFailed(report);
  if (!turned.empty() && nothingMeasured(report)) report.lamps.front().failure->detail += "; " + turned;
  return report;
}

std::optional<Failure> nothingMeasured(const LampsReport& report) {
  if (report.lamps.empty()) return Failure{Reason::NoLight, "no frame names or shows a lamp"};
  for (const LampAnswer& lamp : report.lamps)
    if (!lamp.failure) return std::nullopt;
  const LampAnswer& first = report.lamps.front();
  return Failure{first.failure->reason, "no lamp has an answer; first: " + first.id + ": " + first.failure->detail};
}

OutputKind lampsKind(const std::string& file, const std::string& place) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending == ".json") return OutputKind::document("glint_lights");
  const std::string header = kLampsCsvHeader;
  if (ending == ".csv") return OutputKind::table(header.substr(0, header.rfind(',')));  // earlier versions had no last column
  if (ending == ".lp") return OutputKind::lightPositions();
  throw InputError(file, place, "the ending chooses what is written: .json, .csv or .lp");
}

std::string lampsText(const LampsReport& report, const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  return ending == ".json" ? lampsJson(report) : ending == ".csv" ? lampsCsv(report) : lampsLp(report);
}

std::string cameraText(const Camera& camera) {
  const Eigen::Matrix3d& k = camera.pixelFromRay;
  std::string text;
  for (const double v : {k(0, 0), k(1, 1), k(0, 2), k(1, 2)}) text += (text.empty() ? "" : ",") + shortestText(v);
  if (camera.hasDistortion())
    for (int i = 0; i < kLensNumbers; ++i) text += "," + shortestText(camera.lens.parameters[static_cast<std::size_t>(i)]);
  return text;
}

std::string lightsCommand(const BallQuestion& q) {
  std::string text = "glint lights " + shellWord(q.input);
  for (const NamedBall& ball : q.balls) text += " --ball " + shellWord(ballText(ball));
  if (q.camera) text += " --camera " + cameraText(*q.camera);
  if (q.ballRadius) text += " --ball-radius " + shortestText(*q.ballRadius);
  if (q.outlines != Outlines::Fitted) text += std::string(" --outlines ") + toText(q.outlines);
  if (q.outlineSigmaPx != BallQuestion{}.outlineSigmaPx) text += " --outline-sigma " + shortestText(q.outlineSigmaPx);
  if (!q.exclude.empty()) text += " --exclude " + shellWord(q.exclude);
  return text;
}

}  // namespace glint
