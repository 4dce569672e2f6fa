// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/progress.h"
#include "core/base/safe_text.h"
#include "core/base/words.h"
#include "core/codecs/codecs.h"
#include "core/scene/scene_json.h"
#include "core/synth/synth.h"

namespace glint {
namespace fs = std::filesystem;
namespace {

cv::Mat matOf(const Image& image) {
  cv::Mat mat(image.height, image.width, CV_32FC(image.channels), const_cast<float*>(image.data.data()));
  cv::Mat copy = mat.clone();
  if (image.channels == 3) cv::cvtColor(copy, copy, cv::COLOR_RGB2BGR);
  return copy;
}

void writeImage(const fs::path& file, const cv::Mat& mat, int jpegQuality = 0) {
  // Encoded in memory first: the libraries' own writing prints messages, and may crash, when the disk is full.
  std::vector<unsigned char> bytes;
  std::vector<int> parameters;
  if (file.extension() == ".tiff")
    parameters = {cv::IMWRITE_TIFF_COMPRESSION, 1};  // uncompressed: the default for floats is lossy
  if (jpegQuality > 0) parameters = {cv::IMWRITE_JPEG_QUALITY, jpegQuality};
  bool encoded = false;
  try {
    encoded = encodeWithOpenCv(file.extension().string(), mat, bytes, parameters);
  } catch (const cv::Exception&) {
  }
  if (!encoded) throw InputError(file.string(), "", "cannot be written: the image cannot be encoded");
  atomicWrite(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

/// Blur, then noise (its own stream per frame and per image), never below 0.
void degrade(Image& image, const RenderOptions& options, double sigma, unsigned stream) {
  cv::Mat mat(image.height, image.width, CV_32FC(image.channels), image.data.data());
  if (options.blurPx > 0) cv::GaussianBlur(mat, mat, cv::Size(0, 0), options.blurPx, options.blurPx, cv::BORDER_REPLICATE);
  if (sigma > 0) {
    std::seed_seq seeds{options.seed, stream};
    std::mt19937 random(seeds);
    std::normal_distribution<double> normal(0, sigma);
    for (float& v : image.data) v = std::max(0.f, v + static_cast<float>(normal(random)));
  }
}

cv::Mat quantised(const Image& linear, const CameraResponse& response, int bits) {
  const double top = bits == 8 ? 255 : 65535;
  cv::Mat mat = matOf(linear), out;
  for (int y = 0; y < mat.rows; ++y)
    for (int x = 0; x < mat.cols; ++x)
      for (int c = 0; c < 3; ++c)
        mat.at<cv::Vec3f>(y, x)[c] = static_cast<float>(response.codeOf(double(mat.at<cv::Vec3f>(y, x)[c]), c));
  mat.convertTo(out, bits == 8 ? CV_8UC3 : CV_16UC3, top);  // rounds to nearest
  return out;
}

std::vector<TrueLight> lightsOf(const Scene& scene, const Frame& frame) {
  std::vector<TrueLight> lights;
  for (const TrueLight& light : scene.lights)
    if (std::find(frame.lightsOn.begin(), frame.lightsOn.end(), light.id) != frame.lightsOn.end())
      lights.push_back(inWorld(light, frame));
  return lights;
}

/// Brightest value that a frame is expected to show: specular peak plus the diffuse part there.
double brightest(const Surface& surface, const Frame& frame, const std::vector<TrueLight>& lights, const Material& material) {
  double top = 0;
  for (const Highlight& h : frame.highlights) {
    const Ray ray = frame.camera.ray(h.peak);
    const Outcome<SurfacePoint> hit = surface.firstHit(ray);
    if (!hit) continue;
    double sum = 0;
    for (const TrueLight& light : lights) {
      const Shading s = shade(surface, *hit, ray.origin, light, material);
      sum += s.specular + material.diffuse.maxCoeff() * s.diffuse;
    }
    top = std::max(top, sum);
  }
  return top;
}

}  // namespace

RenderedFrame renderFrame(const Surface& surface, const Camera& camera, const std::vector<TrueLight>& lights,
                          const Material& material, int samples) {
  require(samples >= 1, "renderFrame: at least one sample");
  const int w = camera.width, h = camera.height;
  RenderedFrame frame{Image(w, h, 1), Image(w, h, 3), Image(w, h, 1), Image(w, h, 3), Image(w, h, 1)};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      double specular = 0, diffuse = 0;
      for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
          const Pixel measured(x + (i + 0.5) / samples - 0.5, y + (j + 0.5) / samples - 0.5);
          const Ray ray = camera.ray(camera.undistorted(measured));
          const Outcome<SurfacePoint> hit = surface.firstHit(ray);
          if (!hit) continue;
          for (const TrueLight& light : lights) {
            const Shading s = shade(surface, *hit, ray.origin, light, material);
            specular += s.specular;
            diffuse += s.diffuse;
          }
        }
      const double share = 1.0 / (samples * samples);
      frame.specular.at(x, y) = static_cast<float>(specular * share);
      for (int c = 0; c < 3; ++c) frame.diffuse.at(x, y, c) = static_cast<float>(material.diffuse[c] * diffuse * share);
      // Depth, normal and mask belong to the pixel's centre: a mean over an edge is not on the surface.
      const Ray ray = camera.ray(camera.undistorted(Pixel(x, y)));
      const Outcome<SurfacePoint> hit = surface.firstHit(ray);
      if (!hit) continue;
      const SurfacePoint p = facing(*hit, ray.origin);
      frame.mask.at(x, y) = 1;
      frame.depth.at(x, y) = static_cast<float>(camera.depth(p.position));
      for (int c = 0; c < 3; ++c) frame.normals.at(x, y, c) = static_cast<float>(p.normal[c]);
    }
  return frame;
}

RenderedRadiance renderRadiance(const Surface& surface, const Camera& camera, const std::vector<TrueLight>& lights,
                                const Material& material, int every, const ProgressFn& progress) {
  require(every >= 1, "renderRadiance: every n-th pixel, n >= 1");
  const int w = camera.width, h = camera.height;
  RenderedRadiance result{Image(w, h, 1), Image(w, h, 1)};
  parallelFor((h + every - 1) / every,
              [&](int row) {
                const int top = row * every, bottom = std::min(h, top + every);
                for (int left = 0; left < w; left += every) {
                  const int right = std::min(w, left + every);
                  const Pixel ideal = camera.undistorted(Pixel((left + right - 1) / 2, (top + bottom - 1) / 2));
                  if (!ideal.allFinite()) continue;  // beyond the lens model
                  const Ray ray = camera.ray(ideal);
                  const Outcome<SurfacePoint> hit = surface.firstHit(ray);
                  if (!hit) continue;
                  double specular = 0, diffuse = 0;
                  for (const TrueLight& light : lights) {
                    const Shading s = shade(surface, *hit, ray.origin, light, material);
                    specular += s.specular;
                    diffuse += s.diffuse;
                  }
                  for (int y = top; y < bottom; ++y)
                    for (int x = left; x < right; ++x) {
                      result.specular.at(x, y) = static_cast<float>(specular);
                      result.diffuse.at(x, y) = static_cast<float>(diffuse);
                    }
                }
              },
              progress, "render");
  return result;
}

namespace {

void makeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "", "cannot be created: " + error.message());
}

std::string photographExtension(const RenderOptions& render) { return render.jpegQuality > 0 ? ".jpg" : ".png"; }

/// The names in the folder `mesh` under which meshes go into the scene's folder, by the mesh. Two of one name are numbered, and
/// none takes the place of another mesh of the scene.
std::map<fs::path, std::string> namesOfMeshes(const Scene& scene) {
  std::map<fs::path, std::string> names;
  std::vector<fs::path> files;
  for (const auto& [id, source] : scene.surfaces)
    if (source.file() && names.emplace(source.file()->file, "").second) files.push_back(source.file()->file);
  std::set<std::string> taken;
  const auto isFree = [&](const std::string& name, const fs::path& mine) {
    std::error_code ignored;  // a file that does not exist yet is no mesh
    return !taken.count(name) && std::none_of(names.begin(), names.end(), [&](const auto& mesh) {
      return mesh.first != mine && fs::equivalent(mesh.first, scene.folder / "mesh" / name, ignored);
    });
  };
  for (const fs::path& file : files) {
    std::string name = copyNameOf(file);
    for (int n = 2; !isFree(name, file); ++n) name = copyNameOf(file, n);
    taken.insert(name);
    names[file] = name;
  }
  return names;
}

/// Whether the mesh lies there already, so that it is not written.
bool isInPlace(const fs::path& mesh, const fs::path& place) {
  std::error_code ignored;  // a path that cannot be looked at counts as another file
  return fs::equivalent(mesh, place, ignored);
}

/// Files of the frames and the meshes; relative to the scene's folder.
std::vector<fs::path> filesWritten(const Scene& scene, const std::map<fs::path, std::string>& meshes,
                                   const std::optional<RenderOptions>& render) {
  std::vector<fs::path> files;
  for (const auto& [mesh, name] : meshes)
    if (!isInPlace(mesh, scene.folder / "mesh" / name)) files.push_back(fs::path("mesh") / name);
  if (!render) return files;
  for (const Frame& frame : scene.frames) {
    const std::string name = fileNameOf(frame.id);
    if (render->bits != 32) files.push_back(fs::path("frames") / (name + photographExtension(*render)));
    for (const char* kind : {"radiance", "depth", "normals"}) files.push_back(fs::path(kind) / (name + ".tiff"));
    files.push_back(fs::path("mask") / (name + ".png"));
  }
  return files;
}

/// Meshes go into the scene's folder, so that it stands on its own. They are written into `out`, which will be that folder.
void copyMeshes(Scene& scene, const std::map<fs::path, std::string>& meshes, const fs::path& out) {
  for (const auto& [mesh, name] : meshes) {
    if (isInPlace(mesh, scene.folder / "mesh" / name)) continue;
    makeFolder(out / "mesh");
    atomicWrite(out / "mesh" / name, readFile(mesh));
  }
  for (auto& [id, source] : scene.surfaces)
    if (SurfaceFile* const read = source.file()) read->file = scene.folder / "mesh" / meshes.at(read->file);
}

/// Photographs, radiance, depth, normals and masks of all frames, written into `out`, which will be the scene's folder.
/// @param top  the brightest value of the sequence
void renderFrames(Scene& scene, const RenderOptions& render, const Material& material, const SurfaceCache& surfaces, double top,
                  const fs::path& out, const ProgressFn& progress) {
  const double exposure = render.exposure > 0 ? render.exposure : (top > 0 ? 0.9 / top : 1);
  for (const char* name : {"frames", "radiance", "depth", "normals", "mask"}) {
    if (render.bits == 32 && std::string(name) == "frames") continue;
    makeFolder(out / name);
  }
  parallelFor(
      static_cast<int>(scene.frames.size()),
      [&](int i) {
        Frame& frame = scene.frames[static_cast<std::size_t>(i)];
        const Outcome<std::shared_ptr<const Surface>> surface = surfaces.surfaceOf(i, NormalPolicy::Curved);
        RenderedFrame r = renderFrame(**surface, frame.camera, lightsOf(scene, frame), material, render.samples);
        const auto write = [&](fs::path& named, const char* kind, const std::string& extension, const cv::Mat& mat,
                               int jpegQuality) {
          const fs::path file = fs::path(kind) / (fileNameOf(frame.id) + extension);
          named = scene.folder / file;
          writeImage(out / file, mat, jpegQuality);
        };
        if (render.bits != 32) {
          Image photograph(frame.camera.width, frame.camera.height, 3);
          for (std::size_t k = 0; k < photograph.data.size(); ++k)
            photograph.data[k] = static_cast<float>(exposure) * (r.diffuse.data[k] + r.specular.data[k / 3]);
          degrade(photograph, render, render.noise * exposure * top, static_cast<unsigned>(2 * i));
          write(frame.image, "frames", photographExtension(render), quantised(photograph, frame.response, render.bits),
                render.jpegQuality);
        }
        degrade(r.specular, render, render.noise * top, static_cast<unsigned>(2 * i + 1));
        cv::Mat mask;
        matOf(r.mask).convertTo(mask, CV_8U, 255);
        write(frame.radiance, "radiance", ".tiff", matOf(r.specular), 0);
        write(frame.depth, "depth", ".tiff", matOf(r.depth), 0);
        write(frame.normals, "normals", ".tiff", matOf(r.normals), 0);
        write(frame.mask, "mask", ".png", mask, 0);
      },
      progress, "render");
}

/// The text of the scene's file, with the sign that `synth` wrote it.
std::string textOf(Scene scene) {
  scene.unknownJson = std::string("{\"scene\": {\"") + kMadeBy + "\": \"" + kMadeBySynth + "\"}}";
  return sceneToJson(scene, scene.folder);
}

/// What is known of a scene before anything is written.
struct Traced {
  Scene scene;     ///< with highlights, in its new folder
  double top = 0;  ///< brightest value of the frames; 0 where nothing is rendered
  std::map<fs::path, std::string> meshes;
};

/// Highlights of all frames. Everything that can be wrong with the specification is found here.
Traced traced(const SynthSpec& spec, const SurfaceCache& surfaces, const fs::path& folder, const ProgressFn& progress) {
  Traced result{spec.scene, 0, {}};
  Scene& scene = result.scene;
  std::vector<double> tops(scene.frames.size(), 0);
  std::mutex warningMutex;
  parallelFor(
      static_cast<int>(scene.frames.size()),
      [&](int i) {
        Frame& frame = scene.frames[static_cast<std::size_t>(i)];
        const Outcome<std::shared_ptr<const Surface>> surface = surfaces.surfaceOf(i, NormalPolicy::Curved);
        if (!surface) throw InputError(scene.file.string(), "frames[" + std::to_string(i) + "]", surface.failure().message());
        const std::vector<TrueLight> lights = lightsOf(scene, frame);
        for (const TrueLight& light : lights) {
          const Outcome<std::vector<Highlight>> found =
              exactHighlights(**surface, frame.camera, light, spec.material, spec.exact);
          if (found) {
            frame.highlights.insert(frame.highlights.end(), found->begin(), found->end());
          } else {
            const std::lock_guard<std::mutex> lock(warningMutex);
            scene.warnings.push_back("frame " + frame.id + ", " + lightName(light.id) + ": " + found.failure().message());
          }
        }
        if (spec.render) tops[static_cast<std::size_t>(i)] = brightest(**surface, frame, lights, spec.material);
      },
      progress, "highlights");
  std::sort(scene.warnings.begin(), scene.warnings.end());
  if (!tops.empty()) result.top = *std::max_element(tops.begin(), tops.end());
  scene.folder = fs::absolute(folder).lexically_normal();
  scene.file = scene.folder / "scene.json";
  if (std::error_code ignored; fs::equivalent(spec.scene.file, scene.file, ignored))
    throw InputError(scene.file.string(), "", "would overwrite the specification; choose another folder");
  result.meshes = namesOfMeshes(scene);
  return result;
}

}  // namespace

Scene synthesise(const SynthSpec& spec, const fs::path& folder, const ProgressFn& progress) {
  const SurfaceCache surfaces(spec.scene);
  Traced t = traced(spec, surfaces, folder, progress);
  std::vector<fs::path> files = filesWritten(t.scene, t.meshes, spec.render);
  files.insert(files.begin(), t.scene.file.filename());
  requireSynthFolder(t.scene.folder, files);
  atomicFiles(folder, "scene.json", [&](const fs::path& out) {
    copyMeshes(t.scene, t.meshes, out);
    if (spec.render) renderFrames(t.scene, *spec.render, spec.material, surfaces, t.top, out, progress);
    atomicWrite(out / t.scene.file.filename(), textOf(t.scene));
  });
  return t.scene;
}

}  // namespace glint
