// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "cli/scene_arguments.h"
#include "core/base/number_text.h"
#include "core/report/lamps_report.h"
#include "core/report/measured_lamps.h"
#include "core/scene/capture.h"
#include "core/scene/frame_name.h"
#include "core/scene/outputs.h"

namespace glint::cli {
namespace {

struct LightsArguments {
  std::string input, json, on, ballRadius, exclude, source = "radiance", outlines = "fitted";
  double outlineSigmaPx = 1;  // the accuracy of a circle that a person draws
  std::vector<std::string> balls, set, out;
  SceneArguments places;
};

void checkOutputs(const LightsArguments& a, Outputs outputs) {
  for (const std::string& file : a.out) outputs.file(file, "-o", lampsKind(file, "-o"));
  outputs.file(a.json, "--json", OutputKind::document("glint_lights"));
  outputs.file(a.on, "--on", OutputKind::table(kLampsOnCsvHeader));
}

std::optional<double> radiusOf(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::optional<double> radius = numberFrom(text);
  if (!radius || !(*radius > 0)) throw InputError("", "--ball-radius " + text, "expected a radius in metres, above 0");
  return radius;
}

/// What only one of the two kinds of input has a use for.
void refuseOthers(const LightsArguments& a) {
  const bool balls = !a.balls.empty();
  for (const auto& [flag, text] : a.places.reading)
    if (balls && !text.empty() && flag != "--camera" && flag != "--response")
      throw InputError("", flag + " " + text, "has no use with --ball: photographs of balls need no scene");
  if (balls && !a.on.empty()) throw InputError("", "--on", "has no use with --ball: one lamp is on in each photograph");
  if (balls && !a.set.empty())
    throw InputError("", "--set " + a.set.front(), "has no use with --ball: settings are those of scenes");
  if (!balls && !a.ballRadius.empty()) throw InputError("", "--ball-radius", "is for photographs of balls: give --ball, too");
  std::error_code ignored;  // what cannot be asked about is no folder
  if (balls && !std::filesystem::is_directory(a.input, ignored))
    throw InputError(a.input, "", "with --ball, INPUT is a folder of photographs");
}

LampsReport ofBalls(const LightsArguments& a, const Context& context) {
  BallQuestion question;
  question.input = a.input;
  for (const std::string& text : a.balls) question.balls.push_back(namedBall(text));
  question.exclude = a.exclude;
  question.ballRadius = radiusOf(a.ballRadius);
  question.outlines = outlinesOf(a.outlines);
  question.outlineSigmaPx = a.outlineSigmaPx;
  if (!(a.outlineSigmaPx > 0 && std::isfinite(a.outlineSigmaPx)))
    throw InputError("", "--outline-sigma", "expected a number of pixels above 0");
  if (const auto given = a.places.reading.find("--camera"); given != a.places.reading.end() && !given->second.empty())
    question.camera = cameraOfNumbers(cameraNumbers(given->second, "--camera"));
  BallShots shots = ballShotsIn(a.input, question.balls, a.exclude);
  shots.response = responseOf(a.places.choices());
  checkOutputs(a, Outputs(shots.files()));
  Outcome<LampsReport> report = lampsReportOf(question, shots, context.progress());
  if (!report) throw CannotAnswer{report.failure()};
  return *std::move(report);
}

/// Which lamps are on: their fits are of the frames that name theirs.
void prepareOn(const Scene& scene, InspectionRequest& request) {
  request.models = {levelSetModel().id()};
  std::string frames;
  for (std::size_t i = 0; i < scene.frames.size(); ++i)
    if (!scene.frames[i].lightsOn.empty()) frames += (frames.empty() ? "" : ",") + std::to_string(i);
  if (frames.empty()) throw CannotAnswer{{Reason::NoLight, "--on: no frame names a lamp (lights_on), so none can be told apart"}};
  request.train = frames;
}

std::string writeOn(const LightsArguments& a, const Inspection& inspection, LampsReport& report, const Context& context) {
  const LampsOn on = lampsOnIn(inspection, context.progress());
  context.write(a.on, lampsOnCsv(on, *inspection.scene));
  for (const std::string& w : on.warnings) report.warnings.push_back(w);
  return lampsOnSummary(on);
}

/// It does not help users with photographs of mirror balls to be asked for poses.
Scene sceneOf(const LightsArguments& a) {
  try {
    return a.places.read(a.input);
  } catch (const UndecidedInput& e) {
    if (e.question() != UndecidedInput::Question::Poses) throw;
    throw InputError("", "",
                     std::string(e.what()) +
                         "; or, for photographs of mirror balls by one fixed camera, the outline of each ball by "
                         "--ball CX,CY,R");
  }
}

LampsReport ofScene(const LightsArguments& a, const Context& context) {
  InspectionRequest request;
  if (a.source == "image") request.source = FrameSource::Image;
  applyEach(request.settings, a.set);
  const auto scene = std::make_shared<const Scene>(sceneOf(a));
  for (const std::string& w : scene->warnings) context.warn(w);
  if (!a.exclude.empty()) request.excluded = parseFrames(a.exclude, *scene, "--exclude");
  if (request.excluded.size() == scene->frames.size()) throw InputError("", "--exclude " + a.exclude, "excludes every frame");
  InspectionRequest asked = lampsRequest(request, *scene);
  if (!a.on.empty()) prepareOn(*scene, asked);
  checkOutputs(a, Outputs(a.input, *scene));
  const Inspection inspection = inspect(scene, asked, context.progress());
  LampsReport report = lampsReportOf(inspection, a.input, context.progress());
  if (!a.on.empty()) {
    const std::string summary = writeOn(a, inspection, report, context);
    if (a.json != "-" && a.on != "-") context.print(summary);
  }
  const bool lines =
      std::any_of(a.out.begin(), a.out.end(), [](const std::string& f) { return std::filesystem::path(f).extension() == ".lp"; });
  if (lines) report.lines = lampLinesOf(*inspection.scene, report.lamps, report.warnings);
  return report;
}

void write(const LightsArguments& a, const LampsReport& report, const Context& context) {
  for (const std::string& file : a.out) context.write(file, lampsText(report, file));
  if (!a.json.empty()) context.write(a.json, lampsJson(report));
}

int run(const LightsArguments& a, const Context& context) {
  refuseOthers(a);
  for (const std::string& file : a.out) lampsKind(file, "-o");
  const LampsReport report = a.balls.empty() ? ofScene(a, context) : ofBalls(a, context);
  write(a, report, context);
  for (const std::string& w : report.warnings) context.warn(w);
  if (a.json != "-" && a.on != "-") context.print(lampsTable(report));
  if (const std::optional<Failure> nothing = nothingMeasured(report)) throw CannotAnswer{*nothing};
  return kDone;
}

}  // namespace

Command lightsCommand() {
  const auto a = std::make_shared<LightsArguments>();
  Command c;
  c.name = "lights";
  c.summary = "Find where the lamps are, from highlights on known objects";
  c.description =
      "INPUT is a scene whose frames name their lamps, or, with --ball, a folder of photographs of mirror balls by one fixed\n"
      "camera, one lamp in each. Each lamp gets a position with its covariance where the data determine a distance, else a\n"
      "direction and the reason. Photographs: the camera is at the origin, x right, y down, z forward; without --camera\n"
      "only directions are known. A shot cut into one folder for each ball: --ball DIR:CX,CY,R@X0,Y0, paired by file name;\n"
      "the outline in pixels of the cut-out, X0,Y0 the place of its first pixel in the shot.";
  c.examples =
      "  glint lights scene.json -o lamps.json\n"
      "  glint lights scene.json --on lamps-on.csv            which lamps are on in each frame\n"
      "  glint lights photographs --ball 536,477,421 -o lamps.lp -o lamps.csv\n"
      "  glint lights . --ball left:536,477,421@0,50 --ball right:485,532,417@2750,0 --camera 4000,4000,1850,1000\n";
  c.declare = [a](Options& o) {
    o.positional(a->input, "INPUT", "Scene, capture, folder with one or session; with --ball a folder of photographs");
    o.repeated(a->balls, "--ball", "[DIR:]CX,CY,R[@X0,Y0]",
               "Outline of a mirror ball, px; DIR: folder of cut-outs, X0,Y0: their corner in the shot; may be repeated");
    o.option(a->ballRadius, "--ball-radius", "M", "Radius of every ball, m (default: lengths are in ball radii)");
    o.choice(a->outlines, "--outlines", {"fitted", "edges", "given"},
             "Balls' outlines: fitted to edges and highlights, to the photographs' edges alone, or as given");
    o.option(a->outlineSigmaPx, "--outline-sigma", "S", "Standard deviation of a given outline's centre and radius, px");
    o.option(a->exclude, "--exclude", "SPEC", "Frames or photographs to leave out: numbers, ids or ranges");
    o.choice(a->source, "--source", {"radiance", "image"}, "Pixels to use where a frame of a scene has both");
    o.repeated(a->set, "--set", "KEY=VALUE", "Any setting of scenes by its dotted name (`glint settings`); may be repeated");
    o.repeated(a->out, "-o,--out", "FILE", "Write .json, .csv or .lp (RTI), by the ending; may be repeated");
    o.option(a->on, "--on", "FILE",
             "For a scene, write which lamps are on in each frame, with confidence, as CSV (- = standard output)");
    o.option(a->json, "--json", "FILE", "Write JSON to this file (- = standard output, replaces the table)");
    a->places.declare(o);
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
