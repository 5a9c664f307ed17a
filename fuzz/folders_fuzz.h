// The form of an input of the fuzz target for files that name others, for it and for the maker of its seeds.
#pragma once

#include "io_samples.h"
#include "tiles/manifest.h"
#include "tiles/records.h"

#include <filesystem>
#include <string>

namespace g3r::fuzz {

/// Which file the input is, by its first byte.
enum class Naming : unsigned char { kList, kVirtual, kEpt, kEptPage, kManifest };

/// Its name in the folder.
inline const char* file_of(Naming naming) {
  constexpr const char* kFiles[] = {"input.list", "input.vpc", "ept.json", "ept-hierarchy/0-0-0-0.json", "manifest.json"};
  return kFiles[static_cast<unsigned>(naming)];
}

/// An EPT of one cell of one point.
inline void make_ept(const samples::Folder& folder) {
  std::filesystem::create_directories(folder.path("ept-hierarchy"));
  std::filesystem::create_directories(folder.path("ept-data"));
  samples::spill(folder.path(file_of(Naming::kEpt)),
                 R"({"bounds":[0,0,0,32,32,32],"dataType":"binary","hierarchyType":"json","points":1,"schema":[)"
                 R"({"name":"X","type":"signed","size":4,"scale":0.5,"offset":10},{"name":"Y","type":"float","size":4},)"
                 R"({"name":"Z","type":"unsigned","size":2}],"version":"1.0.0"})");
  samples::spill(folder.path(file_of(Naming::kEptPage)), R"({"0-0-0-0": 1, "1-1-0-0": 0})");
  samples::spill(folder.path("ept-data/0-0-0-0.bin"), std::string(10, '\1'));
}

/// A plan of one tile of one cell of one point.
inline void make_plan(const samples::Folder& folder) {
  const std::string path = folder.path("");
  tiles::Manifest m;
  m.asked = "tiles 1 max_memory 0";
  m.inputs = {{"/cloud.ply", 12, 1}};
  m.points = m.stride = m.coarse_points = 1;
  m.tiles = {{0, 1, 1, 1}};
  samples::spill(tiles::points_path(path, 1), std::string(sizeof(tiles::Record), '\0'));
  samples::spill(tiles::coarse_path(path), std::string(sizeof(tiles::CoarseNormal), '\0'));
  samples::spill(tiles::cells_path(path), std::string(sizeof(tiles::Cell), '\0'));
  tiles::write_manifest(path, m);
}

}  // namespace g3r::fuzz
