// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/input_choices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/bounded_json.h"
#include "core/base/number_text.h"
#include "core/base/outcome.h"
#include "core/scene/scene_dom.h"
#include "io/text_scan.h"

namespace glint {
namespace {
using json_dom::Json;

constexpr std::array<std::pair<const char*, double>, 3> kUnits{{{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}}};
constexpr const char* kCameraForm = "expected fx,fy,cx,cy or fx,fy,cx,cy,k1,k2,p1,p2[,k3]";
constexpr const char* kByOrder = "order";
constexpr std::size_t kLongestChoice = 200;  // bytes of a name that a session gives: "colmap", "12", "original"

std::string commaList(const std::vector<double>& values) {
  std::string text;
  for (const double v : values) text += (text.empty() ? "" : ",") + shortestText(v);
  return text;
}

std::string surfaceText(const InputChoices& c) {
  switch (c.surface) {
    case InputChoices::Surface::Default: return "";
    case InputChoices::Surface::File: return c.surfaceFile.string();
    case InputChoices::Surface::Depth: return "depth";
    case InputChoices::Surface::Points: return "points";
  }
  return "";
}

/// What is wrong, or nothing.
std::string problemOfCamera(const std::vector<double>& v) {
  if (v.size() != 4 && v.size() != 8 && v.size() != 9) return kCameraForm;
  if (!(v[0] > 0) || !(v[1] > 0)) return "focal lengths must be positive";
  for (std::size_t i = 0; i < v.size(); ++i)
    if (!(std::abs(v[i]) <= (i < 4 ? kFarthestPx : kLargestFactor))) return "a number is too large";
  return "";
}

std::filesystem::path pathIn(const std::filesystem::path& folder, const JsonNode& node) {
  const std::string path = node.text();
  if (path.empty() || path.find('\0') != std::string::npos) node.fail("is not a path");
  return (folder / std::filesystem::path(path)).lexically_normal();
}

std::string shortText(const JsonNode& node) {
  std::string text = node.text();
  if (text.empty() || text.size() > kLongestChoice || text.find('\0') != std::string::npos) node.fail("is not a name");
  return text;
}

}  // namespace

namespace {
void setSurface(InputChoices& c, const std::string& text) {
  c.surface = text == "depth"    ? InputChoices::Surface::Depth
              : text == "points" ? InputChoices::Surface::Points
                                 : InputChoices::Surface::File;
  if (c.surface != InputChoices::Surface::File) return;
  std::error_code ignored;  // a file that cannot be looked at counts as missing
  if (!std::filesystem::is_regular_file(text, ignored))
    throw InputError("", "--surface " + text, "no such file; expected a mesh or a cloud, depth, or points");
  c.surfaceFile = std::filesystem::absolute(text).lexically_normal();
}

void setPoses(InputChoices& c, const std::string& text) {
  std::error_code ignored;  // a file that cannot be looked at counts as missing
  if (!std::filesystem::is_regular_file(text, ignored))
    throw InputError("", "--poses " + text, "no such file; expected TUM or JSON lines");
  c.poses = std::filesystem::absolute(text).lexically_normal();
}

void setPosesBy(InputChoices& c, const std::string& text) {
  if (text != kByOrder) throw InputError("", "--poses-by " + text, "expected order");
  c.posesByOrder = true;
}

void setResponse(InputChoices& c, const std::string& text) {
  const std::string place = "--response " + text;
  std::error_code ignored;  // a file that cannot be looked at counts as missing
  const bool isFile = !CameraResponse::named(text, "", place);
  if (isFile && !std::filesystem::is_regular_file(text, ignored))
    throw InputError("", place, "is neither srgb, linear, gamma:G, s-curve:S, vignetting:K, nor a file");
  c.response = isFile ? std::filesystem::absolute(text).lexically_normal().string() : text;
}

void setDepthScale(InputChoices& c, const std::string& text) {
  const std::optional<double> value = io::numberOf(text);
  if (!value || !(*value > 0) || !(*value <= kLargestFactor))
    throw InputError("", "--depth-scale " + text, "expected a number above 0");
  c.depthScale = *value;
}
}  // namespace

const std::vector<ChoiceOption>& choiceOptions() {
  using C = InputChoices;
  using Text = const std::string&;
  static const std::vector<ChoiceOption> options = {
      {"--as", "KIND", "Which input is meant where a folder holds several: scene, colmap, nvm, nerfstudio, tum, bundler, bop",
       [](C& c, Text t) { c.as = t; }, [](const C& c) { return c.as; }},
      {"--surface", "FILE|depth|points",
       "Surface of a capture: a mesh or cloud, the frames' own depth maps, or its sparse points (default: the one mesh in its "
       "folder, else depth)",
       setSurface, surfaceText},
      {"--camera", "FX,FY,CX,CY[,K1,K2,P1,P2,K3]",
       "Intrinsics of a capture that has none (TUM, images, videos), px; (0,0) is the centre of the first pixel",
       [](C& c, Text t) { c.camera = cameraNumbers(t, "--camera " + t); }, [](const C& c) { return commaList(c.camera); }},
      {"--object", "ID", "Object of a BOP scene", [](C& c, Text t) { c.object = t; }, [](const C& c) { return c.object; }},
      {"--units", "m|cm|mm|NUMBER", "Unit of a capture's poses, or metres per unit (default: the program's own, else m)",
       [](C& c, Text t) { c.metresPerUnit = metresOfUnit(t, "--units " + t); },
       [](const C& c) { return c.metresPerUnit ? unitOfMetres(*c.metresPerUnit) : std::string(); }},
      {"--surface-units", "m|cm|mm|NUMBER", "Unit of a capture's mesh, or metres per unit (default: that of its poses)",
       [](C& c, Text t) { c.surfaceMetresPerUnit = metresOfUnit(t, "--surface-units " + t); },
       [](const C& c) { return c.surfaceMetresPerUnit ? unitOfMetres(*c.surfaceMetresPerUnit) : std::string(); }},
      {"--depth-scale", "S", "Metres per stored unit of a capture's depth maps (default: the program's own)", setDepthScale,
       [](const C& c) { return c.depthScale ? shortestText(*c.depthScale) : std::string(); }},
      {"--world", "original", "nerfstudio: undo applied_transform and applied_scale", [](C& c, Text t) { c.world = t; },
       [](const C& c) { return c.world; }},
      {"--poses", "FILE",
       "Poses of a folder of images or of a video: TUM lines (paired by time), or JSON lines (by id; of a video by time)",
       setPoses, [](const C& c) { return c.poses.string(); }},
      {"--poses-by", "order", "The n-th pose is that of the n-th image (default: by id or time)", setPosesBy,
       [](const C& c) { return std::string(c.posesByOrder ? kByOrder : ""); }},
      {"--response", "srgb|linear|gamma:G|s-curve:S|vignetting:K|FILE",
       "How the codes of a capture's images become linear light (default: by file type, mostly srgb)", setResponse,
       [](const C& c) { return c.response; }}};
  return options;
}

double metresOfUnit(const std::string& unit, const std::string& option) {
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& u) { return unit == u.first; });
  if (found != kUnits.end()) return found->second;
  const std::optional<double> number = io::numberOf(unit);
  if (!number || !(*number > 0) || !(*number <= kLargestFactor))
    throw InputError("", option, "'" + unit + "' is not one of: m, cm, mm, or metres per unit");
  return *number;
}

std::string unitOfMetres(double metres) {
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& u) { return metres == u.second; });
  return found == kUnits.end() ? shortestText(metres) : found->first;
}

std::vector<double> cameraNumbers(const std::string& text, const std::string& option) {
  std::vector<double> numbers;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const std::optional<double> value = io::numberOf(std::string_view(text).substr(from, to - from));
    if (!value || !std::isfinite(*value)) throw InputError("", option, kCameraForm);
    numbers.push_back(*value);
    from = to + 1;
  }
  if (const std::string problem = problemOfCamera(numbers); !problem.empty()) throw InputError("", option, problem);
  return numbers;
}

Camera cameraOfNumbers(const std::vector<double>& numbers) {
  require(problemOfCamera(numbers).empty(), "cameraOfNumbers: not a camera");
  Camera camera;
  camera.pixelFromRay << numbers[0], 0, numbers[2], 0, numbers[1], numbers[3], 0, 0, 1;
  std::copy(numbers.begin() + 4, numbers.end(), camera.lens.parameters.begin());
  return camera;
}

CameraResponse responseOf(const InputChoices& choices) {
  if (choices.response.empty()) return {};
  if (std::optional<CameraResponse> known = CameraResponse::named(choices.response, "", "--response " + choices.response))
    return *known;
  return CameraResponse::ofFile(choices.response);
}

std::filesystem::path responseFileOf(const InputChoices& choices) {
  if (choices.response.empty() || CameraResponse::named(choices.response, "", "--response " + choices.response)) return {};
  return choices.response;
}

InputChoices readInputChoices(const JsonNode& node, const std::filesystem::path& folder) {
  InputChoices c;
  if (const auto n = node.find("as")) c.as = shortText(*n);
  if (const auto n = node.find("surface")) {
    const std::string surface = n->text();
    if (surface != "depth" && surface != "points" && surface != "file") n->fail("must be depth, points or file");
    c.surface = surface == "depth"    ? InputChoices::Surface::Depth
                : surface == "points" ? InputChoices::Surface::Points
                                      : InputChoices::Surface::File;
  }
  if (c.surface == InputChoices::Surface::File) c.surfaceFile = pathIn(folder, node.at("surface_file"));
  if (const auto n = node.find("camera")) {
    c.camera = n->numbers();
    if (const std::string problem = problemOfCamera(c.camera); !problem.empty()) n->fail(problem);
  }
  if (const auto n = node.find("object")) c.object = shortText(*n);
  if (const auto n = node.find("metres_per_unit")) c.metresPerUnit = positive(*n, kLargestFactor);
  if (const auto n = node.find("surface_metres_per_unit")) c.surfaceMetresPerUnit = positive(*n, kLargestFactor);
  if (const auto n = node.find("depth_scale")) c.depthScale = positive(*n, kLargestFactor);
  if (const auto n = node.find("world")) c.world = shortText(*n);
  if (const auto n = node.find("poses")) c.poses = pathIn(folder, *n);
  if (const auto n = node.find("poses_by")) {
    if (n->text() != kByOrder) n->fail("must be order");
    c.posesByOrder = true;
  }
  if (const auto n = node.find("response")) {
    c.response = shortText(*n);
    if (!CameraResponse::named(c.response, n->file(), n->place()))
      n->fail("must be srgb, linear, gamma:G, s-curve:S or vignetting:K");
  }
  if (const auto n = node.find("response_file")) c.response = pathIn(folder, *n).string();
  return c;
}

Json toJson(const InputChoices& c, const std::function<std::string(const std::filesystem::path&)>& relative) {
  Json j = Json::object();
  if (!c.as.empty()) j["as"] = c.as;
  switch (c.surface) {
    case InputChoices::Surface::Default: break;
    case InputChoices::Surface::Depth: j["surface"] = "depth"; break;
    case InputChoices::Surface::Points: j["surface"] = "points"; break;
    case InputChoices::Surface::File:
      j["surface"] = "file";
      j["surface_file"] = relative(c.surfaceFile);
      break;
  }
  if (!c.camera.empty()) j["camera"] = c.camera;
  if (!c.object.empty()) j["object"] = c.object;
  if (c.metresPerUnit) j["metres_per_unit"] = *c.metresPerUnit;
  if (c.surfaceMetresPerUnit) j["surface_metres_per_unit"] = *c.surfaceMetresPerUnit;
  if (c.depthScale) j["depth_scale"] = *c.depthScale;
  if (!c.world.empty()) j["world"] = c.world;
  if (!c.poses.empty()) j["poses"] = relative(c.poses);
  if (c.posesByOrder) j["poses_by"] = kByOrder;
  if (const std::filesystem::path file = responseFileOf(c); !file.empty())
    j["response_file"] = relative(file);
  else if (!c.response.empty())
    j["response"] = c.response;
  return j;
}

}  // namespace glint
