// SPDX-License-Identifier: BSD-3-Clause
#include "tests/faults/workload.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <sstream>

namespace glint::faults {

using testing_support::contentOf;
using Json = nlohmann::ordered_json;

namespace {

/// Three frames with everything that synth can write, a mesh too.
constexpr const char* kSpec = R"({"glint_scene": 1, "name": "small", "units": "m",
  "camera": {"width": 96, "height": 72, "fx": 120, "fy": 120, "cx": 47.5, "cy": 35.5},
  "surfaces": {"body": {"mesh": "ball.ply"}},
  "lights": [{"id": "lamp", "position": [1.5, -1.0, 2.2]}],
  "path": {"orbit": {"centre": [0,0,0], "radius": 1.9, "height": 0.9, "from": -1.9, "to": -0.5, "count": 3}},
  "render": {"reflectance": "ggx", "roughness": ROUGHNESS, "diffuse": 0.05, "bits": 8, "samples": 1}})";
/// An ellipsoid of some hundred triangles, for `synth` to copy.
std::string ballMesh() {
  constexpr int kRings = 10, kSides = 16;
  std::ostringstream vertices, faces;
  int n = 0;
  for (int i = 0; i <= kRings; ++i)
    for (int j = 0; j < kSides; ++j) {
      const double t = M_PI * i / kRings, p = 2 * M_PI * j / kSides;
      vertices << 0.5 * std::sin(t) * std::cos(p) << " " << 0.4 * std::sin(t) * std::sin(p) << " " << 0.35 * std::cos(t) << "\n";
    }
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSides; ++j) {
      const int a = i * kSides + j, b = i * kSides + (j + 1) % kSides, c = a + kSides, d = b + kSides;
      if (i > 0) faces << "3 " << a << " " << c << " " << b << "\n", ++n;
      if (i < kRings - 1) faces << "3 " << b << " " << c << " " << d << "\n", ++n;
    }
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string((kRings + 1) * kSides) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(n) +
         "\nproperty list uchar int vertex_indices\nend_header\n" + vertices.str() + faces.str();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
  return text;
}

std::vector<std::string> words(const std::string& line) {
  std::vector<std::string> all;
  std::istringstream in(line);
  for (std::string word; in >> word;) all.push_back(word);
  return all;
}

int framesOf(const std::string& content) {
  const testing_support::TemporaryFolder folder;
  cv::VideoCapture movie(folder.write("m.mp4", content).string());
  int frames = 0;
  while (movie.grab()) ++frames;
  return frames;
}

cv::Mat picture(const std::string& content) {
  if (content.empty()) return {};
  const cv::Mat bytes(1, static_cast<int>(content.size()), CV_8U, const_cast<char*>(content.data()));
  return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
}

std::vector<std::string> keysOf(const std::string& json) {
  const Json j = Json::parse(json, nullptr, false);
  std::vector<std::string> keys;
  if (j.is_object())
    for (const auto& item : j.items()) keys.push_back(item.key());
  return keys;
}

}  // namespace

std::vector<Workload> workloads(bool every) {
  const auto make = [](const std::string& name, const std::string& arguments, const std::string& before) {
    return Workload{name, words(arguments), words(before), "glint"};
  };
  std::vector<Workload> all = {
      make("reconstruct", "reconstruct IN/scene.json --model limit-angle -o run.glint",
           "reconstruct IN/scene.json --model canonical -o run.glint"),
      make("predict", "predict IN/limit-angle.glint --frames 4,5 --out predicted --json p.json",
           "predict IN/canonical.glint --frames 4,5 --out predicted --json p.json"),
      make("masks", "predict IN/limit-angle.glint --frames 4,5 --masks labels", ""),
      make("evaluate", "evaluate IN/scene.json --train first:4 --models limit-angle --json e.json --html e.html --csv e.csv",
           "evaluate IN/scene.json --train first:4 --models canonical --json e.json --html e.html --csv e.csv"),
      make("detect", "detect IN/scene.json --out found --json d.json",
           "detect IN/scene.json --level 0.4 --out found --json d.json"),
      make("lights", "lights IN/scene.json -o l.json -o l.csv -o l.lp",
           "lights IN/scene.json --exclude 0 -o l.json -o l.csv -o l.lp"),
      make("tradeoff",
           "tradeoff IN/scene.json --train first:4 --models canonical --repeats 1 --max-trials 2 --json t.json --html t.html -o "
           "t.glint",
           "tradeoff IN/scene.json --train first:4 --models limit-angle --repeats 1 --max-trials 2 --json t.json --html t.html "
           "-o t.glint"),
      make("synth", "synth IN/spec.json -o made", "synth IN/before.json -o made"),
      make("movie-mp4", "movie IN/limit-angle.glint --frames 0-2 --size 160x120 -o m.mp4",
           "movie IN/limit-angle.glint --frames 3-5 --size 160x120 -o m.mp4"),
      make("movie-png", "movie IN/limit-angle.glint --frames 0-2 --size 160x120 -o m.png",
           "movie IN/limit-angle.glint --frames 3-5 --size 160x120 -o m.png"),
      make("render", "render IN/limit-angle.glint --view frame --size 160x120 -o r.png",
           "render IN/limit-angle.glint --view ladder --size 160x120 -o r.png"),
      make("convert", "convert IN/scene.json -o converted.json", "convert IN/other.json -o converted.json")};
#ifdef GLINT_SAVE
  for (const char* how : {"save", "autosave"})
    all.push_back({how,
                   {how, "IN/limit-angle.glint", "limit-angle", "run.glint"},
                   {how, "IN/limit-angle.glint", "canonical", "run.glint"},
                   "glint-save"});
#endif
  const std::set<std::string> ways = {"reconstruct", "predict", "synth", "movie-mp4", "save"};
  if (!every) std::erase_if(all, [&](const Workload& w) { return !ways.count(w.name); });
  return all;
}

Stage::Stage(const Workload& workload) : workload_(workload), in_(base_ / "in"), run_(base_ / "run") {
  fs::copy(GLINT_SOURCE_DIR "/sessions/lessons/plane", in_, fs::copy_options::recursive);
  base_.write("in/ball.ply", ballMesh());
  base_.write("in/spec.json", replaced(kSpec, "ROUGHNESS", "0.2"));
  base_.write("in/before.json", replaced(kSpec, "ROUGHNESS", "0.3"));
  base_.write("in/other.json", replaced(contentOf(in_ / "scene.json"), "\"plane\"", "\"other\""));
  Json session = Json::parse(contentOf(in_ / "plane.glint"));
  session.erase("results");
  for (const char* model : {"limit-angle", "canonical"}) {
    session["request"]["models"] = {model};
    base_.write(std::string("in/") + model + ".glint", session.dump(1));
  }
  inputs_ = filesIn(in_);
  const auto filesOf = [&](const std::vector<std::string>& arguments) {
    prepare(false);
    const ChildRun run = runChild(command(arguments), run_, {.fault = Fault{}, .cores = {oneCore()}});
    EXPECT_EQ(run.code, 0) << workload_.name << ": " << run.err;
    calls_ = run.calls;
    milliseconds_ = run.milliseconds;
    said_ = run.err;
    return filesIn(run_);
  };
  if (!workload_.before.empty()) old_ = filesOf(workload_.before);
  good_ = filesOf(workload_.arguments);
  EXPECT_FALSE(good_.empty()) << workload_.name;
  EXPECT_TRUE(leftovers().empty()) << workload_.name << " leaves " << leftovers().front();
}

std::vector<std::string> Stage::command(const std::vector<std::string>& arguments) const {
  std::vector<std::string> all = {GLINT_PROGRAM};
#ifdef GLINT_SAVE
  if (workload_.program == "glint-save") all = {GLINT_SAVE};
#endif
  // Relative, as a person types it: messages name the output as it was given.
  for (const std::string& a : arguments) all.push_back(a.rfind("IN/", 0) == 0 ? "../in" + a.substr(2) : a);
  return all;
}

void Stage::prepare(bool withOld) {
  fs::remove_all(run_);
  fs::create_directories(run_);
  if (!withOld) return;
  for (const auto& [name, content] : old_) {
    fs::create_directories((run_ / name).parent_path());
    std::ofstream(run_ / name, std::ios::binary) << content;
  }
}

ChildRun Stage::run(const ChildOptions& options) const { return runChild(command(workload_.arguments), run_, options); }

Files Stage::filesIn(const fs::path& folder) {
  Files files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = contentOf(entry.path());
  return files;
}

bool Stage::isValid(const std::string& name, const std::string& content, const std::string& good) const {
  if (content == good) return true;
  const std::string ending = fs::path(name).extension().string();
  if (ending == ".json" || ending == ".glint") return !keysOf(content).empty() && keysOf(content) == keysOf(good);
  if (ending == ".html")
    return content.rfind("<!doctype html>", 0) == 0 && content.find("</html>", content.size() - 10) != std::string::npos;
  if (ending == ".csv") return std::count(content.begin(), content.end(), '\n') == std::count(good.begin(), good.end(), '\n');
  if (ending == ".png") return picture(content).size() == picture(good).size();
  if (ending == ".mp4") return framesOf(content) == framesOf(good);
  return false;
}

Found Stage::look(bool withOld, std::vector<std::string>& problems) const {
  const Files now = filesIn(run_);
  std::set<std::string> names;
  for (const auto& [name, content] : good_) names.insert(name);
  for (const auto& [name, content] : old_)
    if (withOld) names.insert(name);
  bool absent = true, old = true, complete = true, broken = false;
  for (const std::string& name : names) {
    const auto found = now.find(name), before = old_.find(name), good = good_.find(name);
    const bool there = found != now.end(), hadOld = withOld && before != old_.end();
    const bool isOld = hadOld ? there && found->second == before->second : !there;
    // An old file is as valid as a new one: where the two differ, it is not complete, else "written" and "left alone" would look
    // alike.
    const bool isNew =
        there && good != good_.end() && (found->second == good->second || (!isOld && isValid(name, found->second, good->second)));
    const bool isGood = good != good_.end() ? isNew : isOld || !there;
    if (there && !isGood && !isOld) {
      problems.push_back(name + " is neither old nor complete (" + std::to_string(found->second.size()) + " bytes)");
      broken = true;
    }
    if (hadOld && !there) problems.push_back(name + " was there before and is lost"), broken = true;
    absent = absent && !there;
    old = old && isOld;
    complete = complete && isGood;
  }
  if (broken) return Found::Broken;
  if (complete) return Found::Complete;
  if (absent) return Found::Absent;
  if (old) return Found::Old;
  return Found::Mixed;
}

std::vector<std::string> Stage::leftovers(bool work) const {
  std::set<std::string> known;
  for (const Files* files : {&good_, &old_})
    for (const auto& [name, content] : *files)
      for (fs::path p = name; !p.empty(); p = p.parent_path()) known.insert(p.string());
  std::vector<std::string> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(run_))
    if (const std::string name = fs::relative(entry.path(), run_).string(); !known.count(name))
      if (!work || name != "t.json.work") found.push_back(name);
  return found;
}

void Stage::again(std::vector<std::string>& problems) {
  if (workload_.name == "masks" && fs::exists(run_ / "labels")) return;  // it writes into a new folder only
  const ChildRun next = run({});
  if (next.code != 0) problems.push_back("the next run ends with " + std::to_string(next.code) + ": " + next.err);
  std::vector<std::string> more;
  if (look(false, more) != Found::Complete) problems.push_back("the next run does not complete");
  for (const std::string& left : leftovers()) problems.push_back("the next run leaves " + left);
}

void Piece::add(const std::string& name, const Tally& tally) { rows_.emplace_back(name, tally); }

void Piece::TearDown() {
  const char* file = std::getenv("GLINT_PIECE");
  if (!file || rows_.empty()) return;
  char date[32];
  const std::time_t now = std::time(nullptr);
  std::strftime(date, sizeof date, "%F", std::localtime(&now));
  Json piece = {{"what", what_}, {"command", command_}, {"date", date}, {"rows", Json::array()}};
  const bool partly = testing::GTEST_FLAG(filter) != "*";
  if (std::ifstream in(file); partly && in) {
    const Json earlier = Json::parse(in);
    for (const Json& row : earlier.at("rows"))
      if (std::none_of(rows_.begin(), rows_.end(), [&](const auto& r) { return r.first == row.at("name"); }))
        piece["rows"].push_back(row);
  }
  for (const auto& [name, tally] : rows_) {
    std::string note;
    for (const auto& [outcome, count] : tally.outcomes)
      note += (note.empty() ? "" : "; ") + outcome + ": " + std::to_string(count);
    if (partly) note += (note.empty() ? "" : ", ") + std::string(date);
    piece["rows"].push_back({{"name", name}, {"count", tally.runs}, {"findings", tally.problems}, {"note", note}});
  }
  std::ofstream(file) << piece.dump(1) << "\n";
}

int runTests(int argc, char** argv, Piece*& piece, const char* what, const char* command) {
  testing::InitGoogleMock(&argc, argv);
  piece = new Piece(what, command);
  testing::AddGlobalTestEnvironment(piece);  // which owns it
  return RUN_ALL_TESTS();
}

}  // namespace glint::faults
