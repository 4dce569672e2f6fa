// SPDX-License-Identifier: BSD-3-Clause
// The 3D view on a mesh of a million triangles with 100 cameras: one frame in full, one while something moves, and one step
// through the frames.
#include <benchmark/benchmark.h>
#include <stdlib.h>
#include <vtkNew.h>
#include <vtkPLYWriter.h>
#include <vtkSphereSource.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <thread>

#include "viz/offscreen.h"
#include "viz/scene_view.h"

namespace {

using namespace glint;

constexpr int kSide = 708;  // 2 * 708 * 706 triangles

/// A globe as a binary PLY file.
void writeMesh(const std::filesystem::path& file) {
  vtkNew<vtkSphereSource> globe;
  globe->SetRadius(1);
  globe->SetThetaResolution(kSide);
  globe->SetPhiResolution(kSide);
  vtkNew<vtkPLYWriter> writer;
  writer->SetInputConnection(globe->GetOutputPort());
  writer->SetFileName(file.c_str());
  if (!writer->Write()) throw std::runtime_error("cannot write " + file.string());
}

struct Setup {
  Setup() {
    std::string pattern = (std::filesystem::temp_directory_path() / "glint-bench-XXXXXX").string();
    folder = mkdtemp(pattern.data());
    writeMesh(folder / "globe.ply");
    auto scene = std::make_shared<Scene>();
    scene->name = "globe";
    scene->folder = folder;
    scene->surfaces["globe"] = MeshFile{{folder / "globe.ply"}};
    for (int i = 0; i < 100; ++i) {
      const double t = 2 * std::numbers::pi * i / 100;
      const Eigen::Vector3d eye(3 * std::cos(t), 3 * std::sin(t), 2), forward = -eye.normalized();
      const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
      Frame frame;
      frame.id = std::to_string(i);
      frame.surface = "globe";
      frame.camera.width = 640;
      frame.camera.height = 480;
      frame.camera.pixelFromRay << 800, 0, 319.5, 0, 800, 239.5, 0, 0, 1;
      Eigen::Matrix3d axes;
      axes << right.transpose(), forward.cross(right).transpose(), forward.transpose();
      frame.camera.camFromWorld.linear() = axes;
      frame.camera.camFromWorld.translation() = -axes * eye;
      scene->frames.push_back(frame);
    }
    auto result = std::make_shared<Inspection>();
    result->scene = result->given = scene;
    result->surfaces = std::make_shared<SurfaceCache>(*scene);
    view.setInspection(result);
    view.setLayerVisible("photographs", false);
    Outcome<std::unique_ptr<viz::Offscreen>> made = viz::Offscreen::create(1000, 700);
    if (!made) throw std::runtime_error(made.failure().message());
    target = std::move(*made);
    target->render(view);
    while (!view.hasCoarseSurface()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ~Setup() { std::filesystem::remove_all(folder); }
  std::filesystem::path folder;
  viz::SceneView view;
  std::unique_ptr<viz::Offscreen> target;
};

Setup& setup() {
  static Setup instance;
  return instance;
}

void turn(benchmark::State& state, bool moving) {
  Setup& s = setup();
  s.view.setMoving(moving);
  viz::ViewPoint view{{6, 0, 3}, {0, 0, 0}, {0, 0, 1}, 30};
  double angle = 0;
  for (auto _ : state) {
    angle += 0.02;
    view.position = {6 * std::cos(angle), 6 * std::sin(angle), 3};
    s.view.setViewPoint(view);
    benchmark::DoNotOptimize(s.target->render(s.view));
  }
}

void BM_TurnInFull(benchmark::State& state) { turn(state, false); }
void BM_TurnWhileMoving(benchmark::State& state) { turn(state, true); }
void BM_StepThroughTheFrames(benchmark::State& state) {
  Setup& s = setup();
  s.view.setMoving(true);
  int frame = 0;
  for (auto _ : state) {
    frame = (frame + 1) % 100;
    s.view.setSelection({frame, "", -1, "", {}});
    benchmark::DoNotOptimize(s.target->render(s.view));
  }
}

BENCHMARK(BM_TurnInFull)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_TurnWhileMoving)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_StepThroughTheFrames)->Unit(benchmark::kMillisecond);

}  // namespace
