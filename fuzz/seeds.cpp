// seeds FOLDER: what the fuzzers start from. Adds one small file of every format to FOLDER/read, which may hold files already, and makes
// FOLDER/pipeline from all of them, FOLDER/streams, FOLDER/folders and FOLDER/command_line; in builds that read them FOLDER/laz and
// FOLDER/e57.
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

#include "folders_fuzz.h"
#include "io_samples.h"
#include "pipeline_fuzz.h"
#ifdef G3R_FUZZ_LAZ
#include "laz_samples.h"
#endif
#ifdef G3R_FUZZ_E57
#include "e57_samples.h"
#endif

namespace {

using g3r::fuzz::Coding;
using g3r::fuzz::kOptionBytes;
using g3r::samples::spill;

constexpr int kSide = 3;

std::string options(Coding coding) {
  std::string bytes(kOptionBytes, '\0');
  bytes[0] = static_cast<char>(coding);
  return bytes;
}

/// The points of a small ball, cube, plane, line and heap, as numbers of type T.
template <class T>
void spill_shapes(const std::string& folder, Coding coding) {
  const auto write = [&](const std::string& name, const std::vector<std::array<T, 3>>& points) {
    spill(folder + "/" + name + std::to_string(sizeof(T)),
          options(coding) + std::string(reinterpret_cast<const char*>(points.data()), points.size() * sizeof points[0]));
  };
  std::vector<std::array<T, 3>> ball;
  for (int i = 0; i < 60; ++i) {
    const double z = (2 * i - 59) / 60.0;
    const double ring = 100 * std::sqrt(1 - z * z);
    ball.push_back({static_cast<T>(ring * std::cos(2.4 * i)), static_cast<T>(ring * std::sin(2.4 * i)), static_cast<T>(100 * z)});
  }
  write("ball", ball);
  std::vector<std::array<T, 3>> cube, plane, line;
  for (int x = 0; x <= kSide; ++x) {
    line.push_back({static_cast<T>(x), 0, 0});
    for (int y = 0; y <= kSide; ++y) {
      plane.push_back({static_cast<T>(x), static_cast<T>(y), 7});
      for (int z = 0; z <= kSide; ++z) {
        if (x % kSide == 0 || y % kSide == 0 || z % kSide == 0) cube.push_back({static_cast<T>(x), static_cast<T>(y), static_cast<T>(z)});
      }
    }
  }
  write("cube", cube);
  write("plane", plane);
  write("line", line);
  write("heap", std::vector<std::array<T, 3>>(10, {1, 2, 3}));
  constexpr T kMost = std::numeric_limits<T>::max();
  write("far", {{0, 0, 0}, {kMost, 0, 0}, {0, kMost, 0}, {0, 0, kMost}, {1, 0, 0}, {0, 1, 0}});
}

void spill_pipeline(const std::string& files, const std::string& folder) {
  for (const auto& file : std::filesystem::directory_iterator(files)) {
    if (file.is_regular_file())
      spill(folder + "/" + file.path().filename().string(), options(Coding::kFile) + g3r::samples::slurp(file.path()));
  }
  spill_shapes<std::int8_t>(folder, Coding::kInteger);
  spill_shapes<float>(folder, Coding::kFloat);
  spill_shapes<double>(folder, Coding::kDouble);
}

// All files of points, and LAZ and E57, if they are made.
void spill_streams(const std::string& from, const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const std::string name : {"/read", "/laz", "/e57"}) {
    if (!std::filesystem::exists(from + name)) continue;
    for (const auto& file : std::filesystem::directory_iterator(from + name)) {
      spill(folder + "/" + file.path().filename().string(), g3r::samples::slurp(file.path()));
    }
  }
}

void spill_folders(const std::string& folder) {
  using g3r::fuzz::Naming;
  const g3r::samples::Folder made;
  g3r::fuzz::make_ept(made);
  g3r::fuzz::make_plan(made);
  spill(made.path(g3r::fuzz::file_of(Naming::kList)), "# two files\na.las\n/b/c.laz\n");
  spill(made.path(g3r::fuzz::file_of(Naming::kVirtual)),
        R"({"type":"FeatureCollection","features":[{"type":"Feature","assets":{"data":{"href":"./a\/b.copc.laz"}},"links":[]}]})");
  for (const Naming naming : {Naming::kList, Naming::kVirtual, Naming::kEpt, Naming::kEptPage, Naming::kManifest}) {
    const std::string kind(1, static_cast<char>(naming));
    spill(folder + "/seed" + std::to_string(kind[0]), kind + g3r::samples::slurp(made.path(g3r::fuzz::file_of(naming))));
  }
}

void spill_command_lines(const std::string& folder) {
  const std::vector<std::string> lines = {
      "scan.ply",
      "scan.ply\nmesh.obj\n--open\n--threads\n2",
      "orient\n-\n-\n--ascii\n--preset\npaper\n--epsilon\n0.4h",
      "mesh\na.ply\nb.stl\n--trim\n0.5\n--faces\n100\n--keep-largest\n1",
      "eval\na.ply\n--truth\nb.ply\n--samples\n10\n--seed\n1",
      "sample\na.obj\nb.xyz\n--count\n5\n--noise\n0.5%",
      "info\na.ply\n--report\n-\n--max-memory\n8G",
      "view\na.ply\nb.ply\n-o\nc.html\n--truth\nt.ply",
      "--help",
      "orient\n--help",
      "--version",
      "a.xyz\n--harmonics\ndegree:0-2\n--schedule\n20 sd 60 cg\n--tolerance\n1e-3\n--accuracy\n0\n--solver\ndense\n--condition-number",
      "a.xyz\n--method\ngreen\n--degree\n3\n--mesher\npoisson\n--depth\n8\n--min-component\n2\n--strict\n-v\n-q\n--no-progress"};
  for (std::size_t i = 0; i < lines.size(); ++i) spill(folder + "/line" + std::to_string(i), lines[i]);
}

#ifdef G3R_FUZZ_LAZ
void spill_laz(const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const unsigned format : {0U, 1U, 3U, 4U, 6U, 7U, 10U}) {
    for (const std::uint32_t chunk : {50000U, 3U}) {
      const std::string las = g3r::samples::las_file(format, 5, chunk == 3);
      spill(folder + "/" + std::to_string(format) + "_" + std::to_string(chunk), g3r::samples::compressed(las, chunk));
    }
  }
}
#endif

#ifdef G3R_FUZZ_E57
void spill_e57(const std::string& folder) {
  using g3r::samples::E57Field;
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, const std::vector<g3r::samples::E57Scan>& scans) {
    spill(folder + "/" + name, g3r::samples::e57_file(scans));
  };
  write("double", {g3r::samples::e57_scan(4, E57Field::kDouble)});
  write("float", {g3r::samples::e57_scan(4, E57Field::kFloat)});
  write("scaled", {g3r::samples::e57_scan(4, E57Field::kScaled)});
  write("spherical", {{{{"sphericalRange", E57Field::kScaled, {1, 2, 3}, -2000000, 2000000},
                        {"sphericalAzimuth", E57Field::kFloat, {1, 2, 3}},
                        {"sphericalElevation", E57Field::kFloat, {1, 0, -1}}},
                       {1, 0, 0, 0},
                       {5e5, 5.4e6, 100}}});
  write("two", {g3r::samples::e57_scan(2, E57Field::kFloat), g3r::samples::e57_scan(0, E57Field::kFloat)});
}
#endif

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  const std::string folder = argv[1];
  for (const char* part : {"/read", "/pipeline", "/folders", "/command_line"}) std::filesystem::create_directories(folder + part);
  for (const g3r::samples::Sample& sample : g3r::samples::all(4)) spill(folder + "/read/" + sample.name, sample.bytes);
  spill_pipeline(folder + "/read", folder + "/pipeline");
  spill_folders(folder + "/folders");
  spill_command_lines(folder + "/command_line");
#ifdef G3R_FUZZ_LAZ
  spill_laz(folder + "/laz");
#endif
#ifdef G3R_FUZZ_E57
  spill_e57(folder + "/e57");
#endif
  spill_streams(folder, folder + "/streams");
  return 0;
}
