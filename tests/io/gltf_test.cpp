// SPDX-License-Identifier: BSD-3-Clause
// glTF 2.0: every expected number is computed by hand from the specification.
#include <gmock/gmock.h>

#include <cmath>

#include "core/base/bytes.h"
#include "io/mesh_reader.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/io/allocation_meter.h"
#include "tests/io/mesh_texts.h"

namespace glint::gltf_tests {
namespace {
using namespace testing_support;
using Eigen::Vector3d;
using Eigen::Vector3i;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kByte = 5120, kUbyte = 5121, kShort = 5122, kUshort = 5123, kUint = 5125, kFloat = 5126;

template <class T>
std::string bytesOf(const std::vector<double>& values) {
  std::string bytes;
  for (const double v : values) put(bytes, static_cast<T>(v));
  return bytes;
}

/// A glTF file in the making: one buffer, and what lies in it.
class GltfSample {
 public:
  /// A buffer view of these bytes; its number.
  int view(const std::string& content, const std::string& more = "") {
    views_.push_back(R"({"buffer":0,"byteOffset":)" + std::to_string(bytes_.size()) + R"(,"byteLength":)" +
                     std::to_string(content.size()) + more + "}");
    bytes_ += content;
    return int(views_.size()) - 1;
  }
  int accessor(int componentType, std::size_t count, const std::string& type, const std::string& more) {
    accessors_.push_back(R"({"componentType":)" + std::to_string(componentType) + R"(,"count":)" + std::to_string(count) +
                         R"(,"type":")" + type + "\"" + more + "}");
    return int(accessors_.size()) - 1;
  }
  int vectors(const std::vector<double>& values) {
    return accessor(kFloat, values.size() / 3, "VEC3", R"(,"bufferView":)" + std::to_string(view(bytesOf<float>(values))));
  }
  template <class T>
  int indices(int componentType, const std::vector<double>& values) {
    return accessor(componentType, values.size(), "SCALAR", R"(,"bufferView":)" + std::to_string(view(bytesOf<T>(values))));
  }
  /// @param rest  members behind the accessors: "meshes" and others
  std::string text(const std::string& rest) const {
    return document(R"("uri":"data:;base64,)" + base64({bytes_.begin(), bytes_.end()}) + "\",", rest);
  }
  std::string glb(const std::string& rest) const { return glbOf(document("", rest), bytes_); }
  std::string document(const std::string& uri, const std::string& rest) const {
    return R"({"asset":{"version":"2.0"},"buffers":[{)" + uri + R"("byteLength":)" + std::to_string(bytes_.size()) +
           R"(}],"bufferViews":[)" + joined(views_) + R"(],"accessors":[)" + joined(accessors_) + "]," + rest + "}";
  }
  const std::string& bytes() const { return bytes_; }

 private:
  static std::string joined(const std::vector<std::string>& all) {
    std::string out;
    for (const std::string& one : all) out += (out.empty() ? "" : ",") + one;
    return out;
  }
  std::string bytes_;
  std::vector<std::string> views_, accessors_;
};

MeshContent parsed(const std::string& bytes, const std::filesystem::path& file = "m.gltf") {
  MeshContent mesh = parseMesh(bytes, file);
  EXPECT_EQ(brokenPromise(mesh), "");
  return mesh;
}

std::string refusal(const std::string& bytes, const std::filesystem::path& file = "m.gltf") {
  return inputErrorOf([&] { parseMesh(bytes, file); });
}

const std::vector<double> kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};

/// A triangle as mesh 0, with these nodes and scenes.
std::string triangleAt(const std::string& rest) {
  GltfSample sample;
  sample.vectors(kTriangle);
  return sample.text(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}])" + rest);
}

/// The triangle (1,1,1), (2,1,1), (1,2,1), with the normals (1,1,0) / sqrt 2, at a node.
MeshContent placed(const std::string& node, const std::string& more = "") {
  GltfSample sample;
  sample.vectors({1, 1, 1, 2, 1, 1, 1, 2, 1});
  const double h = std::sqrt(0.5);
  sample.vectors({h, h, 0, h, h, 0, h, h, 0});
  return parsed(sample.text(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1}}]}],"nodes":[{"mesh":0)" + node +
                            "}" + more + "]"));
}

void expectNear(const Vector3d& value, const Vector3d& expected, double tolerance = 1e-14) {
  EXPECT_LE((value - expected).norm(), tolerance) << value.transpose() << " is not " << expected.transpose();
}

// The test vectors of RFC 4648, section 10.
TEST(Base64, TextToBytes) {
  const std::pair<const char*, const char*> known[] = {{"", ""},
                                                       {"Zg==", "f"},
                                                       {"Zm8=", "fo"},
                                                       {"Zm9v", "foo"},
                                                       {"Zm9vYg==", "foob"},
                                                       {"Zm9vYmE=", "fooba"},
                                                       {"Zm9vYmFy", "foobar"}};
  for (const auto& [text, bytes] : known) EXPECT_EQ(fromBase64(text), bytes);
  EXPECT_EQ(fromBase64("Zm8"), "fo");  // without padding
  EXPECT_EQ(fromBase64("+/+/"), "\xfb\xff\xbf");
  for (const char* bad : {"Z", "Zm9vY", "Zm9 v", "Zg==Zg==", "Zm=v", "====", "Zm9-", "Zm9vYg=", "Zm9v\n"})
    EXPECT_EQ(fromBase64(bad), std::nullopt) << bad;
}

TEST(Gltf, IndicesOfEveryType) {
  std::vector<double> positions;
  for (int i = 0; i < 70000; ++i) positions.insert(positions.end(), {double(i), 0, 0});
  // Beyond the largest number of the signed type in each case, and of the next smaller one.
  for (const auto& [type, last] : {std::pair{kUbyte, 200}, {kUshort, 40000}, {kUint, 69999}}) {
    GltfSample sample;
    sample.vectors(positions);
    const std::vector<double> corners = {double(last), 0, 1};
    if (type == kUbyte) sample.indices<std::uint8_t>(type, corners);
    if (type == kUshort) sample.indices<std::uint16_t>(type, corners);
    if (type == kUint) sample.indices<std::uint32_t>(type, corners);
    const MeshContent mesh = parsed(sample.glb(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}])"));
    EXPECT_THAT(mesh.triangles, ElementsAre(Vector3i(last, 0, 1)));
    EXPECT_EQ(mesh.vertices.back(), Vector3d(69999, 0, 0));
    EXPECT_TRUE(mesh.normals.empty());
  }
}

TEST(Gltf, TrianglesStripsAndFans) {
  const auto triangles = [](int mode, const std::vector<double>& indices, int points = 6) {
    GltfSample sample;
    std::vector<double> positions;
    for (int i = 0; i < points; ++i) positions.insert(positions.end(), {double(i), double(i) * i, 0});
    sample.vectors(positions);
    if (!indices.empty()) sample.indices<std::uint8_t>(kUbyte, indices);
    return parsed(sample.text(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":)" + std::to_string(mode) +
                              (indices.empty() ? "" : R"(,"indices":1)") + "}]}]"))
        .triangles;
  };
  EXPECT_THAT(triangles(4, {}), ElementsAre(Vector3i(0, 1, 2), Vector3i(3, 4, 5)));
  EXPECT_THAT(triangles(4, {5, 4, 0}), ElementsAre(Vector3i(5, 4, 0)));
  EXPECT_THAT(triangles(5, {}, 5), ElementsAre(Vector3i(0, 1, 2), Vector3i(1, 3, 2), Vector3i(2, 3, 4)));
  EXPECT_THAT(triangles(5, {5, 0, 4, 1}), ElementsAre(Vector3i(5, 0, 4), Vector3i(0, 1, 4)));
  // Two strips in one: triangles without area join them.
  EXPECT_THAT(triangles(5, {0, 1, 2, 2, 3, 3, 4, 5}), ElementsAre(Vector3i(0, 1, 2), Vector3i(3, 5, 4)));
  EXPECT_THAT(triangles(6, {}, 5), ElementsAre(Vector3i(0, 1, 2), Vector3i(0, 2, 3), Vector3i(0, 3, 4)));
  EXPECT_THAT(triangles(6, {3, 5, 1, 0}), ElementsAre(Vector3i(3, 5, 1), Vector3i(3, 1, 0)));
}

TEST(Gltf, OffsetsAndStrides) {
  GltfSample sample;
  sample.view("four");
  // Rows of 20 bytes: eight that belong to something else, then a position.
  std::string rows;
  for (int i = 0; i < 3; ++i) rows += bytesOf<float>({-9, -9, 0.5 + i, 10.0 * i, i == 1 ? 0.25 : 7});
  const int view = sample.view(rows, R"(,"byteStride":20)");
  sample.accessor(kFloat, 3, "VEC3", R"(,"byteOffset":8,"bufferView":)" + std::to_string(view));
  const MeshContent mesh = parsed(sample.text(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}])"));
  EXPECT_THAT(mesh.vertices, ElementsAre(Vector3d(0.5, 0, 7), Vector3d(1.5, 10, 0.25), Vector3d(2.5, 20, 7)));
}

TEST(Gltf, SparseElementsStandInPlaceOfOthers) {
  GltfSample sample;
  sample.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5});
  const std::string numbers = std::to_string(sample.view(bytesOf<std::uint16_t>({1, 3}))),
                    values = std::to_string(sample.view(bytesOf<float>({7, 8, 9, -1, -2, -3})));
  const std::string sparse = R"(,"sparse":{"count":2,"indices":{"componentType":5123,"bufferView":)" + numbers +
                             R"(},"values":{"bufferView":)" + values + "}}";
  sample.accessor(kFloat, 4, "VEC3", R"(,"bufferView":0)" + sparse);
  sample.accessor(kFloat, 4, "VEC3", sparse);  // of zeros
  sample.indices<std::uint8_t>(kUbyte, {0, 1, 2});
  const auto positions = [&](const std::string& primitives) {
    return parsed(sample.text(R"("meshes":[{"primitives":[)" + primitives + "]}]")).vertices;
  };
  const std::string replaced = R"({"attributes":{"POSITION":1},"indices":3})",
                    ofZeros = R"({"attributes":{"POSITION":2},"indices":3})";
  EXPECT_THAT(positions(replaced), ElementsAre(Vector3d(0, 0, 0), Vector3d(7, 8, 9), Vector3d(0, 1, 0), Vector3d(-1, -2, -3)));
  const std::vector<Vector3d> both = positions(replaced + "," + ofZeros);
  ASSERT_EQ(both.size(), 8u);
  EXPECT_EQ(both[1], Vector3d(7, 8, 9));
  EXPECT_EQ(both[2], Vector3d(0, 1, 0));
  EXPECT_THAT(std::vector(both.begin() + 4, both.end()),
              ElementsAre(Vector3d(0, 0, 0), Vector3d(7, 8, 9), Vector3d(0, 0, 0), Vector3d(-1, -2, -3)));
}

TEST(Gltf, QuantizedPositionsAndNormals) {
  GltfSample sample;
  // KHR_mesh_quantization: rows of four-byte multiples. Normalised: 32767 is 1, and so is -32768 of -1.
  const int positions =
      sample.view(bytesOf<std::int16_t>({32767, 0, -32768, 0, -32767, 16384, 1, 0, 0, 0, 0, 0}), R"(,"byteStride":8)");
  const int normals = sample.view(bytesOf<std::int8_t>({127, 0, 0, 0, 0, -128, 0, 0, 0, 127, 127, 0}), R"(,"byteStride":4)");
  const int plain = sample.view(bytesOf<std::uint8_t>({255, 0, 3, 0, 200, 1, 0, 0, 0, 0, 0, 0}), R"(,"byteStride":4)");
  const auto inView = [](int view) { return R"(,"bufferView":)" + std::to_string(view); };
  sample.accessor(kShort, 3, "VEC3", R"(,"normalized":true)" + inView(positions));
  sample.accessor(kByte, 3, "VEC3", R"(,"normalized":true)" + inView(normals));
  sample.accessor(kUbyte, 3, "VEC3", inView(plain));
  const std::string needed = R"("extensionsRequired":["KHR_mesh_quantization"],)";
  const MeshContent mesh =
      parsed(sample.text(needed + R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1}}]}])"));
  EXPECT_EQ(mesh.vertices[0], Vector3d(1, 0, -1));
  expectNear(mesh.vertices[1], Vector3d(-1, 16384 / 32767.0, 1 / 32767.0));
  ASSERT_EQ(mesh.normals.size(), 3u);
  expectNear(mesh.normals[1], Vector3d(0, -1, 0));
  expectNear(mesh.normals[2], Vector3d(0, std::sqrt(0.5), std::sqrt(0.5)));
  EXPECT_EQ(parsed(sample.text(needed + R"("meshes":[{"primitives":[{"attributes":{"POSITION":2}}]}])")).vertices[1],
            Vector3d(200, 1, 0));
}

TEST(Gltf, NodesMoveTurnAndStretch) {
  // (1,1,1) stretched to (2,3,4), turned by 90 degrees about z to (-3,2,4), moved to (7,22,34); (2,1,1) to (4,3,4), (-3,4,4).
  for (const char* node :
       {R"(,"translation":[10,20,30],"rotation":[0,0,0.70710678118654752,0.70710678118654752],"scale":[2,3,4])",
        R"(,"matrix":[0,2,0,0, -3,0,0,0, 0,0,4,0, 10,20,30,1])"}) {
    const MeshContent mesh = placed(node);
    expectNear(mesh.vertices[0], Vector3d(7, 22, 34));
    expectNear(mesh.vertices[1], Vector3d(7, 24, 34));
    EXPECT_THAT(mesh.triangles, ElementsAre(Vector3i(0, 1, 2)));
    // The normal (1,1,0): by the inverse of the scale to (1/2,1/3,0), turned to (-1/3,1/2,0).
    expectNear(mesh.normals[0], Vector3d(-2, 3, 0) / std::sqrt(13.0));
  }
  // A quaternion of length 2 is the same turn.
  expectNear(placed(R"(,"rotation":[0,0,2,2])").vertices[1], Vector3d(-1, 2, 1));
  // The parent's scale comes last: 2 * ((1,1,1) + (1,0,0)).
  expectNear(placed(R"(,"translation":[1,0,0])", R"(,{"children":[0],"scale":[2,2,2]})").vertices[0], Vector3d(4, 2, 2));
}

TEST(Gltf, NormalsStayAtRightAnglesAndOfLength1) {
  expectNear(placed(R"(,"scale":[2,1,1])").normals[0], Vector3d(1, 2, 0) / std::sqrt(5.0));
  // Shear x += y: the inverse transpose takes (1,1,0) to (1,0,0).
  expectNear(placed(R"(,"matrix":[1,0,0,0, 1,1,0,0, 0,0,1,0, 0,0,0,1])").normals[0], Vector3d(1, 0, 0));
  for (const char* tiny : {"1e-5", "1e-12", "1e5"}) {  // a file in other units has normals as well
    const MeshContent mesh = placed(R"(,"scale":[)" + std::string(tiny) + "," + tiny + "," + tiny + "]");
    ASSERT_EQ(mesh.normals.size(), 3u) << tiny;
    expectNear(mesh.normals[0], Vector3d(1, 1, 0) / std::sqrt(2.0), 1e-7);
  }
  // Much thinner than wide: (1,1,0) goes to (1,1e7,0).
  const MeshContent thin = placed(R"(,"scale":[1,1e-7,1e-7])");
  ASSERT_EQ(thin.normals.size(), 3u);
  expectNear(thin.normals[0], Vector3d(1e-7, 1, 0));
  // Flat: what lies in the plane has no normal any more.
  EXPECT_TRUE(placed(R"(,"scale":[1,1,0])").normals.empty());
  EXPECT_EQ(placed(R"(,"scale":[0,1,1])").normals[0], Vector3d(1, 0, 0));
  EXPECT_TRUE(placed(R"(,"scale":[0,0,0])").normals.empty());
}

TEST(Gltf, AMirroredMeshKeepsItsOuterSideOutside) {
  const MeshContent once = placed(R"(,"scale":[-1,1,1])");
  EXPECT_EQ(once.vertices[1], Vector3d(-2, 1, 1));
  EXPECT_THAT(once.triangles, ElementsAre(Vector3i(0, 2, 1)));
  expectNear(once.normals[0], Vector3d(-1, 1, 0) / std::sqrt(2.0), 1e-7);
  const MeshContent small = placed(R"(,"scale":[1e-120,1e-120,-1e-120])");  // whose determinant is no double
  EXPECT_THAT(small.triangles, ElementsAre(Vector3i(0, 2, 1)));
  const MeshContent twice = placed(R"(,"scale":[-1,1,1])", R"(,{"children":[0],"scale":[1,-1,1]})");
  EXPECT_THAT(twice.triangles, ElementsAre(Vector3i(0, 1, 2)));
  expectNear(twice.normals[0], Vector3d(-1, -1, 0) / std::sqrt(2.0), 1e-7);
}

TEST(Gltf, TheDefaultSceneIsRead) {
  const auto xs = [](const std::string& rest) {
    std::vector<double> all;
    const MeshContent mesh = parsed(triangleAt(rest));
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 3) all.push_back(mesh.vertices[i].x());
    EXPECT_EQ(mesh.triangles.size(), mesh.vertices.size() / 3);
    return all;
  };
  const std::string nodes = R"(,"nodes":[{"mesh":0,"translation":[10,0,0]},{"mesh":0,"translation":[20,0,0]},{"children":[1,3]})"
                            R"(,{"mesh":0,"translation":[30,0,0]},{"camera":0}])";
  EXPECT_THAT(xs(nodes + R"(,"scenes":[{"nodes":[0]},{"nodes":[4,2]}],"scene":1)"), ElementsAre(20, 30));
  EXPECT_THAT(xs(nodes + R"(,"scenes":[{"nodes":[0]},{"nodes":[2]}])"), ElementsAre(10));
  EXPECT_THAT(xs(nodes), ElementsAre(10, 20, 30));
  EXPECT_THAT(xs(""), ElementsAre(0));
  EXPECT_THAT(refusal(triangleAt(nodes + R"(,"scenes":[{}])")), HasSubstr("m.gltf: the mesh has no faces"));
}

TEST(Gltf, PrimitivesWithTheSamePositionsShareTheirVertices) {
  GltfSample sample;
  sample.vectors({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  sample.vectors({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  sample.vectors({0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1});
  sample.indices<std::uint8_t>(kUbyte, {0, 1, 2});
  sample.indices<std::uint8_t>(kUbyte, {1, 3, 2});
  const auto primitives = [&](const std::string& first, const std::string& second) {
    return parsed(sample.text(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0)" + first +
                              R"(},"indices":3},{"attributes":{"POSITION":0)" + second + R"(},"indices":4}]}])"));
  };
  const MeshContent one = primitives("", "");
  EXPECT_EQ(one.vertices.size(), 4u);
  EXPECT_THAT(one.triangles, ElementsAre(Vector3i(0, 1, 2), Vector3i(1, 3, 2)));
  EXPECT_EQ(primitives(R"(,"NORMAL":1)", R"(,"NORMAL":1)").normals.size(), 4u);
  const MeshContent crease = primitives(R"(,"NORMAL":1)", R"(,"NORMAL":2)");
  EXPECT_EQ(crease.vertices.size(), 8u);
  EXPECT_THAT(crease.triangles, ElementsAre(Vector3i(0, 1, 2), Vector3i(5, 7, 6)));
  EXPECT_EQ(crease.normals[5], Vector3d(0, 0, -1));
  // A primitive without normals costs its own vertices theirs, and no other's.
  const MeshContent first = primitives(R"(,"NORMAL":1)", ""), second = primitives("", R"(,"NORMAL":1)");
  ASSERT_EQ(first.normals.size(), 8u);
  ASSERT_EQ(second.normals.size(), 8u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(first.normals[i], Vector3d(0, 0, 1));
    EXPECT_EQ(first.normals[4 + i], Vector3d(0, 0, 0));
    EXPECT_EQ(second.normals[i], Vector3d(0, 0, 0));
    EXPECT_EQ(second.normals[4 + i], Vector3d(0, 0, 1));
  }
}

TEST(Gltf, PointsAndLinesAreSkipped) {
  const auto with = [](const std::string& more) {
    GltfSample sample;
    sample.vectors(kTriangle);
    return sample.text(R"("meshes":[{"primitives":[)" + more +
                       R"({"attributes":{"POSITION":0},"mode":0},{"attributes":{"POSITION":0},"mode":3},{"attributes":{}}]}])");
  };
  EXPECT_EQ(parsed(with(R"({"attributes":{"POSITION":0}},)")).vertices.size(), 3u);
  EXPECT_THAT(refusal(with("")), HasSubstr("m.gltf: the mesh has no faces"));
}

TEST(Gltf, BuffersLieInTheFolderOfTheFile) {
  const TemporaryFolder folder;
  GltfSample sample;
  sample.vectors(kTriangle);
  const std::string mesh = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}])";
  const auto naming = [&](const std::string& uri) { return sample.document(R"("uri":")" + uri + "\",", mesh); };
  folder.write("in/a.bin", sample.bytes());
  folder.write("in/parts/a b%.bin", sample.bytes() + "more");
  folder.write("in/short.bin", sample.bytes().substr(1));
  folder.write("out.bin", sample.bytes());
  std::filesystem::create_symlink("../out.bin", folder / "in/link.bin");
  std::filesystem::create_directory(folder / "in/folder.bin");
  for (const char* uri : {"a.bin", "./a.bin", "parts/a%20b%.bin", "parts/../%61.bin"})
    EXPECT_EQ(readMeshContent(folder.write("in/m.gltf", naming(uri))).vertices[1], Vector3d(1, 0, 0)) << uri;
  for (const auto& [uri, reason] : std::vector<std::pair<std::string, std::string>>{
           {"../out.bin", "'../out.bin' does not lie in the folder"},
           {"%2e%2e/out.bin", "does not lie in the folder"},
           {(folder / "in/a.bin").string(), "does not lie in the folder"},
           {"link.bin", "does not lie in the folder"},
           {"../in/a.bin/../../out.bin", "does not lie in the folder"},
           {"file:///etc/passwd", "'file:///etc/passwd' is not a file beside this one"},
           {"https://example.org/a.bin", "is not a file beside this one"},
           {"", "the path is empty"},
           {"none.bin", "'none.bin': cannot be read"},
           {"folder.bin", "'folder.bin': is a folder"},
           {"data:text/plain,abc", "only those in base64"},
           {"data:base64", "only those in base64"},
           {"data:;base64,A*==", "is not valid base64"}}) {
    const std::string message = inputErrorOf([&, uri = uri] { readMeshContent(folder.write("in/m.gltf", naming(uri))); });
    EXPECT_THAT(message, HasSubstr("m.gltf: buffers[0].uri: ")) << uri;
    EXPECT_THAT(message, HasSubstr(reason));
  }
  EXPECT_THAT(inputErrorOf([&] { readMeshContent(folder.write("in/m.gltf", naming("short.bin"))); }),
              HasSubstr("m.gltf: buffers[0].byteLength: is 36; there are 35 bytes"));
  // What no triangle needs is not looked for.
  const std::string pictures =
      with(naming("a.bin"), "}],\"bufferViews\"", R"(},{"uri":"none.bin","byteLength":9}],"bufferViews")");
  EXPECT_EQ(readMeshContent(folder.write("in/m.gltf", pictures)).triangles.size(), 1u);
  // A container may name files, too.
  EXPECT_EQ(readMeshContent(folder.write("in/m.glb", glbOf(naming("a.bin"), ""))).triangles.size(), 1u);
}

TEST(Gltf, ContainersAndTextAsOtherProgramsWriteThem) {
  const std::string good = glb();
  EXPECT_EQ(parsed(good + std::string(2, '\0')).vertices.size(), 4u);
  const std::string json = gltfDocument("");
  for (const char pad : {' ', '\0'}) {
    const std::string text = json + std::string(8 - json.size() % 4, pad);
    EXPECT_EQ(parsed(glbOf(text, good.substr(good.size() - 60))).vertices.size(), 4u) << int(pad);
  }
  // A chunk of an extension at the end.
  std::string more = good;
  put(more, std::uint32_t(4));
  more += "xxxxyyyy";
  std::string length;
  put(length, std::uint32_t(more.size()));
  EXPECT_EQ(parsed(more.replace(8, 4, length)).vertices.size(), 4u);
  EXPECT_EQ(parsed("\xef\xbb\xbf\n " + gltfText(), "renamed.stl").vertices.size(), 4u);
  EXPECT_EQ(parsed(with(gltfText(), "\"version\"", R"("generator": "solid v 1", "version")")).vertices.size(), 4u);
  // Looks, light and motion may be required: they leave the shape alone.
  EXPECT_EQ(parsed(with(gltfText(), "{ \"asset\"",
                        R"({ "extensionsRequired": ["KHR_materials_clearcoat", "KHR_texture_transform"], "asset")"))
                .vertices.size(),
            4u);
  EXPECT_EQ(parsed(with(gltfText(), "\"mesh\": 0", R"("mesh": 0, "weights": [0, 0])")).vertices.size(), 4u);
}

/// Nodes that nest deeper than any stack, each a step further.
TEST(Gltf, NestedNodesTakeNoStack) {
  constexpr int kNodes = 200000;
  std::string nodes = R"(,"nodes":[)";
  for (int i = 0; i < kNodes; ++i) nodes += R"({"translation":[0,0,1],"children":[)" + std::to_string(i + 1) + "]},";
  EXPECT_EQ(parsed(triangleAt(nodes + R"({"mesh":0}])")).vertices[1], Vector3d(1, 0, kNodes));
}

/// What is wrong, and where.
TEST(Gltf, DamageIsNamedWithItsPlace) {
  const std::string text = gltfText();
  const auto changed = [&](const std::string& from, const std::string& to) { return with(text, from, to); };
  const auto nodes = [&](const std::string& list) { return triangleAt(R"(,"nodes":[)" + list + "]"); };
  GltfSample far;
  far.vectors({0, 0, 0, 1, 0, 0, 0, 1e31, 0});
  GltfSample nan;
  nan.vectors({0, 0, 0, 1, NAN, 0, 0, 1, 0});
  const std::string mesh = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}])";
  struct Case {
    std::string bytes, expected;
  };
  const Case cases[] = {
      {changed("\"count\": 4", "\"count\": 5"), "m.gltf: accessors[0].count: is 5; the buffer view has room for 4"},
      {changed("\"count\": 4", "\"count\": 4000000000"), "accessors[0].count: is 4000000000; the buffer view has room for 4"},
      {changed("\"count\": 4", "\"count\": 9007199254740992"), "accessors[0].count: is 9007199254740992; the buffer view has"},
      {changed("\"count\": 4", "\"count\": 1e300"), "accessors[0].count: must be a whole number"},
      {changed("\"count\": 4", "\"count\": -4"), "accessors[0].count: must be a whole number"},
      {changed("\"count\": 4", "\"count\": 3.5"), "accessors[0].count: must be a whole number"},
      {changed("\"count\": 4", "\"count\": 0"), "accessors[0].count: must be 1 or more"},
      {changed("\"count\": 4,", ""), "accessors[0].count: is missing"},
      {with(changed("{ \"bufferView\": 0,", "{"), "\"count\": 4", "\"count\": 40000"),
       "accessors[0].count: is 40000, without a bufferView"},
      {changed("\"count\": 6", "\"count\": 5"), "meshes[0].primitives[0].indices: 5 corners do not make whole triangles"},
      {changed("\"componentType\": 5126", "\"componentType\": 5130"), "accessors[0].componentType: 5130 is not a component type"},
      {changed("\"componentType\": 5123", "\"componentType\": 5126"), "accessors[1].componentType: 5126 is not a component type"},
      {changed("\"VEC3\"", "\"VEC4\""), "accessors[0].type: must be VEC3 for meshes[0].primitives[0].attributes.POSITION"},
      {changed("\"componentType\": 5126,", "\"componentType\": 5126, \"byteOffset\": 12,"),
       "accessors[0].count: is 4; the buffer view has room for 3"},
      {changed("\"componentType\": 5126,", "\"componentType\": 5126, \"byteOffset\": 49,"),
       "accessors[0].byteOffset: lies behind the end"},
      {changed("\"byteLength\": 48", "\"byteLength\": 48, \"byteStride\": 16"),
       "accessors[0].count: is 4; the buffer view has room for 3"},
      {changed("\"byteLength\": 48", "\"byteLength\": 48, \"byteStride\": 9007199254740992"),
       "accessors[0].count: is 4; the buffer view has room for 1"},
      {changed("\"byteLength\": 48", "\"byteLength\": 48, \"byteStride\": 8"),
       "bufferViews[0].byteStride: is less than the 12 bytes"},
      {changed("\"byteLength\": 48", "\"byteLength\": 48, \"byteStride\": 0"),
       "bufferViews[0].byteStride: is less than the 12 bytes"},
      {changed("\"byteLength\": 48", "\"byteLength\": 61"), "bufferViews[0].byteLength: is 61; its buffer has 60 bytes there"},
      {changed("\"byteOffset\": 48", "\"byteOffset\": 61"),
       "bufferViews[1].byteOffset: lies behind the end of its buffer of 60 bytes"},
      {changed("\"byteOffset\": 48", "\"byteOffset\": 49"), "bufferViews[1].byteLength: is 12; its buffer has 11 bytes there"},
      {changed("\"byteLength\": 60", "\"byteLength\": 64"), "buffers[0].byteLength: is 64; there are 60 bytes"},
      {changed("\"bufferView\": 1", "\"bufferView\": 2"), "accessors[1].bufferView: names number 2 of bufferViews, which has 2"},
      {changed("\"POSITION\": 0", "\"POSITION\": 7"),
       "primitives[0].attributes.POSITION: names number 7 of accessors, which has 2"},
      {changed("\"mesh\": 0", "\"mesh\": 1"), "nodes[0].mesh: names number 1 of meshes"},
      {changed("\"scene\": 0", "\"scene\": 1"), "scene: names number 1 of scenes"},
      {changed("[ 0 ]", "[ 1 ]"), "scenes[0].nodes[0]: names number 1 of nodes"},
      {changed("\"uri\"", "\"url\""), "buffers[0]: has no bytes"},
      {changed("\"indices\": 1", "\"indices\": 1, \"mode\": 7"), "primitives[0].mode: 7 is not a mode"},
      {changed("AAAAAAABAAIAAAACAAMA", "AAAAAAABAAIAAAAEAAMA"),
       "accessors[1], element 4: names vertex 4; meshes[0].primitives[0] has 4"},
      {changed("\"POSITION\": 0", "\"POSITION\": 0, \"NORMAL\": 1"),
       "accessors[1].type: must be VEC3 for meshes[0].primitives[0].attributes.NORMAL"},
      {changed("\"2.0\"", "\"1.0\""), "asset.version: glTF version '1.0'"},
      {changed("\"asset\": {", "\"asset\": ["), "line 1"},
      {far.text(mesh), "accessors[0], element 2: is farther than 1e30"},
      {nan.text(mesh), "accessors[0], element 1: is not finite"},
      {nodes(R"({"mesh":0,"scale":[1e31,1,1]})"), "nodes[0], accessors[0], element 1: in the world, it is farther"},
      {nodes(R"({"scale":[1e200,1,1],"children":[1]},{"scale":[1e200,1,1],"mesh":0})"),
       "nodes[1]: its place in the world is not finite"},
      {nodes(R"({"mesh":0,"rotation":[0,0,0,0]})"), "nodes[0].rotation: is a quaternion of length 0"},
      {nodes(R"({"mesh":0,"rotation":[0,0,1]})"), "nodes[0].rotation: must have 4 numbers, has 3"},
      {nodes(R"({"mesh":0,"matrix":[1,0,0,5, 0,1,0,0, 0,0,1,0, 0,0,0,1]})"), "nodes[0].matrix: its last row"},
      {nodes(R"({"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],"scale":[1,1,1]})"), "nodes[0].matrix: is beside"},
      {nodes(R"({"mesh":0,"children":[0]})"), "nodes[0]: is its own ancestor"},
      {nodes(R"({"mesh":0},{"children":[2]},{"children":[1]})"), "nodes[1]: is its own ancestor"},
      {nodes(R"({"children":[2]},{"children":[2]},{"mesh":0})"), "nodes[1].children[0]: names node 2 a second time"},
      {triangleAt(R"(,"nodes":[{"mesh":0,"children":[1]},{"children":[0]}],"scenes":[{"nodes":[0]}])"),
       "nodes[1].children[0]: names node 0 a second time"},
      {triangleAt(R"(,"nodes":[{"mesh":0}],"scenes":[{"nodes":[0,0]}])"), "scenes[0].nodes[1]: names node 0 a second time"},
      {nodes(R"({"mesh":0,"skin":0})"), "nodes[0].skin: the joints"},
      {nodes(R"({"mesh":0,"weights":[0,0.5]})"), "nodes[0].weights[1]: a morph target"},
      {triangleAt(R"(,"extensionsRequired":["KHR_materials_unlit","KHR_draco_mesh_compression"])"),
       "extensionsRequired[1]: the file needs the extension 'KHR_draco_mesh_compression', which is not supported"},
      {triangleAt(R"(,"extensionsRequired":["EXT_meshopt_compression"])"), "needs the extension 'EXT_meshopt_compression'"},
      {with(changed("{ \"bufferView\": 0,", "{"), "\"indices\": 1", R"("extensions": {"KHR_draco_mesh_compression": {}})"),
       "primitives[0].extensions.KHR_draco_mesh_compression: the file holds these positions with this extension alone"},
  };
  for (const Case& c : cases) EXPECT_THAT(refusal(c.bytes), HasSubstr(c.expected));
}

TEST(Gltf, DamagedSparseElements) {
  const auto message = [](const std::vector<double>& numbers, int count) {
    GltfSample sample;
    sample.vectors(kTriangle);
    sample.view(bytesOf<std::uint8_t>(numbers));
    sample.view(bytesOf<float>({7, 8, 9, -1, -2, -3}));
    sample.accessor(kFloat, 3, "VEC3",
                    R"(,"bufferView":0,"sparse":{"count":)" + std::to_string(count) +
                        R"(,"indices":{"componentType":5121,"bufferView":1},"values":{"bufferView":2}})");
    return refusal(sample.text(R"("meshes":[{"primitives":[{"attributes":{"POSITION":1}}]}])"));
  };
  EXPECT_THAT(message({0, 3}, 2), HasSubstr("accessors[1].sparse.indices: number 1 names element 3; the accessor has 3"));
  EXPECT_THAT(message({1, 1}, 2), HasSubstr("accessors[1].sparse.indices: number 1 names element 1 after element 1"));
  EXPECT_THAT(message({0, 1, 2}, 3), HasSubstr("accessors[1].sparse.count: is 3; the buffer view has room for 2"));
  EXPECT_THAT(message({0}, 2), HasSubstr("accessors[1].sparse.count: is 2; the buffer view has room for 1"));
  EXPECT_THAT(message({0}, 4), HasSubstr("accessors[1].sparse.count: must be 1 to the 3 of the accessor"));
  EXPECT_THAT(message({0}, 0), HasSubstr("accessors[1].sparse.count: must be 1 to"));
}

TEST(Gltf, DamagedContainers) {
  const std::string good = glb();
  const auto number = [&](std::size_t at, std::uint32_t value) {
    std::string bytes = good, text;
    put(text, value);
    return bytes.replace(at, 4, text);
  };
  const std::string size = std::to_string(good.size());
  EXPECT_THAT(refusal(good.substr(0, 11)), HasSubstr("byte 11: the glTF is truncated: its header has 12 bytes"));
  EXPECT_THAT(refusal(number(4, 1)), HasSubstr("byte 4: glTF version 1; only 2 is supported"));
  EXPECT_THAT(refusal(number(8, 4000000000)),
              HasSubstr("byte " + size + ": the glTF is truncated: its header declares 4000000000"));
  EXPECT_THAT(refusal(number(8, 5)), HasSubstr("byte 8: declares a length of 5 bytes"));
  EXPECT_THAT(refusal(number(8, 12)), HasSubstr("unexpected data after"));
  EXPECT_THAT(refusal(good + "x"), HasSubstr("byte " + size + ": unexpected data after the bytes"));
  EXPECT_THAT(refusal(number(12, 0xffffffff)), HasSubstr("byte 12: the glTF is truncated: a chunk of 4294967295 bytes; "));
  EXPECT_THAT(refusal(number(16, 0x004E4942)), HasSubstr("byte 12: the first chunk of the glTF is not its JSON"));
  EXPECT_THAT(refusal(good.substr(0, 8) + std::string("\x0c\0\0\0", 4)), HasSubstr("byte 12: the glTF has no JSON text"));
  EXPECT_THAT(refusal(glbOf(gltfDocument(""), "")), HasSubstr("buffers[0].byteLength: is 60; there are 0 bytes"));
}

/// What a small file asks for is refused before memory is taken, and what it asks for again and again as well.
TEST(Gltf, MemoryStaysInProportion) {
  const auto largest = [](const std::string& bytes, const std::string& expected) {
    largestAllocation = 0;
    EXPECT_THAT(refusal(bytes), HasSubstr(expected));
    EXPECT_LT(largestAllocation, 100000 + 64 * bytes.size()) << expected;
  };
  for (const char* count : {"100000000", "2147483648", "4294967296", "768614336404564651"})
    largest(with(gltfText(), "\"count\": 4", std::string("\"count\": ") + count), "accessors[0].count: ");
  GltfSample sample;
  sample.vectors(std::vector<double>(30000, 1));
  std::string nodes, primitives;
  for (int i = 0; i < 2000; ++i) nodes += std::string(i ? "," : "") + R"({"mesh":0})";
  largest(sample.glb(R"("meshes":[{"primitives":[{"mode":5,"attributes":{"POSITION":0}}]}],"nodes":[)" + nodes + "]"),
          "]: its nodes repeat the file's meshes too often");
  for (int i = 0; i < 2000; ++i) primitives += std::string(i ? "," : "") + R"({"mode":5,"attributes":{"POSITION":0}})";
  largest(sample.glb(R"("meshes":[{"primitives":[)" + primitives + R"(]}],"nodes":[{"mesh":0},{"mesh":0},{"mesh":0}])"),
          "nodes[1]: its nodes repeat the file's meshes too often");
}

}  // namespace
}  // namespace glint::gltf_tests
