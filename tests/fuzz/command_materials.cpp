// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/command_materials.h"

#include <Eigen/Geometry>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace glint::fuzz {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

void write(const fs::path& file, const std::string& content) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
}

std::string contentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// A sphere of 512 triangles: an octahedron, divided three times.
struct Ball {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
};
Ball ball(double radius) {
  Ball b;
  const auto add = [&](Eigen::Vector3d v) {
    v = radius * v.normalized();
    for (std::size_t i = 0; i < b.vertices.size(); ++i)
      if ((b.vertices[i] - v).norm() < 1e-9 * radius) return static_cast<int>(i);
    b.vertices.push_back(v);
    return static_cast<int>(b.vertices.size() - 1);
  };
  const std::function<void(const Eigen::Vector3d&, const Eigen::Vector3d&, const Eigen::Vector3d&, int)> divide =
      [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r, int depth) {
        if (depth == 0) return b.triangles.push_back(Eigen::Vector3i(add(p), add(q), add(r)));
        const Eigen::Vector3d pq = (p + q).normalized(), qr = (q + r).normalized(), rp = (r + p).normalized();
        divide(p, pq, rp, depth - 1);
        divide(pq, q, qr, depth - 1);
        divide(rp, qr, r, depth - 1);
        divide(pq, qr, rp, depth - 1);
      };
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        const Eigen::Vector3d a(x, 0, 0), c(0, y, 0), d(0, 0, z);
        if (x * y * z > 0)
          divide(a, c, d, 3);
        else
          divide(a, d, c, 3);
      }
  return b;
}

std::string plyOf(const Ball& b, bool binary) {
  std::ostringstream out;
  out << "ply\nformat " << (binary ? "binary_little_endian" : "ascii") << " 1.0\nelement vertex " << b.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << b.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  out.precision(9);
  for (const Eigen::Vector3d& v : b.vertices) {
    if (binary)
      out.write(reinterpret_cast<const char*>(v.data()), sizeof(double) * 3);
    else
      out << v.x() << " " << v.y() << " " << v.z() << "\n";
  }
  for (const Eigen::Vector3i& t : b.triangles) {
    if (binary) {
      out.put(3);
      out.write(reinterpret_cast<const char*>(t.data()), sizeof(int) * 3);
    } else {
      out << "3 " << t.x() << " " << t.y() << " " << t.z() << "\n";
    }
  }
  return out.str();
}

std::string objOf(const Ball& b) {
  std::ostringstream out;
  out.precision(9);
  for (const Eigen::Vector3d& v : b.vertices) out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  for (const Eigen::Vector3d& v : b.vertices) out << "vn " << v.x() << " " << v.y() << " " << v.z() << "\n";
  for (const Eigen::Vector3i& t : b.triangles)
    out << "f " << t.x() + 1 << "//" << t.x() + 1 << " " << t.y() + 1 << "//" << t.y() + 1 << " " << t.z() + 1 << "//"
        << t.z() + 1 << "\n";
  return out.str();
}

std::string stlOf(const Ball& b) {
  std::ostringstream out;
  out.precision(9);
  out << "solid ball\n";
  for (const Eigen::Vector3i& t : b.triangles) {
    out << " facet normal 0 0 0\n  outer loop\n";
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d& v = b.vertices[static_cast<std::size_t>(t[i])];
      out << "   vertex " << v.x() << " " << v.y() << " " << v.z() << "\n";
    }
    out << "  endloop\n endfacet\n";
  }
  return out.str() + "endsolid ball\n";
}

/// @param larger  times as many pixels along a side: highlights of photographs must be large enough to be found
Json specOf(const Json& surface, const Json& render, double larger = 1) {
  return {{"glint_scene", 1},
          {"name", "small"},
          {"camera",
           {{"width", int(48 * larger)},
            {"height", int(36 * larger)},
            {"fx", 60 * larger},
            {"fy", 60 * larger},
            {"cx", 24 * larger - 0.5},
            {"cy", 18 * larger - 0.5},
            {"distortion", {0.02, 0, 0, 0, 0}}}},
          {"surfaces", {{"body", surface}}},
          {"lights", {{{"id", "lamp"}, {"position", {1.5, -1.0, 2.2}}}}},
          {"path",
           {{"orbit", {{"centre", {0, 0, 0}}, {"radius", 1.9}, {"height", 0.9}, {"from", -1.9}, {"to", -0.9}, {"count", 5}}}}},
          {"render", render}};
}

class Maker {
 public:
  Maker(const fs::path& program, const fs::path& folder) : program_(program), folder_(folder) {}

  void run(const std::string& arguments) const {
    const std::string line = "cd '" + folder_.string() + "' && '" + program_.string() + "' " + arguments + " > /dev/null";
    if (std::system(line.c_str()) != 0) throw std::runtime_error("does not work: " + line);
  }
  /// A scene of the specification; its radiance and photographs are detected in, where `detected`.
  void scene(const std::string& name, const Json& spec, bool detected) const {
    write(folder_ / (name + "-spec.json"), spec.dump());
    run("synth " + name + "-spec.json -o " + name);
    if (!detected) return;
    Json scene = Json::parse(contentOf(folder_ / name / "scene.json"));
    for (Json& frame : scene["frames"]) frame.erase("highlights");
    write(folder_ / name / "scene.json", scene.dump());
  }

 private:
  fs::path program_, folder_;
};

}  // namespace

std::vector<Victim> makeMaterials(const fs::path& program, const fs::path& folder) {
  const Maker make(program, folder);
  const Json ellipsoid = {{"analytic", {{"type", "ellipsoid"}, {"semi_axes", {0.6, 0.35, 0.3}}}}};
  const Json png = {{"reflectance", "ggx"}, {"roughness", 0.25}, {"diffuse", 0.05}, {"bits", 8}};
  const Json jpeg = {{"reflectance", "ggx"}, {"roughness", 0.25}, {"diffuse", 0.05}, {"bits", 8}, {"jpeg_quality", 90}};
  const Ball b = ball(0.4);
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"text.ply", plyOf(b, false)},
                                   {"binary.ply", plyOf(b, true)},
                                   {"ball.obj", objOf(b)},
                                   {"ball.stl", stlOf(b)}})
    write(folder / name, text);

  make.scene("given", specOf(ellipsoid, png), false);
  make.scene("detected", specOf(ellipsoid, png, 1.75), true);
  make.scene("jpeg", specOf(ellipsoid, jpeg, 1.75), true);
  for (const std::string mesh : {"text.ply", "binary.ply", "ball.obj", "ball.stl"}) {
    const std::string name = mesh.substr(0, mesh.find('.')) + "-" + mesh.substr(mesh.find('.') + 1);
    make.scene(name, specOf({{"mesh", mesh}}, png, mesh == "text.ply" ? 1.75 : 1), false);
  }
  // A scene without a surface of its own: the frames' depth maps.
  fs::copy(folder / "given", folder / "depth", fs::copy_options::recursive);
  Json depth = Json::parse(contentOf(folder / "depth/scene.json"));
  for (Json& frame : depth["frames"]) frame.erase("surface");
  depth.erase("surfaces");
  write(folder / "depth/scene.json", depth.dump());

  make.run("reconstruct given --model limit-angle,dual --train 0-2 -o given/run.glint");
  const Json scene = Json::parse(contentOf(folder / "given/scene.json"));
  for (const Json& frame : scene["frames"]) {
    Json contours = Json::array();
    for (const Json& h : frame.value("highlights", Json::array()))
      contours.push_back({{"closed", true}, {"edge_fraction", 0.0}, {"points", h["contour"]}});
    write(folder / "given/truth" / (frame["id"].get<std::string>() + ".json"),
          Json{{"levels", {{"0.50", contours}}}, {"peak_subpixel", nullptr}}.dump());
  }
  write(folder / "given/run.work", R"({"glint_tradeoff_work":2,"key":"","coarse":{},"full":{}})");
  write(folder / "given/folder/a.txt", "nothing of ours");
  fs::create_directories(folder / "specs");
  Json small = specOf(ellipsoid, png);
  small["path"]["orbit"]["count"] = 2;
  write(folder / "specs/orbit.json", small.dump());
  Json steps = specOf({{"analytic", {{"type", "sheet"}, {"curvature", 0.1}}}}, png);
  steps["surface_steps"] = {{"surface", "body"}, {"parameter", "curvature"}, {"from", 0}, {"to", 0.5}, {"count", 2}};
  steps["path"]["orbit"]["count"] = 1;
  steps["lights"][0]["position"] = {0.74, 2.15, 1.1};  // mirrored in the middle of the sheet
  write(folder / "specs/steps.json", steps.dump());
  Json frames = specOf({{"mesh", "ball.obj"}}, png);
  frames.erase("path");
  frames["frames"] = Json::array();
  for (int i = 0; i < 2; ++i)
    frames["frames"].push_back({{"id", "f" + std::to_string(i)},
                                {"camera_from_world", {{1, 0, 0, 0.1 * i}, {0, 1, 0, 0}, {0, 0, 1, 1.6}, {0, 0, 0, 1}}}});
  frames["lights"][0]["position"] = {0.4, 0.3, -2.5};
  write(folder / "specs/frames.json", frames.dump());
  fs::copy(folder / "ball.obj", folder / "specs/ball.obj");

  const std::string limit = "--models limit-angle --train 0-2 ";
  const std::vector<std::string> onScene = {"info .",
                                            "info . --json out/i.json",
                                            "detect . --json out/d.json --out out/d",
                                            "lights . --json out/l.json -o out/l.lp -o out/l.csv",
                                            "evaluate . " + limit + "--json out/e.json --csv out/e.csv --html out/e.html",
                                            "evaluate . --models dual,canonical,primal --train 0-2 --json out/e.json",
                                            "reconstruct . --model limit-angle --train 0-2 -o out/s.glint",
                                            "render . " + limit + "--view frame --size 160x120 -o out/p.png",
                                            "render . " + limit + "--view plots --size 160x120 -o out/p.png",
                                            "convert . -o out/c.json"};
  const std::vector<std::string> onMesh = {"info .", "evaluate . " + limit + "--json out/e.json",
                                           "reconstruct . --model canonical --train 0-2 -o out/s.glint"};
  const std::vector<std::string> onImage = {"info .", "detect . --json out/d.json --out out/d",
                                            "lights frames --ball 42,31,31 --json out/l.json -o out/l.lp -o out/l.csv",
                                            "evaluate . " + limit + "--source image --json out/e.json --html out/e.html"};
  const std::vector<std::string> onSession = {"info run.glint",
                                              "predict run.glint --json out/p.json --out out/p --masks out/m",
                                              "retexture run.glint --frame 1 --remove -o out/q.png",
                                              "share run.glint --models dual -o out/s.html",
                                              "replay run.glint",
                                              "evaluate run.glint --json out/e.json",
                                              "compare run.glint copy.glint --json out/c.json",
                                              "convert run.glint -o out/c.json",
                                              "render run.glint --view ladder --size 160x120 -o out/p.png",
                                              "tradeoff run.glint --max-trials 1 --repeats 1 --json out/t.json"};
  fs::copy(folder / "given/run.glint", folder / "given/copy.glint");

  std::vector<Victim> victims;
  const auto add = [&](Victim v) { victims.push_back(std::move(v)); };
  add({"scene", "given", "scene.json", Form::Json, onScene, "", 10});
  add({"scene", "detected", "scene.json", Form::Json, onScene, "", 5});
  add({"scene", "depth", "scene.json", Form::Json, onScene, "", 4});
  add({"scene", "text-ply", "scene.json", Form::Json, onScene, "", 3});
  add({"session", "given", "run.glint", Form::Json, onSession, "", 14});
  for (const std::string spec : {"orbit.json", "steps.json", "frames.json"})
    add({"synth", "specs", spec, Form::Json, {"synth " + spec + " -o out/s"}, "", 4});
  add({"truth",
       "given",
       "truth/0003.json",
       Form::Json,
       {"evaluate . " + limit + "--truth truth --json out/e.json",
        "evaluate . --models canonical --train 0-2 --truth truth --csv out/e.csv"},
       "",
       4});
  add({"work file",
       "given",
       "run.work",
       Form::Json,
       {"tradeoff . --models limit-angle --train 0-2 --max-trials 1 --repeats 1 --work run.work --json out/t.json"},
       "",
       1});
  add({"PLY", "text-ply", "mesh/text.ply", Form::Text, onMesh, "", 4});
  add({"PLY", "binary-ply", "mesh/binary.ply", Form::Text, onMesh, "", 3});
  add({"OBJ", "ball-obj", "mesh/ball.obj", Form::Text, onMesh, "", 3});
  add({"STL", "ball-stl", "mesh/ball.stl", Form::Text, onMesh, "", 3});
  add({"PNG", "detected", "frames/0001.png", Form::Bytes, onImage, "", 3});
  add({"JPEG", "jpeg", "frames/0001.jpg", Form::Bytes, onImage, "", 3});
  add({"TIFF radiance",
       "detected",
       "radiance/0001.tiff",
       Form::Bytes,
       {"info .", "detect . --json out/d.json --out out/d", "evaluate . " + limit + "--json out/e.json"},
       "",
       3});
  add({"depth", "depth", "depth/0001.tiff", Form::Bytes, onMesh, "", 3});
  add({"normals", "depth", "normals/0001.tiff", Form::Bytes, onMesh, "", 2});
  add({"mask", "detected", "mask/0001.png", Form::Bytes, onImage, "", 2});
  add({"--set",
       "given",
       "",
       Form::Text,
       {"evaluate . --models limit-angle,canonical --train 0-2 --set {}", "detect . --set {}"},
       "predict.directions=36",
       1});
  add({"--set",
       "given",
       "",
       Form::Text,
       {"evaluate . --models limit-angle,canonical --train 0-2 --set {}", "detect . --set {}"},
       "detect.level=0.5",
       1});
  add({"--train",
       "given",
       "",
       Form::Text,
       {"evaluate . --models limit-angle --train {}", "reconstruct . --model limit-angle --train {} -o out/s.glint",
        "predict run.glint --frames {} --json out/p.json"},
       "0-2,4",
       1});
  add({"--train", "given", "", Form::Text, {"evaluate . --models limit-angle --train {}"}, "spread:3", 1});
  add({"places",
       "given",
       "",
       Form::Text,
       {"info {}", "evaluate {} --models limit-angle", "convert . -o {}", "predict run.glint --out {}",
        "evaluate . --models limit-angle --json {}", "synth scene.json -o {}", "info . --photographs {}", "info . --meshes {}",
        "evaluate . --models limit-angle --truth {}", "info . --limit {}"},
       "folder/../scene.json",
       2});
  std::erase_if(victims, [&](const Victim& v) {
    if (v.file.empty() || fs::exists(folder / v.input / v.file)) return false;
    throw std::runtime_error("no material " + v.input + "/" + v.file);
  });
  return victims;
}

}  // namespace glint::fuzz
