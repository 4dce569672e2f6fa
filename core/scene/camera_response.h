// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/json_text.h"
#include "core/base/permitted.h"

namespace glint {

/// How the codes of a camera's 8- and 16-bit images become linear light (`camera.response`, docs/formats.md). Codes and light run
/// from 0 to 1; 1 is the largest code, so that clipped values lie at 1 whatever the response. Radiance images and float images
/// are linear by themselves.
class CameraResponse {
 public:
  enum class Kind {
    ByFileType,  ///< not stated: 16 bits that say so are linear, other codes are sRGB
    Srgb,        ///< IEC 61966-2-1
    Linear,      ///< light = code
    Gamma,       ///< light = code^gamma
    SCurve,  ///< more contrast than sRGB, as developers of photographs add: code = c - S sin(2 pi c) / (2 pi), c the sRGB code
    Table    ///< measured: a file
  };
  static constexpr double kLeastGamma = 0.1, kMostGamma = 10;  ///< beyond, an 8-bit image has no more than a few shades
  static constexpr double kMostVignetting = 0.9;               ///< beyond, the corners show nothing
  static constexpr double kMostContrast = 0.95;  ///< of S, either sign: at 1 the codes of the darkest light would stand still

  /// The response where nothing is stated.
  CameraResponse() = default;
  /// "srgb", "linear", "gamma:G", "s-curve:S", each alone or followed by ", vignetting:K"; or "vignetting:K". Nothing for another
  /// text, which then names a file. InputError (file, place) for a G, S or K that is not a number of the range above.
  static std::optional<CameraResponse> named(const std::string& text, const std::string& file, const std::string& place);
  /// A measured response. One line per code, in rising order: `light` (codes equally spaced from 0), `code light`, `red green
  /// blue`, or `code red green blue`; or one line of all lights. Separated by blanks, commas or semicolons; '#' begins a comment;
  /// the first line may name the columns. Codes run from 0 to the largest one (1, 255, 1023, 4095, 16383 or 65535). Light is in
  /// any unit, at least 0, and never falls; each colour is divided by its light at the largest code, which changes the white
  /// balance and no highlight. InputError (file, line) for any other text.
  static CameraResponse ofFile(const std::filesystem::path& file);
  /// The same from the file's text.
  static CameraResponse ofText(const std::string& text, const std::filesystem::path& file);

  Kind kind() const { return kind_; }
  bool isStated() const { return kind_ != Kind::ByFileType; }
  /// K: the share of the light that is lost in the corners of the image; it grows with the square of the distance from the
  /// middle. 0 = none.
  double vignetting() const { return vignetting_; }
  /// The same response for images whose corners got less light.
  CameraResponse withVignetting(double share) const;
  /// What a pixel received, up to a factor that all pixels share, from what it shows: light (1 - K) / (1 - K r^2), r the distance
  /// from the middle over that of a corner. Light of the largest code stays 1, as clipped as it was.
  double withoutVignetting(double light, double x, double y, int width, int height) const;
  /// G of Kind::Gamma, S of Kind::SCurve.
  double number() const { return number_; }
  /// The file of Kind::Table, absolute; else empty.
  const std::filesystem::path& file() const { return file_; }
  /// Light of a code of this colour channel (0 to 2). `isLinear`: what a response that is not stated becomes.
  double lightOf(double code, int channel, bool isLinear = false) const;
  /// Code of a light; both are clamped to [0, 1]. The inverse of `lightOf`; the smallest code where several have this light.
  double codeOf(double light, int channel, bool isLinear = false) const;
  /// "srgb", "linear", "gamma:2.2", "s-curve:0.5, vignetting:0.3", or the path of a table's file as it stands in `file`; ""
  /// where nothing is stated.
  std::string text() const;
  /// For people: "the sRGB curve", "code to the power of 2.2", "the curve in response.csv".
  std::string words(bool isLinear = false) const;
  /// What is strange about the response, one sentence; "" = nothing. Cameras spend more than their share of codes on dark light:
  /// a response that gives more than half of the light at half of the codes is the wrong way round.
  std::string doubt() const;

  friend bool operator==(const CameraResponse& a, const CameraResponse& b) {
    return a.kind_ == b.kind_ && a.number_ == b.number_ && a.file_ == b.file_ && a.vignetting_ == b.vignetting_;
  }

 private:
  struct Table {
    std::vector<double> codes;                  ///< rising from 0 to 1
    std::array<std::vector<double>, 3> lights;  ///< of red, green, blue; as many as codes, never falling, to 1
  };
  static Table readTable(const std::string& text, const std::string& file);

  Kind kind_ = Kind::ByFileType;
  double number_ = 1;  ///< G or S
  double vignetting_ = 0;
  std::filesystem::path file_;
  std::shared_ptr<const Table> table_;
};

/// `response` of a camera; one that is not stated where the key is missing. A file's path is relative to `folder` and subject to
/// `rights`. InputError.
CameraResponse readResponseJson(const JsonNode& camera, const std::filesystem::path& folder, const PathRights& rights);

}  // namespace glint
