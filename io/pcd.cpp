// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/limits.h"
#include "io/binary.h"
#include "io/cloud_reader.h"
#include "io/mesh_builder.h"
#include "io/text_scan.h"

namespace glint {
namespace {
using Eigen::Vector3d;

constexpr int kPcdNumbers = 6;  // x y z and the normal
constexpr std::array<std::string_view, kPcdNumbers> kPcdNames{"x", "y", "z", "normal_x", "normal_y", "normal_z"};

struct PcdField {
  char type = 'F';
  std::size_t size = 4, count = 1;
  int use = kPcdNumbers;  ///< place in kPcdNames; beyond = skipped
  std::size_t bytes() const { return size * count; }
};

struct PcdHeader {
  enum class Data { Text, Binary, Compressed } data = Data::Text;
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  std::size_t rowBytes = 0, rowValues = 0;
  std::size_t size = 0, lines = 0;  ///< the data begin after them
  bool hasNormals = false;
};

/// Reads the statements, each on a line of its own.
class PcdHeaderReader {
 public:
  PcdHeaderReader(std::string_view bytes, const std::string& file) : lines_(bytes, '\n'), file_(file) {}

  PcdHeader read() {
    while (true) {
      std::optional<std::string_view> line = lines_.next();
      if (!line || !lines_.ended()) io::fail(file_, io::lineNo(lines_.number()), "the PCD header is truncated");
      const std::string_view word = io::takeWord(*line);
      if (word.empty() || word.front() == '#') continue;
      if (word == "DATA") {
        data(io::takeWord(*line));
        break;
      }
      statement(word, *line);
    }
    finish();
    return std::move(header_);
  }

 private:
  [[noreturn]] void bad(const std::string& reason) const { io::fail(file_, io::lineNo(lines_.number()), reason); }

  std::uint64_t number(std::string_view text, const std::string& what) const {
    const std::optional<std::int64_t> n = io::integerOf(text);
    if (!n || *n < 0) bad(what + " must be a whole number, not " + io::quoted(text));
    return static_cast<std::uint64_t>(*n);
  }

  void statement(std::string_view word, std::string_view rest) {
    if (word == "FIELDS") {
      fields(rest);
    } else if (word == "SIZE" || word == "TYPE" || word == "COUNT") {
      for (PcdField& field : header_.fields) one(word, io::takeWord(rest), field);
      if (header_.fields.empty() || !io::takeWord(rest).empty()) bad(std::string(word) + " must have as many entries as FIELDS");
    } else if (word == "WIDTH") {
      width_ = number(io::takeWord(rest), "WIDTH");
    } else if (word == "HEIGHT") {
      height_ = number(io::takeWord(rest), "HEIGHT");
    } else if (word == "POINTS") {
      points_ = number(io::takeWord(rest), "POINTS");
    } else if (word != "VERSION" && word != "VIEWPOINT") {
      bad(io::quoted(word) + " is not a PCD header statement");
    }
  }

  void fields(std::string_view rest) {
    if (!header_.fields.empty()) bad("duplicate FIELDS");
    constexpr std::size_t kMostFields = 1000;  // no program writes more: a damaged header
    unsigned seen = 0;
    for (std::string_view name = io::takeWord(rest); !name.empty(); name = io::takeWord(rest)) {
      if (header_.fields.size() >= kMostFields) bad("more than " + std::to_string(kMostFields) + " fields");
      PcdField field;
      for (int k = 0; k < kPcdNumbers; ++k)
        if (name == kPcdNames[static_cast<std::size_t>(k)]) field.use = k;
      if (field.use < kPcdNumbers) {
        if (seen & (1u << field.use)) bad("duplicate field " + io::quoted(name));
        seen |= 1u << field.use;
      }
      header_.fields.push_back(field);
    }
    if ((seen & 7u) != 7u) bad("the fields lack x, y or z");
    header_.hasNormals = (seen & 56u) == 56u;
  }

  void one(std::string_view word, std::string_view value, PcdField& field) const {
    if (value.empty()) bad(std::string(word) + " must have as many entries as FIELDS");
    constexpr std::uint64_t kMostCount = 1'000'000;  // values of one field of a point: histograms have hundreds
    if (word == "TYPE") {
      if (value != "F" && value != "I" && value != "U") bad("unknown PCD type " + io::quoted(value));
      field.type = value.front();
    } else if (word == "SIZE") {
      field.size = number(value, "SIZE");
      if (field.size != 1 && field.size != 2 && field.size != 4 && field.size != 8) bad("a SIZE must be 1, 2, 4 or 8");
    } else {
      field.count = number(value, "COUNT");
      if (field.count > kMostCount) bad("a COUNT of " + std::to_string(field.count) + " is too large");
    }
  }

  void data(std::string_view kind) {
    if (kind == "ascii")
      header_.data = PcdHeader::Data::Text;
    else if (kind == "binary")
      header_.data = PcdHeader::Data::Binary;
    else if (kind == "binary_compressed")
      header_.data = PcdHeader::Data::Compressed;
    else
      bad("unknown PCD data " + io::quoted(kind));
  }

  void finish() {
    if (header_.fields.empty()) io::fail(file_, "header", "the PCD has no FIELDS");
    for (const PcdField& f : header_.fields) {
      if (f.type == 'F' && f.size < 4) io::fail(file_, "header", "a field of type F must have SIZE 4 or 8");
      if (f.use < kPcdNumbers && f.count != 1) io::fail(file_, "header", "x, y, z and normals must have COUNT 1");
      header_.rowBytes += f.bytes();
      header_.rowValues += f.count;
    }
    constexpr std::uint64_t kMost = std::numeric_limits<int>::max();
    if (width_ && height_ && *height_ > 0 && *width_ > kMost / *height_)
      io::fail(file_, "header", "WIDTH times HEIGHT is too large");
    const std::optional<std::uint64_t> grid = width_ && height_ ? std::optional(*width_ * *height_) : std::nullopt;
    if (!points_ && !grid) io::fail(file_, "header", "the PCD does not say how many POINTS it has");
    if (points_ && grid && *points_ != *grid)
      io::fail(file_, "header", "POINTS is " + std::to_string(*points_) + ", WIDTH times HEIGHT is " + std::to_string(*grid));
    header_.points = points_ ? *points_ : *grid;
    if (header_.points > kMost) io::fail(file_, "header", "more than 2147483647 points");
    if (header_.points == 0) io::fail(file_, "header", "the cloud has no points");
    header_.size = lines_.at();
    header_.lines = lines_.number();
  }

  io::Lines lines_;
  const std::string& file_;
  PcdHeader header_;
  std::optional<std::uint64_t> width_, height_, points_;
};

double pcdValue(const char* at, const PcdField& f) {
  constexpr bool kBig = false;  // PCD has no other byte order
  if (f.type == 'F') return f.size == 4 ? double(io::valueAt<float>(at, kBig)) : io::valueAt<double>(at, kBig);
  const bool isSigned = f.type == 'I';
  switch (f.size) {
    case 1: return isSigned ? double(io::valueAt<std::int8_t>(at, kBig)) : double(io::valueAt<std::uint8_t>(at, kBig));
    case 2: return isSigned ? double(io::valueAt<std::int16_t>(at, kBig)) : double(io::valueAt<std::uint16_t>(at, kBig));
    case 4: return isSigned ? double(io::valueAt<std::int32_t>(at, kBig)) : double(io::valueAt<std::uint32_t>(at, kBig));
    default: return isSigned ? double(io::valueAt<std::int64_t>(at, kBig)) : double(io::valueAt<std::uint64_t>(at, kBig));
  }
}

/// Takes the points one after the other.
class PcdPoints {
 public:
  PcdPoints(const PcdHeader& header, const std::string& file) : hasNormals_(header.hasNormals), file_(file) {}

  void add(const std::array<double, kPcdNumbers>& row, const std::string& place) {
    const Vector3d p(row[0], row[1], row[2]), n(row[3], row[4], row[5]);
    if (!p.allFinite()) {  // where a sensor saw nothing
      ++cloud_.without;
      return;
    }
    if (const char* reason = io::badCoordinate(p)) io::fail(file_, place, reason);
    cloud_.points.push_back(p);
    if (hasNormals_) cloud_.normals.push_back(n);
  }

  CloudContent finished() { return io::finished(std::move(cloud_), file_); }

 private:
  bool hasNormals_;
  const std::string& file_;
  CloudContent cloud_;
};

CloudContent pcdText(std::string_view bytes, const PcdHeader& header, const std::string& file) {
  const std::string_view body = bytes.substr(header.size);
  // A digit and a blank or a line break for each value; the last line may lack its break.
  if (header.rowValues > 0 && header.points > (body.size() + 1) / (2 * header.rowValues))
    io::fail(file, "header",
             "the PCD is truncated: it declares " + std::to_string(header.points) + " points, more than the file can hold");
  PcdPoints points(header, file);
  io::Lines lines(body, '\n');
  std::uint64_t read = 0;
  while (std::optional<std::string_view> line = lines.next()) {
    std::string_view word = io::takeWord(*line);
    if (word.empty()) continue;
    const std::string place = io::lineNo(header.lines + lines.number());
    if (read == header.points) io::fail(file, place, "unexpected data after the last point of the header");
    std::array<double, kPcdNumbers> row{};
    for (const PcdField& f : header.fields)
      for (std::size_t k = 0; k < f.count; ++k, word = io::takeWord(*line)) {
        if (word.empty()) io::fail(file, place, "needs " + std::to_string(header.rowValues) + " values");
        if (f.use >= kPcdNumbers) continue;
        const std::optional<double> v = io::numberOf(word);
        if (!v) io::fail(file, place, io::quoted(word) + " is not a number");
        row[static_cast<std::size_t>(f.use)] = *v;
      }
    if (!word.empty()) io::fail(file, place, "has more values than the header has fields");
    points.add(row, place);
    ++read;
  }
  if (read < header.points)
    io::fail(file, io::lineNo(header.lines + lines.number()),
             "the PCD is truncated: it declares " + std::to_string(header.points) + " points and has " + std::to_string(read));
  return points.finished();
}

CloudContent pcdBinary(std::string_view bytes, const PcdHeader& header, const std::string& file) {
  const std::string_view body = bytes.substr(header.size);
  if (header.rowBytes == 0 || header.points > body.size() / header.rowBytes)
    io::fail(file, "header",
             "the PCD is truncated: it declares " + std::to_string(header.points) + " points of " +
                 std::to_string(header.rowBytes) + " bytes, and has " + std::to_string(body.size()));
  for (std::size_t i = header.points * header.rowBytes; i < body.size(); ++i)
    if (!io::isPadding(body[i]))
      io::fail(file, io::byteNo(header.size + i), "unexpected data after the last point of the header");
  PcdPoints points(header, file);
  const char* at = body.data();
  for (std::uint64_t i = 0; i < header.points; ++i) {
    const std::size_t start = static_cast<std::size_t>(at - bytes.data());
    std::array<double, kPcdNumbers> row{};
    for (const PcdField& f : header.fields) {
      if (f.use < kPcdNumbers) row[static_cast<std::size_t>(f.use)] = pcdValue(at, f);
      at += f.bytes();
    }
    points.add(row, io::byteNo(start) + ", point " + std::to_string(i));
  }
  return points.finished();
}

/// LibLZF's format: after a byte below 32, that many literal bytes and one; else its upper three bits (7: and the next byte)
/// are a length less 2, the lower five and the next byte a distance back less 1. Nothing if the result is not of this size.
std::optional<std::string> lzfExpanded(std::string_view in, std::size_t size) {
  std::string out;
  out.reserve(size);
  std::size_t at = 0;
  const auto byte = [&] { return static_cast<std::size_t>(static_cast<unsigned char>(in[at++])); };
  while (at < in.size()) {
    const std::size_t control = byte();
    if (control < 32) {
      const std::size_t n = control + 1;
      if (n > in.size() - at || n > size - out.size()) return std::nullopt;
      out.append(in.substr(at, n));
      at += n;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (at == in.size()) return std::nullopt;
      length += byte();
    }
    if (at == in.size()) return std::nullopt;
    const std::size_t back = ((control & 31) << 8 | byte()) + 1;
    length += 2;
    if (back > out.size() || length > size - out.size()) return std::nullopt;
    for (std::size_t k = 0; k < length; ++k) out.push_back(out[out.size() - back]);  // it may overlap what it makes
  }
  return out.size() == size ? std::optional(std::move(out)) : std::nullopt;
}

/// Two sizes, then the compressed data: all values of the first field, then of the next.
CloudContent pcdCompressed(std::string_view bytes, const PcdHeader& header, const std::string& file) {
  constexpr std::size_t kSizes = 8;     // bytes
  constexpr std::size_t kExpands = 88;  // at most: 3 bytes give 264
  const std::string_view body = bytes.substr(header.size);
  if (body.size() < kSizes) io::fail(file, io::byteNo(header.size), "the PCD is truncated before its compressed data");
  const std::size_t packed = io::valueAt<std::uint32_t>(body.data(), false),
                    size = io::valueAt<std::uint32_t>(body.data() + 4, false);
  if (packed > body.size() - kSizes)
    io::fail(file, io::byteNo(header.size),
             "the PCD is truncated: it declares " + std::to_string(packed) + " compressed bytes, and has " +
                 std::to_string(body.size() - kSizes));
  if (header.rowBytes == 0 || size / header.rowBytes != header.points || size % header.rowBytes != 0)
    io::fail(file, io::byteNo(header.size + 4),
             "the compressed data have " + std::to_string(size) + " bytes, " + std::to_string(header.points) + " points of " +
                 std::to_string(header.rowBytes) + " need others");
  if (size / kExpands > packed)
    io::fail(file, io::byteNo(header.size), "the compressed data are too few for what they shall give");
  constexpr double kMega = 1e6;
  requireWithin(Limit::MeshMegabytes, double(size) / kMega, file);
  for (std::size_t i = kSizes + packed; i < body.size(); ++i)
    if (!io::isPadding(body[i])) io::fail(file, io::byteNo(header.size + i), "unexpected data after the compressed data");
  const std::optional<std::string> all = lzfExpanded(body.substr(kSizes, packed), size);
  if (!all) io::fail(file, io::byteNo(header.size + kSizes), "the compressed data are damaged");
  PcdPoints points(header, file);
  for (std::uint64_t i = 0; i < header.points; ++i) {
    std::array<double, kPcdNumbers> row{};
    std::size_t column = 0;
    for (const PcdField& f : header.fields) {
      if (f.use < kPcdNumbers) row[static_cast<std::size_t>(f.use)] = pcdValue(all->data() + column + i * f.bytes(), f);
      column += header.points * f.bytes();
    }
    points.add(row, "point " + std::to_string(i));
  }
  return points.finished();
}

}  // namespace

CloudContent parsePcd(std::string_view bytes, const std::string& file) {
  const PcdHeader header = PcdHeaderReader(bytes, file).read();
  switch (header.data) {
    case PcdHeader::Data::Text: return pcdText(bytes, header, file);
    case PcdHeader::Data::Binary: return pcdBinary(bytes, header, file);
    case PcdHeader::Data::Compressed: break;
  }
  return pcdCompressed(bytes, header, file);
}

}  // namespace glint
