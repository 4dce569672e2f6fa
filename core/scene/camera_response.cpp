// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/camera_response.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/atomic_file.h"
#include "core/base/image.h"
#include "core/base/number_text.h"
#include "core/base/outcome.h"
#include "io/text_scan.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kLargestFile = 8u << 20;  // bytes: 65536 codes with three colours of 20 digits take 5 MB
constexpr std::size_t kMostCodes = 65536;          // of 16 bits
constexpr std::size_t kFewestInLine = 16;          // numbers in the only line of a file: below, it is no curve but a typing error
constexpr std::array<double, 6> kLargestCodes{1, 255, 1023, 4095, 16383, 65535};  // as shares, and of 8, 10, 12, 14 and 16 bits

/// The words of a line without its comment.
std::vector<std::string_view> wordsOf(std::string_view line, std::string& scratch) {
  scratch.assign(line.substr(0, line.find('#')));
  for (char& c : scratch)
    if (c == ',' || c == ';') c = ' ';
  std::vector<std::string_view> words;
  std::string_view rest = scratch;
  // One word more than a line may hold tells that there are too many.
  for (std::string_view word = io::takeWord(rest); !word.empty() && words.size() <= kMostCodes; word = io::takeWord(rest))
    words.push_back(word);
  return words;
}

struct ResponseRow {
  std::size_t line = 0;
  std::vector<double> numbers;
};

std::string lineText(std::size_t line) { return "line " + std::to_string(line); }

/// The numbers of a response file. The first line with words may be a heading.
std::vector<ResponseRow> rowsOf(const std::string& text, const std::string& file) {
  std::vector<ResponseRow> rows;
  std::string scratch;
  io::Lines lines(text);
  bool first = true;
  while (const auto line = lines.next()) {
    const std::vector<std::string_view> words = wordsOf(*line, scratch);
    if (words.empty()) continue;
    ResponseRow row{lines.number(), {}};
    for (const std::string_view word : words) {
      const std::optional<double> number = io::numberOf(word);
      if (number && std::isfinite(*number)) {
        row.numbers.push_back(*number);
        continue;
      }
      if (!first || !row.numbers.empty()) throw InputError(file, lineText(row.line), io::quoted(word) + " is not a number");
      row.numbers.clear();
      break;
    }
    first = false;
    if (row.numbers.empty()) continue;
    if (!rows.empty() && rows.front().numbers.size() != row.numbers.size())
      throw InputError(file, lineText(row.line),
                       "has " + std::to_string(row.numbers.size()) + " numbers, the lines before have " +
                           std::to_string(rows.front().numbers.size()));
    if (rows.size() == kMostCodes) throw InputError(file, lineText(row.line), "there are more than 65536 codes");
    rows.push_back(std::move(row));
  }
  return rows;
}

/// As one number a line, a file whose numbers stand in one line.
std::vector<ResponseRow> inColumn(std::vector<ResponseRow> rows, const std::string& file) {
  if (rows.size() != 1 || rows.front().numbers.size() < kFewestInLine) return rows;
  if (rows.front().numbers.size() > kMostCodes)
    throw InputError(file, lineText(rows.front().line), "there are more than 65536 codes");
  std::vector<ResponseRow> column;
  for (const double v : rows.front().numbers) column.push_back({rows.front().line, {v}});
  return column;
}

/// y of x on the polyline; x within its ends. Where xs does not rise, the first point of the stretch.
double interpolated(const std::vector<double>& xs, const std::vector<double>& ys, double x) {
  const auto above = std::lower_bound(xs.begin(), xs.end(), x);
  const std::size_t i = static_cast<std::size_t>(above - xs.begin());
  if (i == 0) return ys.front();
  if (i == xs.size()) return ys.back();
  const double t = (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
  return std::lerp(ys[i - 1], ys[i], t);
}

double withContrast(double code, double strength) {
  return code - strength * std::sin(2 * std::numbers::pi * code) / (2 * std::numbers::pi);
}

/// The code before contrast was added.
double withoutContrast(double code, double strength) {
  if (!(code > 0 && code < 1)) return code;
  double low = 0, high = 1;
  constexpr int kHalvings = 52;  // to the last bit
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (withContrast(middle, strength) < code ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

std::optional<CameraResponse> CameraResponse::named(const std::string& text, const std::string& file, const std::string& place) {
  CameraResponse response;
  const std::string prefix = "gamma:", contrast = "s-curve:", falls = "vignetting:";
  if (const std::size_t at = text.rfind(falls); at != std::string::npos && (at == 0 || text[at - 1] == ' ')) {
    const std::string curve = text.substr(0, at == 0 ? 0 : text.find_last_not_of(" ,", at - 1) + 1);
    const std::optional<double> share = io::numberOf(std::string_view(text).substr(at + falls.size()));
    if (!share || !(*share > 0 && *share <= kMostVignetting))
      throw InputError(file, place, "expected vignetting:K with a number K above 0, up to 0.9, such as vignetting:0.3");
    const std::optional<CameraResponse> whole = curve.empty() ? CameraResponse() : named(curve, file, place);
    if (!whole) throw InputError(file, place, "vignetting:K follows srgb, linear, gamma:G or s-curve:S, or stands alone");
    return whole->withVignetting(*share);
  }
  if (text == "srgb") {
    response.kind_ = Kind::Srgb;
  } else if (text == "linear") {
    response.kind_ = Kind::Linear;
  } else if (text.starts_with(prefix)) {
    const std::optional<double> gamma = io::numberOf(std::string_view(text).substr(prefix.size()));
    if (!gamma || !(*gamma >= kLeastGamma && *gamma <= kMostGamma))
      throw InputError(file, place, "expected gamma:G with a number G from 0.1 to 10, such as gamma:2.2");
    response.kind_ = Kind::Gamma;
    response.number_ = *gamma;
  } else if (text.starts_with(contrast)) {
    const std::optional<double> strength = io::numberOf(std::string_view(text).substr(contrast.size()));
    if (!strength || !(std::abs(*strength) <= kMostContrast))
      throw InputError(file, place, "expected s-curve:S with a number S from -0.95 to 0.95, such as s-curve:0.5");
    response.kind_ = Kind::SCurve;
    response.number_ = *strength;
  } else {
    return std::nullopt;
  }
  return response;
}

CameraResponse CameraResponse::withVignetting(double share) const {
  CameraResponse other = *this;
  other.vignetting_ = share;
  return other;
}

double CameraResponse::withoutVignetting(double light, double x, double y, int width, int height) const {
  if (light >= 1) return light;
  const double cx = (width - 1) / 2.0, cy = (height - 1) / 2.0, dx = x - cx, dy = y - cy;
  return light * (1 - vignetting_) / (1 - vignetting_ * (dx * dx + dy * dy) / (cx * cx + cy * cy));
}

CameraResponse CameraResponse::ofFile(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (!error && size > kLargestFile) throw InputError(file.string(), "", "is larger than 8 MB: no camera response is");
  return ofText(readFile(file), file);
}

CameraResponse CameraResponse::ofText(const std::string& text, const fs::path& file) {
  CameraResponse response;
  response.kind_ = Kind::Table;
  response.file_ = fs::absolute(file).lexically_normal();
  response.table_ = std::make_shared<const Table>(readTable(text, file.string()));
  return response;
}

CameraResponse::Table CameraResponse::readTable(const std::string& text, const std::string& file) {
  const std::vector<ResponseRow> rows = inColumn(rowsOf(text, file), file);
  if (rows.size() < 2) throw InputError(file, "", "is no camera response: it needs the light of two codes at least");
  const std::size_t columns = rows.front().numbers.size();
  if (columns > 4)
    throw InputError(
        file, lineText(rows.front().line),
        "has " + std::to_string(columns) + " numbers; expected light, code and light, or three colours with or without a code");
  const bool hasCodes = columns == 2 || columns == 4;
  const double last = hasCodes ? rows.back().numbers.front() : double(rows.size() - 1);
  if (hasCodes && std::find(kLargestCodes.begin(), kLargestCodes.end(), last) == kLargestCodes.end())
    throw InputError(file, lineText(rows.back().line),
                     "the last code must be the largest one: 1, 255, 1023, 4095, 16383 or 65535");
  if (hasCodes && rows.front().numbers.front() != 0)
    throw InputError(file, lineText(rows.front().line), "the first code must be 0");
  Table table;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ResponseRow& row = rows[i];
    table.codes.push_back((hasCodes ? row.numbers.front() : double(i)) / last);
    if (i > 0 && !(table.codes[i] > table.codes[i - 1])) throw InputError(file, lineText(row.line), "the codes must rise");
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<double>& lights = table.lights[c];
      lights.push_back(row.numbers[(hasCodes ? 1 : 0) + (columns >= 3 ? c : 0)]);
      if (lights.back() < 0) throw InputError(file, lineText(row.line), "light must not be negative (logarithms are not read)");
      if (i > 0 && lights[i] < lights[i - 1]) throw InputError(file, lineText(row.line), "light must not fall as the code rises");
    }
  }
  for (std::vector<double>& lights : table.lights) {
    const double most = lights.back();
    if (!(most > lights.front())) throw InputError(file, lineText(rows.back().line), "all codes have the same light");
    for (double& v : lights) v /= most;
  }
  return table;
}

double CameraResponse::lightOf(double code, int channel, bool isLinear) const {
  switch (kind_) {
    case Kind::ByFileType: return isLinear ? code : linearFromSrgb(code);
    case Kind::Srgb: return linearFromSrgb(code);
    case Kind::Linear: return code;
    case Kind::Gamma: return std::pow(std::max(code, 0.0), number_);
    case Kind::SCurve: return linearFromSrgb(withoutContrast(code, number_));
    case Kind::Table: break;
  }
  return interpolated(table_->codes, table_->lights[static_cast<std::size_t>(channel)], code);
}

double CameraResponse::codeOf(double light, int channel, bool isLinear) const {
  light = light > 0 ? std::min(light, 1.0) : 0.0;  // NaN is no light
  switch (kind_) {
    case Kind::ByFileType: return isLinear ? light : srgbFromLinear(light);
    case Kind::Srgb: return srgbFromLinear(light);
    case Kind::Linear: return light;
    case Kind::Gamma: return std::pow(light, 1 / number_);
    case Kind::SCurve: return withContrast(srgbFromLinear(light), number_);
    case Kind::Table: break;
  }
  return interpolated(table_->lights[static_cast<std::size_t>(channel)], table_->codes, light);
}

std::string CameraResponse::text() const {
  const auto shortest = [](double v) {
    char buffer[32];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, v).ptr);
  };
  std::string curve;
  switch (kind_) {
    case Kind::ByFileType: break;
    case Kind::Srgb: curve = "srgb"; break;
    case Kind::Linear: curve = "linear"; break;
    case Kind::Gamma: curve = "gamma:" + shortest(number_); break;
    case Kind::SCurve: curve = "s-curve:" + shortest(number_); break;
    case Kind::Table: return file_.string();
  }
  return vignetting_ > 0 ? curve + (curve.empty() ? "" : ", ") + "vignetting:" + shortest(vignetting_) : curve;
}

std::string CameraResponse::words(bool isLinear) const {
  if (vignetting_ > 0)
    return withVignetting(0).words(isLinear) + formatted(", brightened towards the corners by vignetting of %g", vignetting_);
  switch (kind_) {
    case Kind::ByFileType: return isLinear ? "taken as linear, as the files say" : "through the sRGB curve";
    case Kind::Srgb: return "through the sRGB curve";
    case Kind::Linear: return "taken as linear";
    case Kind::Gamma: return formatted("to the power of %g", number_);
    case Kind::SCurve: return formatted("through the sRGB curve with an S-curve of contrast %g", number_);
    case Kind::Table: return "through the curve of " + file_.filename().string();
  }
  return "";
}

std::string CameraResponse::doubt() const {
  if (kind_ != Kind::Gamma && kind_ != Kind::Table) return "";
  double most = 0;
  for (int c = 0; c < 3; ++c) most = std::max(most, lightOf(0.5, c));
  // Half the codes hold half the light in a linear camera; noise of a measured curve is below this.
  constexpr double kMoreThanLinear = 0.55;
  if (most <= kMoreThanLinear) return "";
  const double inverse = 1 / number_;
  return formatted(
             "the camera response gives %.0f %% of the light at half of the largest code, but cameras give less than half: ",
             100 * most) +
         (kind_ == Kind::Gamma ? formatted("was gamma:%.3g meant?", inverse)
                               : "does the file hold codes of lights, where lights of codes are expected?");
}

CameraResponse readResponseJson(const JsonNode& camera, const fs::path& folder, const PathRights& rights) {
  const auto node = camera.find("response");
  if (!node) return {};
  const std::string text = node->text();
  if (std::optional<CameraResponse> known = CameraResponse::named(text, node->file(), node->place())) return *known;
  const fs::path file = resolveInside(folder, text, rights, node->file(), node->place());
  std::error_code ignored;  // a file that cannot be looked at counts as missing
  if (!fs::is_regular_file(file, ignored))
    node->fail("'" + text + "' is neither srgb, linear, gamma:G, s-curve:S, vignetting:K, nor a file");
  return CameraResponse::ofFile(file);
}

}  // namespace glint
