#include "tiles/parts.h"

#include "base/disjoint_sets.h"
#include "tiles/mesh_records.h"
#include "tiles/patches_file.h"

#include <g3r/io.h>

#include <algorithm>

namespace g3r::tiles {
namespace {

template <class T>
std::vector<T> read_records(const io::RandomFile& file, std::uint64_t at, std::uint64_t count) {
  std::vector<T> out(static_cast<std::size_t>(count));
  file.read(at, out.data(), out.size() * sizeof(T));
  return out;
}

std::uint64_t moved_at(const PartsHeader& h) { return sizeof h + h.parts * sizeof(Part); }
std::uint64_t foreign_at(const PartsHeader& h) { return moved_at(h) + h.moved * sizeof(MovedVertex); }
std::uint64_t vertices_at(const PartsHeader& h) { return foreign_at(h) + h.foreign * sizeof(ForeignPart); }

}  // namespace

PartsFile::PartsFile(const MeshFolder& folder, std::size_t tile) : file_(mesh_parts_path(folder.folder, tile)) {
  if (file_.size() < sizeof header_) fail();
  file_.read(0, &header_, sizeof header_);
  const PatchesHeader patches = PatchesFile(folder.folder, tile).header();
  movable_ = patches.vertices + patches.centres;
  const bool fits = header_.parts <= file_.size() && header_.moved <= movable_ && header_.foreign == patches.foreign &&
                    header_.vertices == patches.vertices;
  if (!fits || file_.size() != vertices_at(header_) + header_.vertices * sizeof(std::uint32_t)) fail();
}

std::vector<Part> PartsFile::parts() const { return read_records<Part>(file_, sizeof header_, header_.parts); }

std::vector<MovedVertex> PartsFile::moved() const {
  auto out = read_records<MovedVertex>(file_, moved_at(header_), header_.moved);
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (out[k].vertex >= movable_ || (k > 0 && out[k].vertex <= out[k - 1].vertex)) fail();
  }
  return out;
}

std::vector<ForeignPart> PartsFile::foreign() const {
  auto out = read_records<ForeignPart>(file_, foreign_at(header_), header_.foreign);
  if (std::any_of(out.begin(), out.end(), [&](const ForeignPart& f) { return f.part >= header_.parts; })) fail();
  return out;
}

std::vector<std::uint32_t> PartsFile::parts_of(std::uint64_t begin, std::uint64_t end) const {
  auto out = read_records<std::uint32_t>(file_, vertices_at(header_) + begin * sizeof(std::uint32_t), end - begin);
  if (std::any_of(out.begin(), out.end(), [&](std::uint32_t part) { return part >= header_.parts; })) fail();
  return out;
}

void PartsFile::fail() const { throw InvalidInput(escape_text(file_.path()) + ": damaged; remove it, and mesh again"); }

KeptParts::KeptParts(const MeshFolder& folder, const MeshOptions& options, Dropped& dropped) {
  std::vector<Part> parts;
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    const PartsFile file(folder, t);
    const std::vector<Part> of_tile = file.parts();
    first_.push_back(parts.size());
    parts.insert(parts.end(), of_tile.begin(), of_tile.end());
    dropped.points += file.header().strays;
  }
  first_.push_back(parts.size());
  DisjointSets sets(parts.size());
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    const PartsFile file(folder, t);
    const std::vector<ForeignPart> foreign = file.foreign();
    for (std::size_t f = 0; f < foreign.size();) {
      const std::uint32_t from = foreign[f].tile;
      if (from >= folder.tiles()) file.fail();
      const PartsFile there(folder, from);
      const std::vector<std::uint32_t> part = there.parts_of(0, there.header().vertices);
      for (; f < foreign.size() && foreign[f].tile == from; ++f) {
        if (foreign[f].vertex >= part.size()) file.fail();
        sets.join(first_[t] + foreign[f].part, first_[from] + part[static_cast<std::size_t>(foreign[f].vertex)]);
      }
    }
  }
  // The number of every component, in order of first use; sums in the order of the parts.
  std::vector<std::size_t> number(parts.size());
  std::vector<mesh::Support> support;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const std::size_t root = sets.find(p);  // the smallest, so it has a number
    number[p] = root == p ? support.size() : number[root];
    if (root == p) support.emplace_back();
    support[number[p]].add(parts[p].support);
  }
  const std::vector<std::uint8_t> keep = mesh::kept_components(support, options, dropped.points, dropped);
  components_ = static_cast<std::size_t>(std::count(keep.begin(), keep.end(), std::uint8_t{1}));
  for (const std::size_t n : number) keep_.push_back(keep[n]);
  counts_.resize(folder.tiles());
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    for (std::size_t p = first_[t]; p < first_[t + 1]; ++p) {
      if (keep_[p] == 0) continue;
      counts_[t].vertices += parts[p].vertices;
      counts_[t].centres += parts[p].centres;
      counts_[t].triangles += parts[p].triangles;
    }
  }
}

}  // namespace g3r::tiles
