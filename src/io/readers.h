// One reader per format, each in its own file. All take recognised bytes, without a byte order mark for text formats, and throw
// InvalidInput. None allocates more than the bytes at hand can fill.
#pragma once

#include "io/fixed_records.h"
#include "io/point_stream.h"
#include "io/random_file.h"
#include "io/source.h"
#include "io/table.h"

#include <cstdint>
#include <memory>
#include <optional>

namespace g3r::io {

/// What readers warn of whose x and y are longitude and latitude beside heights in metres: a shape that nobody wants.
inline constexpr const char* kDegrees =
    "x and y are longitude and latitude: where they are degrees the shape is distorted; project them first, for example with PDAL or PROJ";

Cloud read_ply(const Source& source, const ReadOptions& options);
Cloud read_pcd(const Source& source);
Cloud read_npy(const Source& source);
Cloud read_las(const Source& source, const ReadOptions& options);
Cloud read_e57(const Source& source);
Cloud read_glb(const Source& source);
Cloud read_gltf(const Source& source);
Cloud read_ptx(const Source& source);
Cloud read_ascii_grid(const Source& source);
Cloud read_spz(const Source& source, const ReadOptions& options);
Cloud read_xyz(const Source& source);
Cloud read_obj(const Source& source);
Cloud read_off(const Source& source);
Cloud read_stl(const Source& source, bool binary);

/// Where the records of a file are that begins with `head` and has `file_size` bytes; nothing where they are stored otherwise, or are not
/// all there. What these throw, the reader of the format throws too.
std::optional<StoredTable> find_ply_records(const Source& head, std::uint64_t file_size);
std::optional<StoredTable> find_pcd_records(const Source& head, std::uint64_t file_size);
/// Reads rows of six columns or more until it is known what columns 4 to 6 are.
std::optional<StoredTable> find_npy_records(const Source& head, const RandomFile& file);

/// The points of recognised files, some at a time; of a text, which begins at byte `begin`. Opening reads the text once, or twice where it
/// has more columns than x y z; E57 is read for its checksums. Throw what the reader of the format throws, or next() does.
std::unique_ptr<PointStream> stream_xyz(std::unique_ptr<RandomFile> file, std::uint64_t begin);
std::unique_ptr<PointStream> stream_ptx(std::unique_ptr<RandomFile> file, std::uint64_t begin);
std::unique_ptr<PointStream> stream_ascii_grid(std::unique_ptr<RandomFile> file, std::uint64_t begin);
std::unique_ptr<PointStream> stream_e57(std::unique_ptr<RandomFile> file);

Mesh read_ply_mesh(const Source& source);
Mesh read_obj_mesh(const Source& source);
Mesh read_off_mesh(const Source& source);
Mesh read_stl_mesh(const Source& source, bool binary);
Mesh read_glb_mesh(const Source& source);
Mesh read_gltf_mesh(const Source& source);

}  // namespace g3r::io
