#include <g3r/io.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/las.h"
#include "io/lzf.h"
#include "io/strangers.h"
#include "io/text.h"
#include "io/text_numbers.h"
#include "io_samples.h"

namespace g3r {
namespace {

using samples::message_of;
using samples::read;
using Strings = std::vector<std::string>;

TEST(Text, NumbersAreReadFromTheFirstToTheLastCharacter) {
  double v = 0;
  EXPECT_TRUE(io::parse_double("+1.5e1", v));
  EXPECT_EQ(v, 15);
  EXPECT_TRUE(io::parse_double("-.5", v));
  EXPECT_TRUE(io::parse_double("-nan(ind)", v));
  EXPECT_TRUE(std::isnan(v));
  EXPECT_TRUE(io::parse_double("-1.#INF00", v));
  EXPECT_EQ(v, -std::numeric_limits<double>::infinity());
  for (const char* bad : {"", "+", "0x10", "1,5", "1.0D3", "1 ", "+-1", "1.#X", "hello"}) EXPECT_FALSE(io::parse_double(bad, v)) << bad;
}

TEST(Text, NumbersBeyondDoubleAreInfiniteOrZeroAndSaid) {
  double v = 0;
  bool overflow = false;
  EXPECT_TRUE(io::parse_double("-1e999", v, &overflow));
  EXPECT_EQ(v, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(overflow);
  EXPECT_TRUE(io::parse_double("1.e" + std::to_string(std::numeric_limits<long>::max()), v, &overflow));
  EXPECT_EQ(v, std::numeric_limits<double>::infinity());
  overflow = false;
  EXPECT_TRUE(io::parse_double("0.01e" + std::to_string(std::numeric_limits<long>::min()), v, &overflow));
  EXPECT_EQ(v, 0);
  EXPECT_TRUE(io::parse_double("1e-999", v, &overflow));
  EXPECT_EQ(v, 0);
  EXPECT_TRUE(io::parse_double("0." + std::string(400, '0') + "1", v, &overflow));
  EXPECT_EQ(v, 0);
  EXPECT_FALSE(overflow);
}

TEST(Text, NumbersAreWrittenAsShortAsTheyReadBack) {
  EXPECT_EQ(io::number_text(0.1), "0.1");
  EXPECT_EQ(io::number_text(0.1F), "0.1");
  EXPECT_EQ(io::number_text(static_cast<double>(0.1F)), "0.10000000149011612");
  EXPECT_EQ(io::number_text(1e300), "1e+300");
}

TEST(Strangers, AreKnownByTheirFirstBytes) {
  EXPECT_STREQ(io::find_stranger("PK\x03\x04 and more"), "a zip archive (compressed); unpack it first");
  EXPECT_STREQ(io::find_stranger("\xff\xfe"), "UTF-16 text; save it as UTF-8");
  for (const char* none : {"", "PK", "ply\n", "1 2 3\n"}) EXPECT_EQ(io::find_stranger(none), nullptr) << none;
}

TEST(Text, AllLineEndsAreLineEnds) {
  io::Lines lines("a\nb\r\nc\rd");
  std::string_view line;
  std::string seen;
  while (lines.next(line)) seen += std::string(line) + "|";
  EXPECT_EQ(seen, "a|b|c|d|");
  EXPECT_EQ(lines.number(), 4U);
  EXPECT_FALSE(lines.ended());
}

TEST(Text, ControlCharactersAreEscapedAndLettersAreNot) {
  EXPECT_EQ(escape_text("a\x1b[2J\n"), "a\\x1b[2J\\x0a");
  EXPECT_EQ(escape_text("z\xc3\xbcrich"), "z\xc3\xbcrich");
  EXPECT_EQ(escape_text("\xff"), "\\xff");
  EXPECT_EQ(escape_text("\xc2\x9b"), "\\xc2\\x9b");           // C1 CSI
  EXPECT_EQ(escape_text("\xe2\x80\xae"), "\\xe2\\x80\\xae");  // right-to-left override
}

TEST(Lzf, ExpandsToWhatWasCompressed) {
  std::string bytes;
  for (int i = 0; i < 20000; ++i) bytes += static_cast<char>(i * i / 700 % 11);
  bytes += std::string(1000, 'a');
  const std::string stream = io::lzf_compress(bytes);
  EXPECT_LT(stream.size(), bytes.size() / 2);
  ASSERT_EQ(io::lzf_size(stream), bytes.size());
  EXPECT_EQ(io::lzf_expand(stream, bytes.size()), bytes);
  EXPECT_EQ(io::lzf_size(io::lzf_compress("")), 0U);
  EXPECT_FALSE(io::lzf_size(std::string_view("\xe0\xff\xff", 3)));
}

TEST(Ply, BigEndianListsAndOtherElementsAreRead) {
  const Cloud cloud = read(samples::big_endian_ply(5));
  ASSERT_EQ(cloud.positions.size(), 5U);
  EXPECT_EQ(cloud.positions[4], (Vec3{4, 8, 0.4}));
  EXPECT_EQ(cloud.format, "ply binary_big_endian");
  EXPECT_EQ(cloud.scalar, Scalar::kFloat64);
  EXPECT_EQ(cloud.property_names, (std::vector<std::string>{"x", "seen", "y", "z"}));
}

TEST(Ply, FloatColoursMeanZeroToOne) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float red\nproperty float "
      "green\nproperty float blue\nend_header\n";
  EXPECT_EQ(read(head + "0 0 0 1 0.5 0\n").colors[0], (std::array<std::uint8_t, 3>{255, 128, 0}));
  EXPECT_EQ(read(head + "0 0 0 255 7 0\n").colors[0], (std::array<std::uint8_t, 3>{255, 7, 0}));
  EXPECT_EQ(read(head + "0 0 0 1.0001 0.5 0\n").colors[0], (std::array<std::uint8_t, 3>{255, 128, 0}));
}

TEST(Ply, WholeNumbersBeyondBytesAreColoursOf16Bits) {
  const std::string point = "property int x\nproperty int y\nproperty int z\n";
  for (const char* type : {"int", "uint", "ushort", "double"}) {
    std::string head = "ply\nformat ascii 1.0\nelement vertex 1\n" + point;
    for (const char* channel : {"red", "green", "blue"}) head += std::string("property ") + type + " " + channel + "\n";
    EXPECT_EQ(read(head + "end_header\n0 0 0 65535 257 0\n").colors[0], (std::array<std::uint8_t, 3>{255, 1, 0})) << type;
    EXPECT_EQ(read(head + "end_header\n0 0 0 255 7 0\n").colors[0], (std::array<std::uint8_t, 3>{255, 7, 0})) << type;
  }
}

TEST(Ply, NormalsHaveManyNames) {
  for (const char* name : {"n", "n_", "normal", "normal_"}) {
    std::string head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    for (const char* axis : {"x", "y", "z"}) head += std::string("property float ") + name + axis + "\n";
    EXPECT_EQ(read(head + "end_header\n1 2 3 0 0 1\n").normals, (std::vector<Vec3>{{0, 0, 1}})) << name;
  }
}

TEST(Ply, NormalsThatAreAllZeroAreNotOffered) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float "
      "ny\nproperty float nz\nend_header\n";
  const Cloud zero = read(head + "1 2 3 0 0 0\n");
  EXPECT_TRUE(zero.normals.empty());
  EXPECT_EQ(zero.warnings.size(), 1U);
  EXPECT_EQ(read(head + "1 2 3 0 0 2\n").normals[0], (Vec3{0, 0, 2}));
}

TEST(Ply, SplatsBelowTheOpacityAreLeftOut) {
  std::string file = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity"})
    file += std::string("property float ") + name + "\n";
  file += "end_header\n";
  for (int i = 0; i < 3; ++i) {
    for (const float v : {static_cast<float>(i), 0.F, 0.F, 0.F, 0.F, 0.F, 100.F, 0.F, -100.F, i == 1 ? -5.F : 5.F}) file += samples::raw(v);
  }
  const Cloud cloud = read(file);
  ASSERT_EQ(cloud.positions.size(), 2U);
  EXPECT_EQ(cloud.positions[1][0], 2);
  EXPECT_TRUE(cloud.normals.empty());
  EXPECT_EQ(cloud.colors[0], (std::array<std::uint8_t, 3>{255, 128, 0}));
  EXPECT_EQ(read_cloud_bytes(file.data(), file.size(), "splats", {.min_opacity = 0}).positions.size(), 3U);
  for (const double none : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW((void)read_cloud_bytes(file.data(), file.size(), "splats", {.min_opacity = none}), InvalidInput) << none;
}

TEST(Xyz, ColumnsAreDistinguishedByTheirValues) {
  const Cloud normals = read("0 0 0 0 0 1\n1 0 0 0 1 0\n");
  EXPECT_EQ(normals.normals[1], (Vec3{0, 1, 0}));
  const Cloud colors = read("0 0 0 200 100 0\n1 0 0 7 8 9\n");
  EXPECT_EQ(colors.colors[1], (std::array<std::uint8_t, 3>{7, 8, 9}));
  const Cloud all = read("0 0 0 0.5 10 20 30 0 0 1\n");
  EXPECT_EQ(all.property_names, (std::vector<std::string>{"x", "y", "z", "scalar_4", "red", "green", "blue", "nx", "ny", "nz"}));
}

TEST(Xyz, AHeaderNamesTheColumns) {
  const Cloud cloud = read("Intensity;Z;Y;X\n9;3;2;1\n");
  EXPECT_EQ(cloud.positions[0], (Vec3{1, 2, 3}));
  EXPECT_EQ(cloud.format, "csv");
  EXPECT_EQ(read("//X Y Z Nx Ny Nz\n1 2 3 0 0 5\n").normals[0], (Vec3{0, 0, 5}));
}

TEST(Xyz, SurveyorsNamesAreAxes) {
  const Cloud cloud = read("id,Easting (m),Northing (m),Height (m)\n7,1,2,3\n");
  EXPECT_EQ(cloud.positions[0], (Vec3{1, 2, 3}));
  EXPECT_EQ(cloud.property_names, (std::vector<std::string>{"id", "x", "y", "z"}));
  EXPECT_TRUE(cloud.warnings.empty());
  EXPECT_EQ(read("x y height z\n1 2 9 3\n").positions[0], (Vec3{1, 2, 3}));  // z is named: a height is a height
}

TEST(Xyz, AHeaderWithoutAxesIsSaid) {
  const Cloud cloud = read("lon;lat;alti;time;time\n1;2;3;4;5\n");
  EXPECT_EQ(cloud.positions[0], (Vec3{1, 2, 3}));
  EXPECT_EQ(cloud.property_names, (std::vector<std::string>{"x", "y", "z", "time", "time_2"}));
  ASSERT_EQ(cloud.warnings.size(), 1U);
  EXPECT_NE(cloud.warnings[0].find("\"lon\", \"lat\" and \"alti\" are taken for them"), std::string::npos);
}

TEST(Xyz, ColoursOf16BitsAreScaled) {
  EXPECT_EQ(read("x y z red green blue\n0 0 0 65535 257 0\n").colors[0], (std::array<std::uint8_t, 3>{255, 1, 0}));
}

TEST(Xyz, TheErrorNamesFileLineAndFind) {
  const std::string message = message_of("0 0 0\n1 1 1\n0,5 0,25 0,1\n", "a\nb.xyz");
  EXPECT_EQ(message, "a\\x0ab.xyz: line 3: expected a number, found \"0,5\" in column 1 (a decimal comma? write numbers with a point)");
  const std::string quoted = message_of("x,y,z\n\"0,5\",\"0,25\",\"0,1\"\n", "a.csv");
  EXPECT_EQ(quoted, "a.csv: line 2: expected a number, found \"0,5\" in column 1 \"x\" (a decimal comma? write numbers with a point)");
  EXPECT_NE(message_of("3\n0 0 0\n1 1 1\n").find("expected 3 points"), std::string::npos);
}

TEST(Obj, NormalsPerPointAreKeptAndPerCornerDropped) {
  const std::string points = "v 1 2 3\nv 4 5 6\nvn 0 0 1\nvn 0 1 0\n";
  EXPECT_EQ(read(points).normals[1], (Vec3{0, 1, 0}));
  EXPECT_TRUE(read(points + "f 1//2 2//1 1//2\n").normals.empty());
}

TEST(Pcd, TheViewpointIsTheScannerUnlessItIsTheDefault) {
  const auto sensors = [](const std::string& viewpoint) {
    return read("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nVIEWPOINT" + viewpoint +
                "\nPOINTS 1\nDATA ascii\n1 2 3\n")
        .sensor_positions;
  };
  EXPECT_EQ(sensors(" 1 -2.5 1e3 1 0 0 0"), (std::vector<Vec3>{{1, -2.5, 1000}}));
  EXPECT_EQ(sensors(" 0 0 0 0 1 0 0"), (std::vector<Vec3>{{0, 0, 0}}));
  for (const char* unknown : {" 0 0 0 1 0 0 0", " 0 0 0 1 0 0", "", " 1 2 nan 1 0 0 0", " a b c 1 0 0 0"}) {
    EXPECT_TRUE(sensors(unknown).empty()) << unknown;
  }
}

TEST(Pcd, CompressedIsReadColumnByColumn) {
  const Cloud cloud = read(samples::compressed_pcd(9));
  ASSERT_EQ(cloud.positions.size(), 9U);
  EXPECT_EQ(cloud.positions[5], (Vec3{1, 2, 3}));
}

TEST(Npy, ColoursAreNoNormals) {
  const Strings normals = {"x", "y", "z", "nx", "ny", "nz"};
  const Strings colors = {"x", "y", "z", "red", "green", "blue"};
  const Cloud bytes = read(samples::npy({{1, 2, 3, 200, 100, 0}, {4, 5, 6, 1, 0, 0}}));
  EXPECT_EQ(bytes.property_names, colors);
  EXPECT_EQ(bytes.colors[0], (std::array<std::uint8_t, 3>{200, 100, 0}));
  EXPECT_EQ(read(samples::npy({{1, 2, 3, 65535, 257, 0}})).colors[0], (std::array<std::uint8_t, 3>{255, 1, 0}));
  EXPECT_EQ(read(samples::npy({{1, 2, 3, 0, 1, 0}, {1, 2, 3, 0, 0, 1}})).property_names, normals);
  EXPECT_EQ(read(samples::npy({{1, 2, 3, 40, 1, -30}})).property_names, normals);
  EXPECT_EQ(read(samples::npy({{1, 2, 3, 70000, 0, 0}})).property_names, (Strings{"x", "y", "z", "scalar_4", "scalar_5", "scalar_6"}));
}

TEST(Npy, PaddingIsLeftOutAndTruthIsANumber) {
  const std::string padded =
      samples::npy_header("[('x', '<f4'), ('', '|V4'), ('y', '<f8'), ('z', '<f4'), ('kept', '|b1'), ('', '|V3')]", 2, "");
  const std::string row = samples::raw(1.0F) + "pad!" + samples::raw(2.0) + samples::raw(3.0F) + "\1" + "end";
  const Cloud cloud = read(padded + row + row);
  EXPECT_EQ(cloud.property_names, (Strings{"x", "y", "z", "kept"}));
  EXPECT_EQ(cloud.positions[1], (Vec3{1, 2, 3}));
  EXPECT_EQ(samples::value_of(cloud, "kept", 1), 1);
  const std::string big = samples::npy_header("[('c', '|u1'), ('x', '>f4'), ('y', '>f4'), ('z', '>f4')]", 1, "");
  EXPECT_EQ(read(big + "\7" + samples::raw(1.0F, true) + samples::raw(2.0F, true) + samples::raw(3.0F, true)).positions[0],
            (Vec3{1, 2, 3}));
  EXPECT_NE(message_of(samples::npy_header("[('x', '>f4'), ('y', '<f4')]", 1, "")).find("in one byte order"), std::string::npos);
  EXPECT_FALSE(message_of(samples::npy_header("[('x', '<f4'), ('name', '|S4')]", 1, "")).empty());
}

TEST(Gltf, OtherJsonIsNotCalledGltf) {
  EXPECT_NE(message_of(R"({"schema":"g3r.report"})").find("a JSON file that is no glTF"), std::string::npos);
  EXPECT_NE(message_of(R"({"asset":{"version":"2.0"}})").find("no mesh in this glTF file"), std::string::npos);
}

// The materials of a mesh may share its vertices.
TEST(Gltf, PrimitivesOfOneMeshMayShareTheirPositions) {
  std::string text = samples::text_gltf();
  const std::string primitive = R"({"attributes":{"POSITION":0}})";
  const std::size_t at = text.find(primitive);
  for (int k = 0; k < 12; ++k) text.insert(at, primitive + ",");
  EXPECT_EQ(read(text).positions, read(samples::text_gltf()).positions);
}

Mesh glb_mesh(const std::string& bytes) { return read_mesh_bytes(bytes.data(), bytes.size(), "a.glb"); }

TEST(Gltf, TrianglesAreReadAsAMesh) {
  const std::string positions = R"({"attributes":{"POSITION":0})";
  const Mesh expected = samples::tetrahedron();
  const std::size_t corners = expected.vertices.size();
  for (const char* indices : {R"(,"indices":1})", R"(,"indices":2,"mode":4})"}) {
    const Mesh mesh = glb_mesh(samples::triangles_glb(positions + indices, R"(,"translation":[10,0,0])"));
    EXPECT_EQ(mesh.triangles, expected.triangles) << indices;
    ASSERT_EQ(mesh.vertices.size(), corners) << indices;
    EXPECT_EQ(mesh.vertices[0][0], expected.vertices[0][0] + 10) << indices;
  }
  // Primitives share the vertices of one mesh, whose lines are no triangles.
  const std::string both = positions + R"(,"indices":1},)" + positions + R"(,"indices":2},)" + positions + R"(,"mode":1})";
  EXPECT_EQ(glb_mesh(samples::triangles_glb(both)).triangles.size(), 2 * expected.triangles.size());
  EXPECT_EQ(glb_mesh(samples::triangles_glb(both)).vertices.size(), corners);
  // Without indices three positions after one another are a triangle.
  std::string three = samples::triangles_glb(positions + "}");
  three.replace(three.find(R"("count":4)"), 9, R"("count":3)");
  EXPECT_EQ(glb_mesh(three).triangles, (decltype(expected.triangles){{0, 1, 2}}));
}

TEST(Gltf, TrianglesFaceOutwardInAMirrorToo) {
  const std::string primitive = R"({"attributes":{"POSITION":0},"indices":1})";
  const double volume = check_mesh(samples::tetrahedron()).volume;
  for (const char* node : {R"(,"scale":[-1,1,1])", R"(,"scale":[1,-1,1])", R"(,"matrix":[0,1,0,0,1,0,0,0,0,0,1,0,0,0,0,1])"}) {
    EXPECT_NEAR(check_mesh(glb_mesh(samples::triangles_glb(primitive, node))).volume, volume, 1e-9) << node;
  }
}

TEST(Gltf, TrianglesThatAreNoneAreRefused) {
  const auto refused = [](const std::string& text) {
    try {
      (void)glb_mesh(text);
    } catch (const NoFaces&) {
      return std::string("no faces");
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("read");
  };
  const auto primitive = [](const std::string& rest) { return samples::triangles_glb(R"({"attributes":{"POSITION":0})" + rest + "}"); };
  EXPECT_EQ(refused(primitive(R"(,"mode":0)")), "no faces");
  EXPECT_NE(refused(primitive(R"(,"mode":5,"indices":1)")).find("strips or fans"), std::string::npos);
  EXPECT_NE(refused(primitive("")).find("4 corners of triangles"), std::string::npos);
  EXPECT_NE(refused(primitive(R"(,"indices":0)")).find("type SCALAR"), std::string::npos);
  std::string few = primitive(R"(,"indices":1)");
  few.replace(few.find(R"("count":4)"), 9, R"("count":3)");
  EXPECT_NE(refused(few).find("face index out of range"), std::string::npos);
  std::string many = primitive(R"(,"indices":1)");
  many.replace(many.find(R"("count":12)"), 10, R"("count":15)");
  EXPECT_NE(refused(many).find("does not fit"), std::string::npos);
  // Triangles take memory too: so many nodes may share the points, but not both.
  std::string nodes;
  for (int k = 0; k < 500; ++k) nodes += R"(},{"mesh":0)";
  const std::string shared = samples::triangles_glb(R"({"attributes":{"POSITION":0},"indices":1})", nodes);
  EXPECT_EQ(read(shared).positions.size(), 501U * 4);
  EXPECT_NE(refused(shared).find("instances"), std::string::npos);
}

TEST(Off, ColoursAreOfOneKindInAllLines) {
  const std::string head = "COFF\n2 0 0\n";
  using Colors = std::vector<std::array<std::uint8_t, 3>>;
  EXPECT_EQ(read(head + "0.5 0 0 0.8 0.4 0.2 1\n1 0 0 1 0 0 1\n").colors, (Colors{{204, 102, 51}, {255, 0, 0}}));
  EXPECT_EQ(read(head + "0.5 0 0 1 0 0\n1 0 0 200 100 50\n").colors, (Colors{{1, 0, 0}, {200, 100, 50}}));
  EXPECT_EQ(read(head + "0 0 0 1 0 0 0.5\n1 0 0 1 1 0 0.5\n").colors, (Colors{{1, 0, 0}, {1, 1, 0}}));
}

TEST(Off, NormalsStandBeforeColours) {
  for (const char* text : {"NOFF\n2 0 0\n5 0 0 0 0 1\n6 0 0 0 -1 0\n", "CNOFF\n2 0 0\n5 0 0 0 0 1 200 100 50\n6 0 0 0 -1 0 1 2 3\n",
                           "CNOFF\n2 0 0\n5 0 0 0 0 1 200 100 50 255\n6 0 0 0 -1 0 1 2 3 255\n"}) {
    const Cloud cloud = read(text);
    EXPECT_EQ(cloud.positions, (std::vector<Vec3>{{5, 0, 0}, {6, 0, 0}})) << text;
    EXPECT_EQ(cloud.normals, (std::vector<Vec3>{{0, 0, 1}, {0, -1, 0}})) << text;
    if (text[0] == 'C') {
      EXPECT_EQ(cloud.colors, (std::vector<std::array<std::uint8_t, 3>>{{200, 100, 50}, {1, 2, 3}})) << text;
    }
  }
}

TEST(Obj, ColoursMayBeALittleAbove1) { EXPECT_EQ(read("v 0 0 0 1.0001 0.5 0\n").colors[0], (std::array<std::uint8_t, 3>{255, 128, 0})); }

TEST(Gltf, NodesMoveTheirPoints) {
  const Cloud cloud = read(samples::text_gltf());
  ASSERT_EQ(cloud.positions.size(), 2U);
  EXPECT_EQ(cloud.positions[1], (Vec3{11, 2, 6}));
  EXPECT_TRUE(cloud.warnings.empty());
}

TEST(Stl, EqualCornersAreOneVertex) {
  EXPECT_EQ(read(samples::written(samples::tetrahedron(), "a.stl")).positions.size(), 4U);
  EXPECT_EQ(read(samples::written(samples::tetrahedron(), "a.stl", {.ascii = true})).positions.size(), 4U);
}

// A LAS file whose only variable length record describes the coordinate system.
std::string las_in(std::uint16_t record, const std::string& system) {
  std::string las = samples::written(samples::helix(5), "a.las");
  const auto header = io::load<std::uint16_t>(las.data() + io::las::kHeaderSize);
  std::string vlr = std::string(2, '\0') + "LASF_Projection" + '\0' + samples::raw(record) +
                    samples::raw(static_cast<std::uint16_t>(system.size())) + std::string(32, '\0') + system;
  const auto points_at = io::load<std::uint32_t>(las.data() + io::las::kPointsAt);
  io::las::put(las, io::las::kPointsAt, static_cast<std::uint32_t>(header + vlr.size()));
  io::las::put(las, io::las::kVlrCount, std::uint32_t{1});
  return las.substr(0, header) + vlr + las.substr(points_at);
}

TEST(Las, DegreesAreToldByTheCoordinateSystem) {
  const std::string datum = R"(GEOGCS["WGS 84",DATUM["WGS_1984"]])";
  const auto keys = [](std::uint16_t model) {
    std::string text;
    for (const int number : {1, 1, 0, 1, 1024, 0, 1, int{model}}) text += samples::raw(static_cast<std::uint16_t>(number));
    return text;
  };
  const auto warned = [](const std::string& las) {
    for (const std::string& warning : read(las).warnings) {
      if (warning.find("longitude and latitude") != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(warned(las_in(io::las::kWkt, datum)));
  EXPECT_TRUE(warned(las_in(io::las::kWkt, "COMPD_CS[\"with heights\"," + datum + ",VERT_CS[\"NAVD88\"]]")));
  EXPECT_FALSE(warned(las_in(io::las::kWkt, "PROJCS[\"UTM zone 32N\"," + datum + "]")));
  EXPECT_TRUE(warned(las_in(io::las::kGeoKeys, keys(2))));
  EXPECT_FALSE(warned(las_in(io::las::kGeoKeys, keys(1))));
  EXPECT_FALSE(warned(las_in(io::las::kGeoKeys, keys(2).substr(0, 15))));
  EXPECT_FALSE(warned(samples::written(samples::helix(5), "a.las")));
  std::string projected = las_in(io::las::kWkt, datum);  // files name systems that their coordinates are not in
  io::las::put(projected, io::las::kBounds, 500000.0);
  EXPECT_FALSE(warned(projected));
}

TEST(Las, AHeaderOfVersion13MayEndBeforeTheWaveforms) {
  constexpr std::size_t kOldHeader = 227;
  std::string las = samples::written(samples::helix(1), "a.las").substr(0, kOldHeader);
  las[io::las::kMinor] = 3;
  las[io::las::kPointFormat] = 0;
  io::las::put(las, io::las::kHeaderSize, static_cast<std::uint16_t>(kOldHeader));
  io::las::put(las, io::las::kPointsAt, static_cast<std::uint32_t>(kOldHeader));
  io::las::put(las, io::las::kVlrCount, std::uint32_t{0});
  io::las::put(las, io::las::kRecordBytes, static_cast<std::uint16_t>(io::las::kRecordSize[0]));
  // The point begins where longer headers say where waveforms are, with the place of the second byte after it.
  const std::uint64_t beyond = kOldHeader + io::las::kRecordSize[0] + 1;
  las += samples::raw(beyond) + std::string(io::las::kRecordSize[0] - sizeof beyond, '\0') + "abc";
  const Cloud cloud = read(las);
  ASSERT_FALSE(cloud.warnings.empty());
  EXPECT_NE(cloud.warnings[0].find("3 trailing"), std::string::npos) << cloud.warnings[0];
}

TEST(Recognise, StrangersAreNamed) {
  EXPECT_NE(message_of("").find("empty"), std::string::npos);
  EXPECT_NE(message_of("\x1f\x8b whatever").find("gzip"), std::string::npos);
  EXPECT_NE(message_of("ASTM-E57 whatever").find("E57"), std::string::npos);
  EXPECT_NE(message_of("version https://git-lfs.github.com/spec/v1\n").find("git lfs pull"), std::string::npos);
  std::string laz = samples::written(samples::helix(5), "a.las");
  laz[104] = static_cast<char>(laz[104] | 0x80);
  EXPECT_NE(message_of(laz).find("laszip"), std::string::npos);
}

TEST(ReadMesh, PolygonsAreFansAndIndicesAreChecked) {
  const std::string off = "OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n3 0 1 4\n";
  const Mesh mesh = read_mesh_bytes(off.data(), off.size(), "a.off");
  EXPECT_EQ(mesh.triangles.size(), 3U);
  EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  const std::string bad = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n";
  EXPECT_THROW((void)read_mesh_bytes(bad.data(), bad.size(), "a.obj"), InvalidInput);
  try {
    (void)read_mesh_bytes(bad.data(), bad.size(), "a.obj");
  } catch (const InvalidInput& error) {
    EXPECT_EQ(dynamic_cast<const NoFaces*>(&error), nullptr);
  }
  for (const std::string text : {"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "1 2 3\n4 5 6\n"}) {
    EXPECT_THROW((void)read_mesh_bytes(text.data(), text.size(), "a.obj"), NoFaces);
  }
  const std::string relative = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n";
  EXPECT_EQ(read_mesh_bytes(relative.data(), relative.size(), "a.obj").triangles.size(), 1U);
}

TEST(Read, MissingFilesAreIoErrors) {
  try {
    (void)read_cloud("/nonexistent/cloud.ply");
    FAIL();
  } catch (const IoError& error) {
    EXPECT_EQ(error.kind(), IoError::Kind::kNotFound);
    EXPECT_STREQ(error.what(), "/nonexistent/cloud.ply: No such file or directory");
  }
  EXPECT_THROW((void)read_cloud("/"), IoError);
}

TEST(Read, AnEndlessStreamOfZerosEndsAtOnce) { EXPECT_THROW((void)read_cloud("/dev/zero"), InvalidInput); }

TEST(Read, QuantisedFloatsAreSaid) {
  Cloud far = samples::helix(20, Scalar::kFloat32);
  far.normals.clear();
  far.colors.clear();
  for (Vec3& p : far.positions) p[1] += 5e6;
  const Cloud cloud = read(samples::written(far, "a.ply"));
  ASSERT_EQ(cloud.warnings.size(), 1U);
  EXPECT_NE(cloud.warnings[0].find("quantised"), std::string::npos);
}

}  // namespace
}  // namespace g3r
