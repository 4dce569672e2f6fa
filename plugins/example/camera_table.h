// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "core/scene/capture.h"

namespace glint::example {

/// cameras.csv: "image,width,height,fx,fy,cx,cy,qw,qx,qy,qz,tx,ty,tz" an image, world to camera, (0, 0) the first pixel's centre.
class CameraTable final : public CaptureReader {
 public:
  std::string name() const override { return "camera-table"; }
  std::string describe() const override { return "table of cameras (cameras.csv)"; }
  std::filesystem::path recognise(const std::filesystem::path& input) const override {
    std::error_code ignored;
    const std::filesystem::path file = std::filesystem::is_directory(input, ignored) ? input / kFile : input;
    std::string header;
    std::ifstream in(file);
    if (file.filename() == kFile) std::getline(in, header);
    return header.rfind("image,width,height,", 0) == 0 ? file : std::filesystem::path();
  }
  Capture read(const std::filesystem::path& file, const CaptureOptions&) const override {
    Capture capture;
    capture.kind = name();
    capture.file = file;
    capture.folder = file.parent_path();
    capture.sources = {file};
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    for (int number = 2; std::getline(in, line); ++number)
      if (!line.empty()) capture.views.push_back(viewOf(line, file, "line " + std::to_string(number)));
    if (capture.views.empty()) throw InputError(file.string(), "", "has no camera");
    return capture;
  }

 private:
  static constexpr const char* kFile = "cameras.csv";

  static CaptureView viewOf(const std::string& line, const std::filesystem::path& file, const std::string& place) {
    std::istringstream row(line);
    CaptureView view;
    std::getline(row, view.name, ',');
    if (view.name.empty() || view.name.find("..") != std::string::npos)
      throw InputError(file.string(), place, "the image's name is empty or has '..'");
    view.image = file.parent_path() / view.name;
    std::vector<double> v;
    for (std::string text; std::getline(row, text, ',');) {
      double x = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
      if (error != std::errc() || end != text.data() + text.size() || !(std::abs(x) < 1e6))
        throw InputError(file.string(), place, "'" + text + "' is no number below 1e6");
      v.push_back(x);
    }
    if (v.size() != 13)
      throw InputError(file.string(), place, "needs 13 numbers behind the name, has " + std::to_string(v.size()));
    const Eigen::Quaterniond q(v[6], v[7], v[8], v[9]);
    if (!(v[0] >= 1 && v[0] <= 65535 && v[1] >= 1 && v[1] <= 65535 && v[2] > 0 && v[3] > 0) || std::abs(q.norm() - 1) > 1e-6)
      throw InputError(file.string(), place, "the size, the focal lengths or the quaternion is wrong");
    Camera& camera = view.camera;
    camera.width = int(v[0]);
    camera.height = int(v[1]);
    camera.pixelFromRay << v[2], 0, v[4], 0, v[3], v[5], 0, 0, 1;
    camera.camFromWorld = Eigen::Translation3d(v[10], v[11], v[12]) * q.normalized();
    return view;
  }
};

}  // namespace glint::example
