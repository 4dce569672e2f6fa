// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/base/atomic_file.h"
#include "core/scene/scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::test {

/// Albedo of linear R, G, B at a place in the world, m.
using Paint = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

inline Paint plain(const Eigen::Vector3d& colour) {
  return [colour](const Eigen::Vector3d&) { return colour; };
}
/// Blocks of the colours in turn along all three axes, `side` metres.
inline Paint blocks(std::vector<Eigen::Vector3d> colours, double side) {
  return [colours = std::move(colours), side](const Eigen::Vector3d& p) {
    const auto cell = [side](double v) { return static_cast<long>(std::floor(v / side + 0.37)); };
    const long n = static_cast<long>(colours.size()), k = cell(p.x()) + cell(p.y()) + cell(p.z());
    return colours[static_cast<std::size_t>(((k % n) + n) % n)];
  };
}
/// Two colours that pass into each other in waves, as wood or marble does.
inline Paint waves(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double length) {
  return [=](const Eigen::Vector3d& p) {
    const double k = 2 * M_PI / length;
    const double bent = p.x() + 0.3 * length * std::sin(0.7 * k * p.y()) + 0.2 * length * std::sin(1.3 * k * p.z());
    const double t = 0.5 + 0.5 * std::sin(k * bent);
    return Eigen::Vector3d(t * a + (1 - t) * b);
  };
}

/// A path-traced sequence (data/cycles) as photographs of the same object under other paint. The sequences' diffuse part is
/// Lambert's: what it shows is the irradiance times one known colour. So the irradiance is the photograph less the given specular
/// radiance, divided by that colour; it is multiplied by the new paint, averaged over each pixel, and the specular part is added
/// under a yellowish lamp. Then 8-bit sRGB. The contours of the specular radiance stay the truth.
struct ColouredCycles {
  testing_support::TemporaryFolder folder;
  std::shared_ptr<Scene> scene;
  std::string truth;  ///< folder of contours

  /// @param every  of how many frames one is taken. @param diffuse  brightest diffuse light of an albedo of 1, of the clip value.
  ///               @param noise  of a pixel's channel, of the clip value
  ColouredCycles(const std::filesystem::path& sequence, const Paint& paint, double diffuse, double noise = 0, int every = 1) {
    truth = (sequence / "contours").string();
    auto read = std::make_shared<Scene>(readScene(sequence / "scene.json"));
    const nlohmann::json about = nlohmann::json::parse(readFile(sequence / "about.json", Limit::JsonMegabytes));
    const double exposure = about.at("beauty").at("exposure");
    const std::vector<double> colour = about.at("material").at("diffuse_color");
    std::vector<Frame> frames;
    std::vector<cv::Mat> shading;
    double top = 0;
    for (std::size_t f = 0; f < read->frames.size(); f += static_cast<std::size_t>(every)) {
      frames.push_back(read->frames[f]);
      shading.push_back(irradiance(frames.back(), exposure, colour));
      double brightest = 0;
      cv::minMaxLoc(shading.back(), nullptr, &brightest);
      top = std::max(top, brightest);
    }
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const std::filesystem::path file = folder / (frames[f].id + ".png");
      EXPECT_TRUE(cv::imwrite(
          file.string(), photograph(frames[f], shading[f] * (diffuse / top), exposure, paint, noise, static_cast<unsigned>(f))));
      frames[f].image = file;
      frames[f].radiance.clear();
    }
    read->frames = std::move(frames);
    scene = std::move(read);
  }

 private:
  static constexpr double kSpecularShare = 0.55;  // leaves room below the clip value for the diffuse light

  static double linearOf(double code) { return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4); }
  static double codeOf(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }
  static cv::Mat specular(const Frame& frame) { return cv::imread(frame.radiance.string(), cv::IMREAD_UNCHANGED); }

  /// Mean over the channels of (photograph - specular) / colour; 0 off the object. What is below 0 is rounding.
  static cv::Mat irradiance(const Frame& frame, double exposure, const std::vector<double>& colour) {
    const cv::Mat codes = cv::imread(frame.image.string(), cv::IMREAD_COLOR), s = specular(frame),
                  depth = cv::imread(frame.depth.string(), cv::IMREAD_UNCHANGED);
    cv::Mat e = cv::Mat::zeros(codes.size(), CV_64F);
    for (int y = 0; y < e.rows; ++y)
      for (int x = 0; x < e.cols; ++x) {
        if (!(depth.at<float>(y, x) > 0)) continue;
        for (int c = 0; c < 3; ++c)
          e.at<double>(y, x) += (linearOf(codes.at<cv::Vec3b>(y, x)[2 - c] / 255.0) - exposure * s.at<float>(y, x)) /
                                colour[static_cast<std::size_t>(c)] / 3;
        e.at<double>(y, x) = std::max(0.0, e.at<double>(y, x));
      }
    cv::Mat smooth;  // shading of smooth shapes under one lamp: the rounding of 8 bits is no part of it
    cv::blur(e, smooth, {5, 5});
    return smooth;
  }

  static cv::Mat photograph(const Frame& frame, const cv::Mat& irradiance, double exposure, const Paint& paint, double noise,
                            unsigned seed) {
    constexpr int kPerSide = 3;                   // points per pixel side
    const Eigen::Vector3d lamp(1.08, 1.0, 0.92);  // yellowish, mean 1
    const cv::Mat s = specular(frame), depth = cv::imread(frame.depth.string(), cv::IMREAD_UNCHANGED);
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> gauss(0, 1);
    cv::Mat image(irradiance.size(), CV_8UC3);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) {
        Eigen::Vector3d v = kSpecularShare * exposure * s.at<float>(y, x) * lamp;
        if (irradiance.at<double>(y, x) > 0 && depth.at<float>(y, x) > 0) {
          Eigen::Vector3d albedo(0, 0, 0);
          for (int k = 0; k < kPerSide * kPerSide; ++k) {
            const double dx = (k % kPerSide + 0.5) / kPerSide - 0.5, dy = (k / kPerSide + 0.5) / kPerSide - 0.5;
            const Ray ray = frame.camera.ray(Pixel(x + dx, y + dy));
            const double along = frame.camera.camFromWorld.linear().row(2).dot(ray.direction);
            albedo += paint(ray.origin + ray.direction * (depth.at<float>(y, x) / along)) / (kPerSide * kPerSide);
          }
          v += irradiance.at<double>(y, x) * albedo;
        }
        for (int c = 0; c < 3; ++c)
          image.at<cv::Vec3b>(y, x)[2 - c] = cv::saturate_cast<unsigned char>(
              255 * codeOf(std::clamp(v[c] + (noise > 0 ? noise * gauss(engine) : 0), 0.0, 1.0)));
      }
    return image;
  }
};

}  // namespace glint::test
