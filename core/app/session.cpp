// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/session.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "core/app/scene_places.h"
#include "core/app/session_plugins.h"
#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/base/json_dom.h"
#include "core/base/json_text.h"
#include "core/base/permitted.h"
#include "core/base/settings_dom.h"
#include "core/base/sha256.h"
#include "core/choice/tradeoff_dom.h"
#include "core/pipeline/what_if_dom.h"
#include "core/scene/scene_dom.h"
#include "core/scene/scene_files.h"
#include "core/scene/scene_json.h"
#include "core/scene/session_input.h"

namespace glint {
namespace fs = std::filesystem;
using json_dom::Json;

namespace {

/// A setting that a program of version 1 did not have is what that program did, where that is not today's default.
void migrateFrom1(const JsonNode& request, Settings& settings) {
  const std::optional<JsonNode> stored = request.find("settings");
  if (stored && !stored->find("light.limit_orders")) settings.set("light.limit_orders", 0);  // one limit angle for each light
}

/// Every program wrote all settings that it had, so that a list with the oldest ones shows by what it lacks how old it is; a list
/// by hand that leaves settings out means today's defaults.
bool writtenByProgram(const JsonNode& settings) { return settings.find("detect.clip") && settings.find("fit.solver"); }

/// A program before the fit to pixels took the smooth background, fitted contours and refused no poor fit. One before the test by
/// motion took texture for highlights.
void migrateFromBeforePixels(const JsonNode& request, Settings& settings) {
  const std::optional<JsonNode> stored = request.find("settings");
  if (!stored || !writtenByProgram(*stored)) return;
  if (!stored->find("detect.background")) settings.set("detect.background", std::string("smooth"));
  if (!stored->find("fit.evidence")) settings.set("fit.evidence", std::string("contours"));
  if (!stored->find("detect.motion")) settings.set("detect.motion", std::string("off"));
  if (!stored->find("detect.texture")) settings.set("detect.texture", std::string("off"));
  if (!stored->find("fit.most_residual")) settings.set("fit.most_residual", 10.0);  // no fit was refused for what it left
}

/// Before the fit had its own directions and walk tolerance, it took those of the prediction. A setting with its
/// default stays at it.
void giveFitItsWalks(Settings& settings) {
  for (const auto& [of, from] :
       {std::pair("fit.directions", "predict.directions"), std::pair("fit.walk_tolerance", "predict.walk_tolerance")})
    if (const auto value = settings.values().find(from); value != settings.values().end()) settings.set(of, value->second);
}

bool isBeforeWalksOfTheFit(const JsonNode& request) {
  const std::optional<JsonNode> stored = request.find("settings");
  return stored && writtenByProgram(*stored) && !stored->find("fit.directions");
}

fs::path folderOf(const fs::path& file) { return fs::absolute(file).lexically_normal().parent_path(); }

Json toJson(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

std::vector<std::string> texts(const JsonNode& node) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < node.size(); ++i) all.push_back(node.at(i).text());
  return all;
}

InspectionRequest readRequest(const JsonNode& node, const fs::path& folder) {
  InspectionRequest request;
  request.models.clear();
  std::set<std::string> named;  // one that is named twice is one model
  for (const std::string& model : texts(node.at("models")))
    if (named.insert(model).second) request.models.push_back(model);
  request.train = node.at("train").text();
  if (const auto n = node.find("excluded")) {
    for (std::size_t i = 0; i < n->size(); ++i) {
      request.excluded.push_back(n->at(i).integer());
      if (request.excluded.back() < 0) n->at(i).fail("must not be negative");
    }
  }
  if (const auto n = node.find("source")) {
    const std::string source = n->text();
    if (source != "radiance" && source != "image") n->fail("'" + source + "' is not one of: radiance, image");
    request.source = source == "image" ? FrameSource::Image : FrameSource::Radiance;
  }
  if (const auto n = node.find("settings")) request.settings = readSettings(*n);
  if (const auto n = node.find("noise_px")) {
    request.noisePx = bounded(*n, kFarthestPx);
    if (request.noisePx < 0) n->fail("must not be negative");
  }
  if (const auto n = node.find("seed")) {
    const double seed = n->number();
    if (seed != std::floor(seed) || seed < 0 || seed > std::numeric_limits<unsigned>::max())
      n->fail("must be a whole number from 0 to 4294967295");
    request.seed = static_cast<unsigned>(seed);
  }
  if (const auto n = node.find("what_if")) request.whatIf = readWhatIf(*n);
  if (const auto n = node.find("truth"); n && !n->isNull()) request.truthFolder = absolutePath(*n, folder).string();
  return request;
}

SessionCamera readCamera(const JsonNode& c) {
  SessionCamera camera{lengths3(c.at("position")), lengths3(c.at("focal_point")), lengths3(c.at("up")),
                       c.at("view_angle_deg").number()};
  if (const auto parallel = c.find("parallel")) camera.parallel = parallel->boolean();
  if (!(camera.viewAngleDeg > 0 && camera.viewAngleDeg < 180)) c.at("view_angle_deg").fail("must be between 0 and 180");
  return camera;
}

Json toJson(const SessionCamera& c) {
  Json camera = {{"position", toJson(c.position)},
                 {"focal_point", toJson(c.focalPoint)},
                 {"up", toJson(c.up)},
                 {"view_angle_deg", c.viewAngleDeg}};
  if (c.parallel) camera["parallel"] = true;
  return camera;
}

SessionView readView(const JsonNode& node) {
  SessionView view;
  if (const auto n = node.find("layout")) view.layout = n->text();
  if (const auto n = node.find("layers"))
    for (const std::string& key : n->keys()) view.layers[key] = n->at(key).boolean();
  if (const auto n = node.find("options"))
    for (const std::string& key : n->keys()) view.options[key] = n->at(key).text();
  if (const auto n = node.find("cameras"))
    for (const std::string& key : n->keys()) view.cameras[key] = readCamera(n->at(key));
  if (const auto n = node.find("more_cameras"))
    for (std::size_t i = 0; i < n->size(); ++i) view.moreCameras.push_back(readCamera(n->at(i)));
  if (const auto n = node.find("selection")) {
    if (const auto m = n->find("frame")) view.frame = m->text();
    if (const auto m = n->find("model")) view.model = m->text();
    if (const auto m = n->find("light")) view.light = m->text();
    if (const auto m = n->find("highlight")) view.highlight = m->integer();
    if (const auto m = n->find("predicted")) view.predicted = m->integer();
  }
  return view;
}

std::vector<SessionPlugin> readPlugins(const JsonNode& node) {
  std::vector<SessionPlugin> plugins;
  for (std::size_t i = 0; i < node.size(); ++i) {
    plugins.push_back({node.at(i).at("name").text(), node.at(i).at("version").text(), {}});
    if (const auto adds = node.at(i).find("adds")) plugins.back().adds = texts(*adds);
    if (plugins.back().name.empty()) node.at(i).at("name").fail("the name is empty");
  }
  return plugins;
}

std::string readHash(const JsonNode& node) {
  if (node.isNull()) return "";
  const std::string hash = node.text();
  if (hash.size() != 64 || hash.find_first_not_of("0123456789abcdef") != std::string::npos)
    node.fail("must be 64 hexadecimal digits");
  return hash;
}

}  // namespace

Session readSession(const fs::path& file) { return parseSession(readFile(file, Limit::JsonMegabytes), file); }

Session parseSession(const std::string& json, const fs::path& file) {
  const JsonNode root = JsonNode::parse(json, file.string());
  Session session;
  session.file = file;
  const fs::path folder = folderOf(file);
  const int version = readSessionVersion(root);
  SessionInput named = readSessionInput(root, folder);
  session.input = std::move(named.scene);
  session.folders = std::move(named.folders);
  session.meshes = std::move(named.meshes);
  session.choices = std::move(named.choices);
  const JsonNode input = root.at("input");
  if (const auto n = input.find("files"))
    for (std::size_t i = 0; i < n->size(); ++i)
      session.files.push_back({absolutePath(n->at(i).at("path"), folder), readHash(n->at(i).at("sha256"))});
  if (const auto n = root.find("plugins")) session.plugins = readPlugins(*n);
  session.request = namingMissingPlugins(missingPlugins(session), [&] { return readRequest(root.at("request"), folder); });
  if (version == 1) migrateFrom1(root.at("request"), session.request.settings);
  migrateFromBeforePixels(root.at("request"), session.request.settings);
  const bool oneSetOfWalks = isBeforeWalksOfTheFit(root.at("request"));
  if (oneSetOfWalks) giveFitItsWalks(session.request.settings);
  if (const auto n = root.find("frames")) {
    session.training = texts(n->at("training"));
    session.heldOut = texts(n->at("held_out"));
  }
  if (const auto n = root.find("view")) session.view = readView(*n);
  if (const auto n = root.find("recovery"); n && !n->isNull())
    session.recovery = Recovery{absolutePath(n->at("of"), folder), n->at("session").boolean()};
  if (const auto n = root.find("notes")) session.notes = n->text();
  if (const auto n = root.find("tradeoff"); n && !n->isNull()) session.tradeoff = readTradeoff(*n);
  if (session.tradeoff && oneSetOfWalks) {
    for (TradeoffPoint& p : session.tradeoff->points) giveFitItsWalks(p.settings);
    for (PrunedPoint& p : session.tradeoff->pruned) giveFitItsWalks(p.settings);
  }
  if (const auto n = root.find("results"); n && !n->isNull()) {
    const JsonNode key = n->at("key_results");
    for (const std::string& name : key.keys()) {
      const JsonNode value = key.at(name);
      session.keyResults.emplace_back(name, value.isNull() ? std::numeric_limits<double>::quiet_NaN() : value.number());
    }
    session.digest = readHash(n->at("digest"));
  }
  Json unknown = Json::object();
  for (const std::string& key : root.unknownKeys(
           {"glint_session", "input", "request", "frames", "view", "notes", "tradeoff", "results", "recovery", "plugins"})) {
    session.warnings.push_back(key + ": unknown key, kept");
    json_dom::append(unknown, key, json_dom::NodeValue::of(root.at(key)));
  }
  if (!unknown.empty()) session.unknownJson = unknown.dump();
  return session;
}

std::string sessionText(const Session& session, const fs::path& file) {
  const fs::path folder = folderOf(file);
  const auto relative = [&](const fs::path& path) {
    const fs::path r = fs::absolute(path).lexically_normal().lexically_relative(folder);
    if (r.empty()) throw InputError(path.string(), "", "has no path relative to " + folder.string());
    return r.generic_string();
  };
  const auto hash = [](const std::string& hex) { return hex.empty() ? Json() : Json(hex); };
  // A program of version 3 reads what does not need the newer one.
  Json root = {{"glint_session", session.choices.none() ? 3 : kSessionVersion}};
  root["input"] = {{"path", relative(session.input)}, {"allow_outside", session.allowOutsidePaths}, {"files", Json::array()}};
  for (const FilesFolder& f : session.folders)
    root["input"]["folders"].push_back({{"of", nameOf(f.kind)}, {"folder", relative(f.folder)}});
  for (const auto& [named, mesh] : session.meshes) root["input"]["meshes"][named] = relative(mesh);
  if (!session.choices.none()) root["input"]["reading"] = toJson(session.choices, relative);
  for (const SessionFile& f : session.files)
    root["input"]["files"].push_back({{"path", relative(f.path)}, {"sha256", hash(f.sha256)}});

  const InspectionRequest& q = session.request;
  root["request"] = {{"models", q.models},
                     {"train", q.train},
                     {"excluded", q.excluded},
                     {"source", q.source == FrameSource::Image ? "image" : "radiance"}};
  root["request"]["settings"] = toJson(q.settings);
  root["request"]["noise_px"] = q.noisePx;
  root["request"]["seed"] = q.seed;
  root["request"]["truth"] = q.truthFolder.empty() ? Json() : Json(relative(q.truthFolder));
  if (!q.whatIf.none()) root["request"]["what_if"] = toJson(q.whatIf);
  root["frames"] = {{"training", session.training}, {"held_out", session.heldOut}};

  const SessionView& v = session.view;
  root["view"] = {{"layout", v.layout}, {"layers", v.layers}, {"options", v.options}, {"cameras", Json::object()}};
  for (const auto& [name, c] : v.cameras) root["view"]["cameras"][name] = toJson(c);
  for (const SessionCamera& c : v.moreCameras) root["view"]["more_cameras"].push_back(toJson(c));
  root["view"]["selection"] = {{"frame", v.frame}, {"model", v.model}, {"light", v.light}, {"highlight", v.highlight}};
  if (v.predicted >= 0) root["view"]["selection"]["predicted"] = v.predicted;
  if (session.recovery) root["recovery"] = {{"of", relative(session.recovery->of)}, {"session", session.recovery->isSession}};
  for (const SessionPlugin& p : pluginsToRecord(session.plugins))
    root["plugins"].push_back({{"name", p.name}, {"version", p.version}, {"adds", p.adds}});
  root["notes"] = session.notes;
  if (session.tradeoff) root["tradeoff"] = toJson(*session.tradeoff);
  if (!session.keyResults.empty()) {
    Json key = Json::object();
    for (const auto& [name, value] : session.keyResults) key[name] = std::isfinite(value) ? Json(value) : Json();
    root["results"] = {{"key_results", std::move(key)}, {"digest", hash(session.digest)}};
  }
  if (!session.unknownJson.empty()) {
    const Json unknown = json_dom::parse(session.unknownJson, "");
    std::set<std::string> known;
    for (const auto& item : root.items()) known.insert(item.key());
    for (const auto& item : unknown.items())
      if (!known.count(item.key())) json_dom::append(root, item.key(), item.value());
  }
  return json_dom::prettyWithPaths(root, file.string());
}

void writeSession(const Session& session, const fs::path& file) { atomicWrite(file, sessionText(session, file)); }

MissingScene::MissingScene(const fs::path& session, fs::path scene)
    : InputError(session.string(), "input.path", "the scene " + scene.string() + " does not exist"), scene_(std::move(scene)) {}

OpenedSession openSession(const fs::path& file, const Relinked& instead) { return openSession(readSession(file), instead); }

namespace {

std::vector<fs::path> permittedFolders(const Session& session, const Relinked& instead) {
  std::vector<fs::path> named = instead.folders;
  named.insert(named.end(), instead.meshFolders.begin(), instead.meshFolders.end());
  return foldersOfSession(session.file, session.input, named);
}

}  // namespace

void requirePermittedTruth(const Session& session, const Relinked& instead) {
  if (session.allowOutsidePaths || session.request.truthFolder.empty()) return;
  const std::vector<fs::path> permitted = permittedFolders(session, instead);
  const fs::path folder = session.request.truthFolder;
  requirePermitted(folder, permitted, session.file.string(), "request.truth", "--truth DIR");
  std::error_code error;  // what cannot be listed is not read either
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->is_symlink()) requirePermitted(it->path(), permitted, session.file.string(), "request.truth", "--truth DIR");
}

namespace {

/// Compares what was relinked with what the session was made with, and forgets the hashes of where it was; saving hashes it where
/// it is. One line; "" = the same files, or not known.
std::string takeOver(Session& session, const Scene& scene, const fs::path& sceneWas, bool sceneMoved) {
  std::vector<std::string> others;
  std::set<fs::path> moved;
  const auto compare = [&](const char* what, const fs::path& was, const fs::path& now) {
    const auto known =
        std::find_if(session.files.begin(), session.files.end(), [&](const SessionFile& f) { return f.path == was; });
    if (known != session.files.end() && !known->sha256.empty() && sha256OfFile(now) != known->sha256)
      others.push_back(now.string() + " differs from the " + what + " that the session was made with");
    moved.insert(was);
  };
  if (sceneMoved && !session.files.empty()) compare("scene", session.files.front().path, scene.file);
  const fs::path folderWas = sceneMoved ? sceneWas.parent_path() : scene.folder;
  for (const auto& [named, now] : scene.meshes) {
    const auto before = session.meshes.find(named);
    const fs::path was = before != session.meshes.end() ? before->second : (folderWas / named).lexically_normal();
    if (was != now) compare("mesh", was, now);
  }
  std::erase_if(session.files, [&](const SessionFile& f) { return sceneMoved || moved.count(f.path) > 0; });
  std::string line;
  for (const std::string& other : others) line += (line.empty() ? "" : "; ") + other;
  return line;
}

}  // namespace

std::string relinkMeshes(Session& session, const Scene& scene) {
  const std::string line = takeOver(session, scene, scene.file, false);
  session.meshes = scene.meshes;
  return line;
}

OpenedSession openSession(Session given, const Relinked& instead) {
  OpenedSession opened{std::move(given), nullptr, ""};
  Session& session = opened.session;
  requirePlugins(session);
  const fs::path sceneWas = session.input;
  if (!instead.scene.empty()) session.input = fs::absolute(instead.scene).lexically_normal();
  std::error_code ignored;
  if (!fs::exists(session.input, ignored)) throw MissingScene(session.file, session.input);
  if (instead.scene.empty()) requireSceneFile(session.input, session.file.string());
  ReadOptions options;
  options.allowOutsidePaths = session.allowOutsidePaths;
  options.folders = permittedFolders(session, instead);
  if (!session.allowOutsidePaths) {
    SessionInput named{session.input, session.folders, session.meshes, session.choices};
    for (const auto& given : instead.meshes) named.meshes.erase(given.first);
    requirePermitted(named, session.file.string(), options.folders);
    requirePermittedTruth(session, instead);
  }
  options.meshes = instead.meshes;
  options.meshes.insert(session.meshes.begin(), session.meshes.end());  // what is given now stays
  options.meshFolders = instead.meshFolders;
  options.choices = session.choices;
  for (const FilesFolder& f : session.folders)
    if (f.kind == FrameFile::Photograph) options.photographs.push_back(f.folder);
  Scene scene = namingMissingPlugins(missingPlugins(session),
                                     [&] { return withFilesIn(readSceneOfSession(session.input, options), session.folders); });
  if (!session.allowOutsidePaths) requirePermittedFiles(scene, session.folders, session.file.string(), options.folders);
  if (instead.any()) opened.warning = takeOver(session, scene, sceneWas, !instead.scene.empty());
  if (const std::string plugins = pluginWarning(session); !plugins.empty())
    opened.warning += (opened.warning.empty() ? "" : "; ") + plugins;
  session.meshes = scene.meshes;
  opened.scene = std::make_shared<const Scene>(std::move(scene));
  return opened;
}

std::vector<SessionFile> hashInputs(const Scene& scene, const InspectionRequest& request, const ProgressFn& progress) {
  std::vector<fs::path> paths = filesOf(scene);
  const std::set<fs::path> seen(paths.begin(), paths.end());
  if (!request.truthFolder.empty()) {
    std::vector<fs::path> truth;
    std::error_code error;
    for (fs::directory_iterator it(request.truthFolder, error), end; !error && it != end; it.increment(error))
      if (it->is_regular_file(error)) truth.push_back(fs::absolute(it->path()).lexically_normal());
    std::sort(truth.begin(), truth.end());
    std::copy_if(truth.begin(), truth.end(), std::back_inserter(paths), [&](const fs::path& p) { return !seen.count(p); });
  }
  std::vector<SessionFile> files;
  for (const fs::path& p : paths) {
    if (!report(progress, {"hash", static_cast<int>(files.size()), static_cast<int>(paths.size())})) throw Stopped{};
    std::string hash;
    try {
      hash = sha256OfFile(p);
    } catch (const InputError&) {
      // A frame whose image is missing has its own reason in the results; the session notes that it was missing.
    }
    files.push_back({p, hash});
  }
  return files;
}

std::vector<std::string> changedFiles(const Session& session, const Relinked& instead, const ProgressFn& progress) {
  const std::vector<fs::path> permitted = permittedFolders(session, instead);
  std::vector<std::string> lines;
  int done = 0;
  for (const SessionFile& f : session.files) {
    if (!report(progress, {"hash", done++, static_cast<int>(session.files.size())})) throw Stopped{};
    std::error_code error;
    if (!session.allowOutsidePaths && !liesIn(permitted, f.path)) {
      // Neither whether it is there nor whether its hash matches: a session from others must not find out.
      lines.push_back(f.path.string() +
                      ": lies outside the folders of the session and its scene; not compared (--allow-outside accepts it)");
    } else if (!fs::exists(f.path, error)) {
      if (!f.sha256.empty()) lines.push_back(f.path.string() + ": missing");
    } else if (sha256OfFile(f.path) != f.sha256) {
      lines.push_back(f.path.string() + ": changed");
    }
  }
  return lines;
}

}  // namespace glint
