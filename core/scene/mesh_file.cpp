// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/mesh_file.h"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPLYReader.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkTriangleFilter.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <string_view>

#include "core/base/atomic_file.h"
#include "core/base/outcome.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// How many vertices and faces a file promises, after its bytes were found to be there.
struct Promise {
  long long vertices = -1, faces = -1;  // -1 = the format does not say
};

[[noreturn]] void fail(const fs::path& file, const std::string& place, const std::string& reason) {
  throw InputError(file.string(), place, reason);
}

bool startsWith(const std::string& bytes, const char* text) { return bytes.compare(0, std::strlen(text), text) == 0; }

struct PlyProperty {
  std::string name;
  std::size_t size = 0;       // bytes of a value (of an element, for a list)
  std::size_t countSize = 0;  // bytes of a list's counter; 0 = not a list
};
struct PlyElement {
  std::string name;
  long long count = 0;
  std::vector<PlyProperty> properties;
};

std::size_t plySize(const fs::path& file, const std::string& place, const std::string& type) {
  static const std::map<std::string, std::size_t> sizes = {
      {"char", 1}, {"uchar", 1}, {"int8", 1},  {"uint8", 1},  {"short", 2}, {"ushort", 2},  {"int16", 2},  {"uint16", 2},
      {"int", 4},  {"uint", 4},  {"int32", 4}, {"uint32", 4}, {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto it = sizes.find(type);
  if (it == sizes.end()) fail(file, place, "unknown PLY type '" + type + "'");
  return it->second;
}

std::uint64_t plyCounter(const char* at, std::size_t size, bool bigEndian) {
  std::uint64_t v = 0;
  for (std::size_t i = 0; i < size; ++i)
    v |= std::uint64_t(static_cast<unsigned char>(at[bigEndian ? size - 1 - i : i])) << (8 * i);
  return v;
}

/// Reads the header and walks the data: VTK's reader returns fewer elements, or crashes, when data is missing.
Promise checkPly(const fs::path& file, const std::string& bytes) {
  std::size_t at = 0;
  int line = 0;
  const auto nextLine = [&]() -> std::string {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos) fail(file, "line " + std::to_string(line + 1), "the PLY header is truncated");
    std::string text = bytes.substr(at, end - at);
    if (!text.empty() && text.back() == '\r') text.pop_back();
    at = end + 1;
    ++line;
    return text;
  };
  std::vector<PlyElement> elements;
  std::string format;
  nextLine();
  while (true) {
    const std::string text = nextLine();
    const std::string place = "line " + std::to_string(line);
    std::istringstream words(text);
    std::string word;
    words >> word;
    if (word == "end_header") break;
    if (word == "format") words >> format;
    if (word == "element") {
      PlyElement e;
      if (!(words >> e.name >> e.count) || e.count < 0) fail(file, place, "the PLY element has no count");
      elements.push_back(e);
    }
    if (word == "property") {
      if (elements.empty()) fail(file, place, "a PLY property before any element");
      PlyProperty p;
      std::string type;
      words >> type;
      if (type == "list") {
        std::string counter;
        words >> counter >> type;
        p.countSize = plySize(file, place, counter);
      }
      p.size = plySize(file, place, type);
      words >> p.name;
      elements.back().properties.push_back(p);
    }
  }
  Promise promise{0, 0};
  for (const PlyElement& e : elements) {
    if (e.name == "vertex") promise.vertices = e.count;
    if (e.name == "face") promise.faces = e.count;
  }
  const auto truncated = [&](const PlyElement& e, long long index) {
    fail(file, e.name + " " + std::to_string(index),
         "the PLY is truncated: the header promises " + std::to_string(e.count) + " of these");
  };
  if (format == "ascii") {
    for (const PlyElement& e : elements) {
      for (long long i = 0; i < e.count; ++i) {
        std::size_t end = bytes.find('\n', at);
        if (end == std::string::npos) end = bytes.size();
        const std::string_view text(bytes.data() + std::min(at, bytes.size()), end - std::min(at, bytes.size()));
        at = end + 1;
        // Enough words on the line: a cut inside the last line shows here.
        std::size_t words = 0, first = 0;
        bool inWord = false;
        for (const char c : text) {
          const bool blank = c == ' ' || c == '\t' || c == '\r';
          if (!blank && !inWord) ++words;
          if (!blank && words == 1 && c >= '0' && c <= '9' && first < 1000000) first = first * 10 + std::size_t(c - '0');
          inWord = !blank;
        }
        const bool startsWithList = !e.properties.empty() && e.properties[0].countSize > 0;
        const std::size_t needed = startsWithList ? first + e.properties.size() : e.properties.size();
        if (words < needed) truncated(e, i);
      }
    }
    return promise;
  }
  if (format != "binary_little_endian" && format != "binary_big_endian")
    fail(file, "header", "unknown PLY format '" + format + "'");
  const bool big = format == "binary_big_endian";
  for (const PlyElement& e : elements) {
    std::size_t fixed = 0;
    bool hasList = false;
    for (const PlyProperty& p : e.properties) {
      if (p.countSize)
        hasList = true;
      else
        fixed += p.size;
    }
    if (!hasList) {
      if (fixed > 0 && std::uint64_t(e.count) > (bytes.size() - at) / fixed)
        truncated(e, static_cast<long long>((bytes.size() - at) / fixed));
      at += fixed * static_cast<std::size_t>(e.count);
      continue;
    }
    for (long long i = 0; i < e.count; ++i) {
      for (const PlyProperty& p : e.properties) {
        std::uint64_t n = 1;
        if (p.countSize) {
          if (bytes.size() - at < p.countSize) truncated(e, i);
          n = plyCounter(bytes.data() + at, p.countSize, big);
          at += p.countSize;
        }
        if (n > (bytes.size() - at) / p.size) truncated(e, i);
        at += static_cast<std::size_t>(n) * p.size;
      }
    }
  }
  return promise;
}

/// A binary STL says how many facets follow; a text one must close what it opens.
Promise checkStl(const fs::path& file, const std::string& bytes, bool binary) {
  if (binary) {
    const std::uint64_t n = plyCounter(bytes.data() + 80, 4, false);
    if (84 + 50 * n > bytes.size())
      fail(file, "facet " + std::to_string((bytes.size() - 84) / 50),
           "the STL is truncated: its header promises " + std::to_string(n) + " facets");
    return {-1, -1};
  }
  if (bytes.find("endsolid") == std::string::npos) fail(file, "end", "the STL is truncated: endsolid is missing");
  return {-1, -1};
}

/// Every vertex number of a face must exist; a cut file fails here or by its last, incomplete line.
Promise checkObj(const fs::path& file, const std::string& bytes) {
  Promise promise{0, 0};
  std::istringstream in(bytes);
  std::string text;
  long long largest = 0, largestLine = 0, number = 0;
  while (std::getline(in, text)) {
    ++number;
    std::istringstream words(text);
    std::string word;
    words >> word;
    const auto bad = [&](const std::string& reason) { fail(file, "line " + std::to_string(number), reason); };
    if (word == "v") {
      double x = 0, y = 0, z = 0;
      if (!(words >> x >> y >> z)) bad("a vertex needs three numbers");
      ++promise.vertices;
    } else if (word == "f") {
      int corners = 0;
      while (words >> word) {
        long long index = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
        if (error != std::errc() || (end != word.data() + word.size() && *end != '/'))
          bad("'" + word + "' is not a vertex number");
        if (index == 0 || -index > promise.vertices)
          bad("a face names vertex " + std::to_string(index) + ", which does not exist");
        if (index > largest) {
          largest = index;
          largestLine = number;
        }
        ++corners;
      }
      if (corners < 3) bad("a face needs three vertices");
      ++promise.faces;
    }
  }
  if (largest > promise.vertices)
    fail(file, "line " + std::to_string(largestLine),
         "a face names vertex " + std::to_string(largest) + ", the file has " + std::to_string(promise.vertices));
  return {-1, promise.faces};
}

/// VTK reports to the terminal unless somebody listens.
struct VtkMessages {
  std::string first;
  vtkNew<vtkCallbackCommand> command;
  VtkMessages() {
    command->SetClientData(this);
    command->SetCallback([](vtkObject*, unsigned long, void* self, void* text) {
      VtkMessages* messages = static_cast<VtkMessages*>(self);
      if (messages->first.empty() && text) messages->first = static_cast<const char*>(text);
    });
  }
  void listenTo(vtkObject* object) {
    object->AddObserver(vtkCommand::ErrorEvent, command);
    object->AddObserver(vtkCommand::WarningEvent, command);
  }
  /// The message proper: VTK puts the source file and the object before it, line by line.
  std::string oneLine() const {
    std::string text = first;
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    if (const std::size_t at = text.rfind("): "); at != std::string::npos) text = text.substr(at + 3);
    for (char& c : text)
      if (c == '\n') c = ' ';
    return text;
  }
};

template <class Reader>
vtkSmartPointer<vtkPolyData> readWith(const fs::path& file, VtkMessages& messages) {
  vtkNew<Reader> reader;
  messages.listenTo(reader);
  reader->SetFileName(file.c_str());
  reader->Update();
  if (!messages.first.empty()) fail(file, "", messages.oneLine());
  return reader->GetOutput();
}

TriangleMesh toTriangles(const fs::path& file, vtkPolyData* input) {
  vtkSmartPointer<vtkPolyData> data = input;
  const vtkIdType n = data->GetNumberOfPoints();
  // Checked before any filter: the filters trust the indices.
  vtkCellArray* cells = data->GetPolys();
  vtkIdType size = 0;
  const vtkIdType* ids = nullptr;
  bool allTriangles = true;
  cells->InitTraversal();
  for (vtkIdType face = 0; cells->GetNextCell(size, ids); ++face) {
    allTriangles = allTriangles && size == 3;
    for (vtkIdType i = 0; i < size; ++i)
      if (ids[i] < 0 || ids[i] >= n)
        fail(file, "face " + std::to_string(face),
             "names vertex " + std::to_string(ids[i]) + ", the file has " + std::to_string(n));
  }
  if (!allTriangles || data->GetNumberOfStrips() > 0) {
    vtkNew<vtkTriangleFilter> split;
    split->SetInputData(data);
    split->PassVertsOff();
    split->PassLinesOff();
    split->Update();
    data = split->GetOutput();
  }
  TriangleMesh mesh;
  mesh.vertices.resize(static_cast<std::size_t>(n));
  for (vtkIdType i = 0; i < n; ++i) {
    Eigen::Vector3d& v = mesh.vertices[static_cast<std::size_t>(i)];
    data->GetPoint(i, v.data());
    if (!v.allFinite()) fail(file, "vertex " + std::to_string(i), "is not finite");
  }
  cells = data->GetPolys();
  mesh.triangles.reserve(static_cast<std::size_t>(cells->GetNumberOfCells()));
  cells->InitTraversal();
  while (cells->GetNextCell(size, ids))
    if (size == 3) mesh.triangles.emplace_back(static_cast<int>(ids[0]), static_cast<int>(ids[1]), static_cast<int>(ids[2]));
  if (mesh.triangles.empty()) fail(file, "", "the mesh has no faces");
  if (vtkDataArray* normals = data->GetPointData()->GetNormals(); normals && normals->GetNumberOfTuples() == n) {
    mesh.normals.resize(static_cast<std::size_t>(n));
    for (vtkIdType i = 0; i < n; ++i) {
      Eigen::Vector3d v;
      normals->GetTuple(i, v.data());
      const double length = v.norm();
      constexpr double kUnset = 1e-6;  // normals have length 1, whatever the scene's unit
      if (!(length > kUnset) || !std::isfinite(length)) {
        mesh.normals.clear();
        break;
      }
      mesh.normals[static_cast<std::size_t>(i)] = v / length;
    }
  }
  return mesh;
}

}  // namespace

TriangleMesh readMesh(const fs::path& file) {
  const std::string bytes = readFile(file);
  if (bytes.empty()) fail(file, "", "the file is empty (0 bytes)");
  VtkMessages messages;
  Promise promise;
  vtkSmartPointer<vtkPolyData> data;
  const std::string extension = file.extension().string();
  const bool namedStl = extension == ".stl" || extension == ".STL";
  // A binary STL may start with "solid" too; its size follows from its facet count.
  const bool binaryStl = bytes.size() >= 84 && (84 + 50 * plyCounter(bytes.data() + 80, 4, false) == bytes.size() ||
                                                (namedStl && !startsWith(bytes, "solid")));
  if (startsWith(bytes, "ply\n") || startsWith(bytes, "ply\r")) {
    promise = checkPly(file, bytes);
    data = readWith<vtkPLYReader>(file, messages);
  } else if (binaryStl || startsWith(bytes, "solid")) {
    promise = checkStl(file, bytes, binaryStl);
    data = readWith<vtkSTLReader>(file, messages);
  } else if (bytes.find("v ") != std::string::npos && bytes.find('\0') == std::string::npos) {
    promise = checkObj(file, bytes);
    if (promise.faces == 0) fail(file, "", "no mesh: neither PLY nor STL, and as OBJ it has no faces");
    data = readWith<vtkOBJReader>(file, messages);
  } else {
    fail(file, "", namedStl ? "the STL is truncated" : "is not a mesh; understood: PLY, OBJ, STL");
  }
  if (promise.vertices >= 0 && data->GetNumberOfPoints() != promise.vertices)
    fail(file, "vertices",
         "the header promises " + std::to_string(promise.vertices) + ", " + std::to_string(data->GetNumberOfPoints()) +
             " were read");
  if (promise.faces >= 0 && data->GetNumberOfPolys() + data->GetNumberOfStrips() != promise.faces)
    fail(file, "faces",
         "the file promises " + std::to_string(promise.faces) + ", " + std::to_string(data->GetNumberOfPolys()) + " were read");
  return toTriangles(file, data);
}

}  // namespace glint
