// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "io/binary.h"
#include "io/cloud_reader.h"
#include "io/mesh_builder.h"
#include "io/mesh_reader.h"
#include "io/text_scan.h"

namespace glint {
namespace {

using Eigen::Vector3d;

enum class Scalar { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

std::optional<Scalar> scalarNamed(std::string_view name) {
  struct Name {
    std::string_view text;
    Scalar type;
  };
  static constexpr Name kNames[] = {
      {"char", Scalar::Int8},     {"int8", Scalar::Int8},       {"uchar", Scalar::Uint8},    {"uint8", Scalar::Uint8},
      {"short", Scalar::Int16},   {"int16", Scalar::Int16},     {"ushort", Scalar::Uint16},  {"uint16", Scalar::Uint16},
      {"int", Scalar::Int32},     {"int32", Scalar::Int32},     {"uint", Scalar::Uint32},    {"uint32", Scalar::Uint32},
      {"float", Scalar::Float32}, {"float32", Scalar::Float32}, {"double", Scalar::Float64}, {"float64", Scalar::Float64}};
  for (const Name& n : kNames)
    if (n.text == name) return n.type;
  return std::nullopt;
}

std::size_t sizeOf(Scalar type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

double valueOf(const char* at, Scalar type, bool big) {
  switch (type) {
    case Scalar::Int8: return io::valueAt<std::int8_t>(at, big);
    case Scalar::Uint8: return io::valueAt<std::uint8_t>(at, big);
    case Scalar::Int16: return io::valueAt<std::int16_t>(at, big);
    case Scalar::Uint16: return io::valueAt<std::uint16_t>(at, big);
    case Scalar::Int32: return io::valueAt<std::int32_t>(at, big);
    case Scalar::Uint32: return io::valueAt<std::uint32_t>(at, big);
    case Scalar::Float32: return io::valueAt<float>(at, big);
    case Scalar::Float64: return io::valueAt<double>(at, big);
  }
  return 0;
}

/// What a property is to us. The first six are places in a row of numbers.
enum Use : int { kX, kY, kZ, kNx, kNy, kNz, kNumbers, kCorners = kNumbers, kSkipped };

struct Property {
  Scalar type = Scalar::Float32;
  std::optional<Scalar> counter;  ///< of a list
  int use = kSkipped;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  enum class Format { Text, LittleEndian, BigEndian } format = Format::Text;
  std::vector<Element> elements;
  std::size_t size = 0, lines = 0;  ///< the data begin after them
  char lineEnd = '\n';
};

enum class Wanted { Mesh, Cloud };

/// Strips come as one list or more, with -1 between two strips.
bool isStrips(std::string_view element) { return element == "tristrips"; }
bool isFaces(std::string_view element) { return element == "face" || isStrips(element); }

/// Reads the statements of a header, line by line.
class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& file)
      : file_(file), lineEnd_(bytes.size() > 4 && bytes[3] == '\r' && bytes[4] != '\n' ? '\r' : '\n'), lines_(bytes, lineEnd_) {}

  Header read() {
    header_.lineEnd = lineEnd_;
    while (true) {
      std::optional<std::string_view> line = lines_.next();
      if (!line || !lines_.ended()) io::fail(file_, io::lineNo(lines_.number() + (line ? 0 : 1)), "the PLY header is truncated");
      const std::string_view word = io::takeWord(*line);
      if (word == "end_header") break;
      if (word == "format")
        readFormat(*line);
      else if (word == "element")
        readElement(*line);
      else if (word == "property")
        readProperty(*line);
      else if (!word.empty() && word != "comment" && word != "obj_info" && lines_.number() > 1)
        bad(io::quoted(word) + " is not a PLY header statement");
    }
    if (!formatKnown_) io::fail(file_, "header", "the PLY has no format");
    header_.size = lines_.at();
    header_.lines = lines_.number();
    return std::move(header_);
  }

 private:
  [[noreturn]] void bad(const std::string& reason) const { io::fail(file_, io::lineNo(lines_.number()), reason); }

  void readFormat(std::string_view line) {
    const std::string_view name = io::takeWord(line), version = io::takeWord(line);
    if (formatKnown_) bad("duplicate format");
    formatKnown_ = true;
    if (name == "ascii")
      header_.format = Header::Format::Text;
    else if (name == "binary_little_endian")
      header_.format = Header::Format::LittleEndian;
    else if (name == "binary_big_endian")
      header_.format = Header::Format::BigEndian;
    else
      bad("unknown PLY format " + io::quoted(name));
    if (version != "1.0") bad("unknown PLY version " + io::quoted(version) + "; only 1.0 is supported");
  }

  void readElement(std::string_view line) {
    const std::string_view name = io::takeWord(line);
    const std::optional<std::int64_t> count = io::integerOf(io::takeWord(line));
    if (name.empty() || !count || *count < 0) bad("the PLY element has no count");
    if (name == "vertex" || isFaces(name))
      for (const Element& e : header_.elements)
        if (e.name == name) bad("duplicate element " + io::quoted(name));
    constexpr std::size_t kMostElements = 1000;  // no program writes more: a damaged header
    if (header_.elements.size() >= kMostElements) bad("more than " + std::to_string(kMostElements) + " elements");
    header_.elements.push_back({std::string(name), static_cast<std::uint64_t>(*count), {}});
    seen_ = 0;
  }

  void readProperty(std::string_view line) {
    if (header_.elements.empty()) bad("a PLY property before any element");
    Element& element = header_.elements.back();
    Property p;
    std::string_view type = io::takeWord(line);
    if (type == "list") {
      p.counter = typeNamed(io::takeWord(line));
      type = io::takeWord(line);
    }
    p.type = typeNamed(type);
    const std::string_view name = io::takeWord(line);
    if (name.empty()) bad("the PLY property has no name");
    constexpr std::size_t kLongestName = 1000;  // no program writes longer ones: a damaged header
    if (name.size() > kLongestName) bad("a PLY property name of " + std::to_string(name.size()) + " characters is too long");
    if (element.name == "vertex") {
      constexpr std::string_view kNames[] = {"x", "y", "z", "nx", "ny", "nz"};
      for (int k = 0; k < kNumbers; ++k)
        if (name == kNames[k]) p.use = k;
    } else if (isFaces(element.name) && (name == "vertex_indices" || name == "vertex_index")) {
      p.use = kCorners;
    }
    if (p.use != kSkipped) {
      if (p.use == kCorners && !p.counter) bad(io::quoted(name) + " of a face must be a list");
      if (p.use != kCorners && p.counter) bad(io::quoted(name) + " of a vertex must be a number, not a list");
      if (seen_ & (1u << p.use)) bad("duplicate property " + io::quoted(name));
      seen_ |= 1u << p.use;
    }
    element.properties.push_back(p);
  }

  Scalar typeNamed(std::string_view name) const {
    const std::optional<Scalar> type = scalarNamed(name);
    if (!type) bad("unknown PLY type " + io::quoted(name));
    return *type;
  }

  const std::string& file_;
  char lineEnd_;
  io::Lines lines_;
  Header header_;
  bool formatKnown_ = false;
  unsigned seen_ = 0;  ///< uses that the element at hand has, as bits
};

/// Whether the elements are what is wanted; InputError where they are not.
void checkElements(const Header& header, const std::string& file, Wanted wanted) {
  const Element *vertex = nullptr, *face = nullptr;
  for (const Element& e : header.elements) {
    if (e.name == "vertex") vertex = &e;
    if (isFaces(e.name) && (!face || face->count == 0)) face = &e;
    if (e.properties.empty() && e.count > 0) io::fail(file, "header", "element " + io::quoted(e.name) + " has no properties");
  }
  const auto has = [](const Element& e, int use) {
    return std::any_of(e.properties.begin(), e.properties.end(), [&](const Property& p) { return p.use == use; });
  };
  if (!vertex) io::fail(file, "header", "the PLY has no element 'vertex'");
  if (!has(*vertex, kX) || !has(*vertex, kY) || !has(*vertex, kZ)) io::fail(file, "header", "the vertices lack x, y or z");
  const bool faces = face && face->count > 0;
  if (wanted == Wanted::Cloud && faces) io::fail(file, "header", "has faces: it is a mesh, not a cloud");
  if (wanted == Wanted::Mesh && !faces) io::fail(file, "header", "the mesh has no faces");
  if (wanted == Wanted::Mesh && !has(*face, kCorners)) io::fail(file, "header", "the faces have no list 'vertex_indices'");
}

Header readHeader(std::string_view bytes, const std::string& file, Wanted wanted) {
  Header header = HeaderReader(bytes, file).read();
  checkElements(header, file, wanted);
  return header;
}

/// Where an element is, for messages.
std::string placeOf(const std::string& where, const Element& e, std::uint64_t index) {
  return where + ", " + io::quoted(e.name).substr(1, std::min<std::size_t>(e.name.size(), 40)) + " " + std::to_string(index);
}

/// Values of a binary file, one after the other.
class BinaryValues {
 public:
  BinaryValues(std::string_view bytes, const Header& header, const std::string& file)
      : bytes_(bytes), file_(file), at_(header.size), big_(header.format == Header::Format::BigEndian) {}

  /// Least bytes of a value and of a list: what the file cannot hold is refused before anything is allocated.
  static std::size_t least(const Property& p) {
    return p.counter ? sizeOf(*p.counter) + (p.use == kCorners ? 3 * sizeOf(p.type) : 0) : sizeOf(p.type);
  }
  std::size_t left() const { return bytes_.size() - at_; }
  void beginRow(const Element& e, std::uint64_t index) {
    element_ = &e;
    index_ = index;
    rowAt_ = at_;
  }
  void endRow() {}
  std::size_t at() const { return rowAt_; }  ///< of the row at hand
  static std::string placeOf(const char* element, std::size_t index, std::size_t at) {
    return io::byteNo(at) + ", " + element + " " + std::to_string(index);
  }
  std::string place() const { return glint::placeOf(io::byteNo(rowAt_), *element_, index_); }
  double value(Scalar type) {
    const std::size_t size = sizeOf(type);
    if (left() < size) truncated();
    const double v = valueOf(bytes_.data() + at_, type, big_);
    at_ += size;
    return v;
  }
  double counter(Scalar type) { return value(type); }
  void skip(Scalar type, std::uint64_t count) {
    if (count > left() / sizeOf(type)) truncated();
    at_ += count * sizeOf(type);
  }
  [[noreturn]] void truncated() const {
    io::fail(file_, place(), "the PLY is truncated: the header declares " + std::to_string(element_->count) + " of these");
  }
  void end() const {
    for (std::size_t i = at_; i < bytes_.size(); ++i)
      if (!io::isPadding(bytes_[i])) io::fail(file_, io::byteNo(i), "unexpected data after the last element of the header");
  }

 private:
  std::string_view bytes_;
  const std::string& file_;
  std::size_t at_, rowAt_ = 0;
  bool big_;
  const Element* element_ = nullptr;
  std::uint64_t index_ = 0;
};

/// Values of a text file: one line for each element.
class TextValues {
 public:
  TextValues(std::string_view bytes, const Header& header, const std::string& file)
      : size_(bytes.size() - header.size),
        headerLines_(header.lines),
        file_(file),
        lines_(bytes.substr(header.size), header.lineEnd) {}

  /// A digit and a blank or a line break; the last line may lack its break.
  static std::size_t least(const Property& p) { return p.counter && p.use == kCorners ? 8 : 2; }
  std::size_t left() const { return size_ - lines_.at() + 1; }
  void beginRow(const Element& e, std::uint64_t index) {
    element_ = &e;
    index_ = index;
    do {
      const std::optional<std::string_view> line = lines_.next();
      if (!line) truncated();
      row_ = *line;
      word_ = io::takeWord(row_);
    } while (word_.empty());
  }
  void endRow() const {
    if (!word_.empty()) io::fail(file_, place(), "has more values than the header has properties");
  }
  std::size_t at() const { return headerLines_ + lines_.number(); }
  static std::string placeOf(const char* element, std::size_t index, std::size_t at) {
    return io::lineNo(at) + ", " + element + " " + std::to_string(index);
  }
  std::string place() const { return glint::placeOf(io::lineNo(at()), *element_, index_); }
  double value(Scalar) {
    const std::optional<double> v = io::numberOf(take());
    if (!v) io::fail(file_, place(), io::quoted(taken_) + " is not a number");
    return *v;
  }
  double counter(Scalar type) { return value(type); }
  void skip(Scalar, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) take();  // ends at the end of the line, whatever the count says
  }
  [[noreturn]] void truncated() const {
    io::fail(file_, place(), "the PLY is truncated: the header declares " + std::to_string(element_->count) + " of these");
  }
  void end() {
    while (const std::optional<std::string_view> line = lines_.next()) {
      std::string_view rest = *line;
      if (!io::takeWord(rest).empty())
        io::fail(file_, io::lineNo(headerLines_ + lines_.number()), "unexpected data after the last element of the header");
    }
  }

 private:
  std::string_view take() {
    if (word_.empty()) truncated();
    taken_ = word_;
    word_ = io::takeWord(row_);
    return taken_;
  }

  std::size_t size_, headerLines_;
  const std::string& file_;
  io::Lines lines_;
  std::string_view row_, word_, taken_;
  const Element* element_ = nullptr;
  std::uint64_t index_ = 0;
};

std::string asText(double v) {
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, v);  // shortest; no locale
  return std::string(text, end.ptr);
}

template <class Values>
class PlyBody {
 public:
  PlyBody(Values values, const Header& header, const std::string& file)
      : values_(std::move(values)), header_(header), file_(file), fan_(mesh_.triangles) {}

  /// Without triangles where the file has none.
  MeshContent read() {
    for (const Element& e : header_.elements)
      if (e.name == "vertex") vertexCount_ = e.count;
    if (vertexCount_ > std::uint64_t(std::numeric_limits<int>::max())) fewerBytes(vertexCount_, "vertex");
    for (const Element& e : header_.elements) {
      checkSize(e);
      if (e.name == "vertex")
        vertices(e);
      else
        others(e);
    }
    values_.end();
    bad_.remove(mesh_, file_, [](std::size_t vertex, std::size_t place) { return Values::placeOf("vertex", vertex, place); });
    std::vector<Eigen::Vector3i> nothingBeside;
    fan_.cut(mesh_.vertices, nothingBeside, file_);
    return std::move(mesh_);
  }
  std::size_t without() const { return bad_.count(); }

 private:
  [[noreturn]] void fewerBytes(std::uint64_t count, const std::string& name) const {
    io::fail(file_, "header",
             "the PLY is truncated: its header declares " + std::to_string(count) + " of element " + io::quoted(name) +
                 ", more than the file can hold");
  }

  /// The file is long enough for what the header promises.
  void checkSize(const Element& e) const {
    std::size_t least = 0;
    for (const Property& p : e.properties) least += Values::least(p);
    if (least > 0 && e.count > values_.left() / least) {
      if (isFaces(e.name)) return;  // faces of too few corners, or a cut: the row tells which
      fewerBytes(e.count, e.name);
    }
  }

  void vertices(const Element& e) {
    int found = 0;
    for (const Property& p : e.properties) found += p.use >= kNx && p.use <= kNz;
    const bool normals = found == 3;
    mesh_.vertices.reserve(e.count);
    if (normals) mesh_.normals.reserve(e.count);
    std::array<double, kNumbers> row{};
    for (std::uint64_t i = 0; i < e.count; ++i) {
      values_.beginRow(e, i);
      for (const Property& p : e.properties) {
        if (p.use < kNumbers)
          row[static_cast<std::size_t>(p.use)] = values_.value(p.type);
        else
          values_.skip(p.type, p.counter ? count(*p.counter) : 1);
      }
      values_.endRow();
      const Vector3d v(row[kX], row[kY], row[kZ]);
      if (io::badCoordinate(v)) bad_.note(mesh_.vertices.size(), values_.at());
      mesh_.vertices.push_back(v);
      if (normals) mesh_.normals.emplace_back(row[kNx], row[kNy], row[kNz]);
    }
  }

  void others(const Element& e) {
    const bool faces = isFaces(e.name), strips = isStrips(e.name);
    for (std::uint64_t i = 0; i < e.count; ++i) {
      values_.beginRow(e, i);
      for (const Property& p : e.properties) {
        const std::uint64_t n = p.counter ? count(*p.counter) : 1;
        if (p.use == kCorners && strips)
          strip(p, n);
        else if (p.use == kCorners)
          corners(p, n);
        else
          values_.skip(p.type, n);
      }
      values_.endRow();
      if (faces && mesh_.triangles.size() > std::size_t(std::numeric_limits<int>::max()))
        io::fail(file_, values_.place(), "more than 2147483647 triangles");
    }
  }

  std::uint64_t count(Scalar counter) {
    const double n = values_.counter(counter);
    constexpr double kMost = 1e15;  // no file has as many, and every whole number up to it is a double
    if (!(n >= 0 && n <= kMost && n == std::floor(n))) io::fail(file_, values_.place(), "a list has " + asText(n) + " entries");
    return static_cast<std::uint64_t>(n);
  }

  void corners(const Property& p, std::uint64_t n) {
    if (n < 3) io::fail(file_, values_.place(), "has " + std::to_string(n) + " corners; a face needs three");
    fan_.begin();
    for (std::uint64_t k = 0; k < n; ++k) fan_.add(vertexNumber(values_.value(p.type)));
    fan_.end();
  }

  /// Every other triangle of a strip is turned. Those with a corner twice lead from one part to the next.
  void strip(const Property& p, std::uint64_t n) {
    int before[2] = {0, 0};
    std::uint64_t corner = 0;
    for (std::uint64_t k = 0; k < n; ++k) {
      const double v = values_.value(p.type);
      if (v == -1) {
        corner = 0;
        continue;
      }
      const int last = vertexNumber(v);
      if (corner >= 2 && before[0] != before[1] && before[1] != last && last != before[0])
        mesh_.triangles.emplace_back(before[corner % 2], before[1 - corner % 2], last);
      before[0] = before[1];
      before[1] = last;
      ++corner;
    }
  }

  int vertexNumber(double v) {
    if (!(v >= 0 && v < double(vertexCount_) && v == std::floor(v)))
      io::fail(file_, values_.place(), "names vertex " + asText(v) + "; the file has " + std::to_string(vertexCount_));
    return static_cast<int>(v);
  }

  Values values_;
  const Header& header_;
  const std::string& file_;
  MeshContent mesh_;
  io::Fan fan_;
  io::BadVertices bad_;
  std::uint64_t vertexCount_ = 0;
};

/// @param without  takes the number of vertices that no face uses and that have no place, such as NaN
MeshContent readPly(std::string_view bytes, const std::string& file, Wanted wanted, std::size_t& without) {
  const Header header = readHeader(bytes, file, wanted);
  const auto read = [&](auto values) {
    PlyBody body(std::move(values), header, file);
    MeshContent mesh = body.read();
    without = body.without();
    return mesh;
  };
  return header.format == Header::Format::Text ? read(TextValues(bytes, header, file)) : read(BinaryValues(bytes, header, file));
}

}  // namespace

MeshContent parsePly(std::string_view bytes, const std::string& file) {
  std::size_t without = 0;
  return io::finished(readPly(bytes, file, Wanted::Mesh, without), file);
}

CloudContent parsePlyCloud(std::string_view bytes, const std::string& file) {
  std::size_t without = 0;
  MeshContent mesh = readPly(bytes, file, Wanted::Cloud, without);
  return io::finished(CloudContent{std::move(mesh.vertices), std::move(mesh.normals), without}, file);
}

}  // namespace glint
