// The page: its text, and (where a Chromium is installed) its life in a real browser without a display.
#include "view_scenes.h"

#include <g3r/g3r.h>
#include <g3r/view.h>

#include "view/pack.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <regex>
#include <sstream>

#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace g3r {
namespace {

using Json = nlohmann::json;

Scene full_scene(std::size_t count) {
  Scene scene = testing::torus_points(count);
  scene.true_normals = scene.normals;
  for (std::size_t i = 0; i < scene.normals.size(); i += 10) {
    for (double& x : scene.normals[i]) x = -x;
  }
  scene.mesh = testing::torus_mesh(64, 32);
  scene.report = R"({"schema": "g3r.report", "converged": true, "input": {"used": 1234},
    "iterations": [{"kind": "sd", "residual": 0.5}, {"kind": "cg", "residual": 0.01}],
    "mesh": {"faces": 4096, "closed": true, "manifold": true, "components": 1, "genus": 1, "area": 3, "volume": 2},
    "seconds": {"solve": 1.5}, "warnings": ["careful <here>"]})";
  return scene;
}

Json data_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"scene-data\">";
  const std::size_t begin = page.find(open) + open.size();
  return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

std::size_t decoded_size(const std::string& text) { return text.size() / 4 * 3 - (text.ends_with("==") ? 2 : text.ends_with("=") ? 1 : 0); }

TEST(ViewPack, Base64OfRfc4648) {
  const auto encode = [](std::string text) { return view::base64({text.begin(), text.end()}); };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

TEST(ViewPack, NormalsSurviveWithinOneDegree) {
  for (const Vec3& n : testing::torus_points(5000).normals) {
    for (const double sign : {1.0, -1.0}) {
      std::vector<std::uint8_t> bytes;
      view::append_normal(bytes, {sign * n[0], sign * n[1], sign * n[2]});
      const double u = static_cast<std::int8_t>(bytes[0]) / 127.0, v = static_cast<std::int8_t>(bytes[1]) / 127.0;
      ASSERT_FALSE(u == -1 && v == -1);
      Vec3 back = {u, v, 1 - std::abs(u) - std::abs(v)};
      if (back[2] < 0) back = {(1 - std::abs(v)) * (u >= 0 ? 1 : -1), (1 - std::abs(u)) * (v >= 0 ? 1 : -1), back[2]};
      back = view::unit_or_zero(back);
      EXPECT_GT(sign * (back[0] * n[0] + back[1] * n[1] + back[2] * n[2]), std::cos(0.0175));
    }
  }
}

TEST(ViewPack, NoNormalHasItsOwnCode) {
  std::vector<std::uint8_t> bytes;
  view::append_normal(bytes, {0, 0, 0});
  view::append_normal(bytes, {0, 0, -1});
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{129, 129, 127, 127}));
}

TEST(ViewHtml, HoldsEveryPointAndTriangle) {
  const Json data = data_of(view_html(full_scene(1000)));
  EXPECT_EQ(data["points"]["shown"], 1000);
  EXPECT_EQ(decoded_size(data["points"]["position"]), 6000U);
  EXPECT_EQ(decoded_size(data["points"]["normal"]), 2000U);
  EXPECT_EQ(decoded_size(data["points"]["confidence"]), 1000U);
  EXPECT_EQ(decoded_size(data["points"]["error"]), 1000U);
  EXPECT_EQ(decoded_size(data["points"]["color"]), 3000U);
  EXPECT_EQ(decoded_size(data["mesh"]["triangle"]), 12U * 4096U);
  EXPECT_EQ(data["truth"]["wrong_side"], 100);
  EXPECT_EQ(data["report"]["input"]["used"], 1234);
}

TEST(ViewHtml, ThinsEvenlyAndSaysSo) {
  PageOptions options;
  options.max_points = 300;
  options.max_triangles = 100;
  Scene scene = full_scene(1000);
  scene.points[0][0] = std::numeric_limits<double>::infinity();
  const Json data = data_of(view_html(scene, options));
  EXPECT_EQ(data["points"]["given"], 1000);
  EXPECT_EQ(data["points"]["finite"], 999);
  EXPECT_EQ(data["points"]["shown"], 300);
  EXPECT_EQ(decoded_size(data["points"]["position"]), 1800U);
  EXPECT_EQ(data["mesh"]["given"], 4096);
  EXPECT_EQ(data["mesh"]["shown"], 0);
  EXPECT_EQ(data["truth"]["compared"], 999) << "figures are over all points";
}

TEST(ViewHtml, LoadsNothingFromElsewhere) {
  const std::string page = view_html(full_scene(100));
  const std::regex reference(R"((src|href)\s*=\s*["'](?!data:)|url\(|@import|fetch\(|XMLHttpRequest|https?://(?!www\.w3\.org/2000/svg))");
  std::smatch found;
  EXPECT_FALSE(std::regex_search(page, found, reference)) << found.str();
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST(ViewHtml, TextFromFilesCannotBecomeMarkup) {
  Scene scene = testing::torus_points(10);
  scene.title = "</title></script><script>alert(1)</script>{{data}}\xff";
  scene.report = R"({"schema": "g3r.report", "warnings": ["</script><script>alert(2)</script>"]})";
  const std::string page = view_html(scene);
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(data_of(page)["report"]["warnings"][0], "</script><script>alert(2)</script>");
}

TEST(ViewHtml, OnlyAReportIsTakenForOne) {
  Scene scene = testing::torus_points(10);
  for (const char* other :
       {"[]", "3", "null", "{}", R"({"schema": "g3r.tiles"})", R"({"schema": ["g3r.report"]})", R"([{"schema": "g3r.report"}])"}) {
    scene.report = other;
    EXPECT_THROW((void)view_html(scene), InvalidInput) << other;
  }
  scene.report = report_json({});
  EXPECT_EQ(data_of(view_html(scene))["report"]["schema"], "g3r.report");
}

// view: as deep as a report may nest, and far deeper than the stack would hold.
TEST(ViewHtml, DeeplyNestedReportsAreRefused) {
  Scene scene = testing::torus_points(10);
  const auto nested = [](std::size_t depth) {
    return R"({"schema": "g3r.report", "deep": )" + std::string(depth, '[') + std::string(depth, ']') + "}";
  };
  scene.report = nested(60);
  EXPECT_NO_THROW((void)view_html(scene));
  for (const std::size_t depth : {100U, 1000000U}) {
    scene.report = nested(depth);
    EXPECT_THROW((void)view_html(scene), InvalidInput) << depth;
  }
  scene.report = std::string(1000000, '[');
  EXPECT_THROW((void)view_html(scene), InvalidInput);
}

TEST(ViewHtml, SameBytesTwice) { EXPECT_EQ(view_html(full_scene(500)), view_html(full_scene(500))); }

TEST(ViewHtml, BrokenScenesAreRefused) {
  EXPECT_THROW((void)view_html(Scene{}), InvalidInput);
  Scene scene = full_scene(10);
  scene.report = "{";
  EXPECT_THROW((void)view_html(scene), InvalidInput);
  scene = full_scene(10);
  scene.mesh.triangles.push_back({0, 1, 1U << 30U});
  EXPECT_THROW((void)view_html(scene), InvalidInput);
  scene = full_scene(10);
  scene.mesh.confidence.assign(scene.mesh.vertices.size(), 1);
  EXPECT_NO_THROW((void)view_html(scene));
  scene.mesh.confidence.pop_back();
  EXPECT_THROW((void)view_html(scene), InvalidInput);
}

#ifdef G3R_CHROMIUM

std::string run(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), &pclose);
  std::string output;
  std::array<char, 4096> block;
  for (std::size_t got = 0; pipe && (got = fread(block.data(), 1, block.size(), pipe.get())) > 0;) output.append(block.data(), got);
  return output;
}

struct Visit {
  Json selftest;
  std::string console;  // lines that the page wrote to the console
};

// Opens the page with the self test appended to it, in a browser without display or network.
Visit visit(std::string page) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("g3r_page_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::stringstream script;
  script << std::ifstream(G3R_SELFTEST).rdbuf();
  page.insert(page.rfind("</body>"), "<script>" + script.str() + "</script>");
  std::ofstream(folder / "page.html", std::ios::binary) << page;
  const std::string dom =
      run(std::string(G3R_CHROMIUM) +
          " --headless=new --no-sandbox --disable-dev-shm-usage --use-gl=angle --use-angle=swiftshader"
          " --enable-unsafe-swiftshader --window-size=1000,700 --enable-logging=stderr --v=0 --dump-dom --user-data-dir=" +
          (folder / "profile").string() + " file://" + (folder / "page.html").string() + " 2> " + (folder / "log").string());
  Visit visit;
  std::ifstream log(folder / "log");
  for (std::string line; std::getline(log, line);) {
    if (line.find("CONSOLE") != std::string::npos) visit.console += line + "\n";
  }
  std::filesystem::remove_all(folder);
  const std::string open = "<pre id=\"selftest\">";
  const std::size_t begin = dom.rfind(open);  // the script names it too
  if (begin == std::string::npos) return visit;
  std::string text = dom.substr(begin + open.size(), dom.find("</pre>", begin) - begin - open.size());
  for (const auto& [from, to] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&nbsp;", " "}, {"&amp;", "&"}}) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos;) text.replace(at, std::string(from).size(), to);
  }
  visit.selftest = Json::parse(text);
  return visit;
}

TEST(ViewBrowser, EveryModeDrawsWhatItShouldAndEveryInputWorks) {
  PageOptions options;
  options.up = Up::kZ;
  options.max_points = 18000;
  const Visit seen = visit(view_html(full_scene(20000), options));
  EXPECT_EQ(seen.console, "");
  ASSERT_TRUE(seen.selftest.is_object()) << "the page did not come up";

  for (const auto& [mode, pixels] : seen.selftest["modes"].items()) {
    EXPECT_EQ(pixels["error"], 0) << mode;
    EXPECT_GT(pixels["drawn"], 0.15) << mode << " is blank";
    EXPECT_LT(pixels["drawn"], 0.98) << mode << " hides the background";
  }
  const Json& modes = seen.selftest["modes"];
  for (const std::string theme : {" light", " dark"}) {
    EXPECT_LT(modes["before" + theme]["blue"], 0.01);
    EXPECT_GT(modes["sides" + theme]["blue"], 0.2);
    EXPECT_GT(modes["sides" + theme]["red"], 0.01) << "one normal in ten is wrong";
    EXPECT_GT(modes["sides" + theme]["blue"], modes["sides" + theme]["red"]);
    EXPECT_LT(modes["mesh" + theme]["red"], 0.001) << "a closed mesh shows no inside";
  }
  EXPECT_GT(modes["section"]["red"], 0.02) << "a cut mesh shows its inside";
  EXPECT_LT(modes["compare"]["blue"], 0.7 * modes["sides light"]["blue"].get<double>());

  for (const auto& [input, works] : seen.selftest["input"].items()) EXPECT_EQ(works, true) << input;
  const Json& texts = seen.selftest["texts"];
  EXPECT_EQ(texts["title"], "torus");
  EXPECT_NE(texts["note"].get<std::string>().find("showing 18"), std::string::npos) << texts["note"];
  EXPECT_NE(texts["figures"].get<std::string>().find("careful <here>"), std::string::npos);
  EXPECT_EQ(seen.selftest["formats"]["percent"], (Json{"100 %", "50 %", "10 %", "99.9 %", "1.23 %", "0 %"}));
  EXPECT_EQ(seen.selftest["formats"]["time"],
            (Json{"1.2 ms", "50 ms", "100 ms", "2.5 s", "99.4 s", "2 min 0 s", "60 min 0 s", "120 min 0 s"}));
  EXPECT_EQ(seen.selftest["requests"], 0);
}

TEST(ViewBrowser, AMeshTooLargeForThePageLeavesItsFigures) {
  PageOptions options;
  options.max_triangles = 1;
  Scene scene = full_scene(0);
  scene.report =
      R"({"schema": "g3r.report", "confidence": {"mean": 0, "below_half": 0}, "method": {"solver": ""}, "mesh": {"faces": 4096}})";
  const Visit seen = visit(view_html(scene, options));
  EXPECT_EQ(seen.console, "");
  ASSERT_TRUE(seen.selftest.is_object()) << "the page did not come up";
  const auto& note = seen.selftest["texts"]["note"].get_ref<const std::string&>();
  EXPECT_NE(note.find("the mesh is too large for this page"), std::string::npos) << note;
  const auto& figures = seen.selftest["texts"]["figures"].get_ref<const std::string&>();
  EXPECT_NE(figures.find("triangles"), std::string::npos) << figures;
  EXPECT_EQ(figures.find("confidence"), std::string::npos) << "of a run without normals: " << figures;
}

#endif

}  // namespace
}  // namespace g3r
