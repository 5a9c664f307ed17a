// Files in, files out. Any file may be damaged or hostile: readers never crash, never allocate from a header's word (peak memory at
// most 16 x file size + 1 MiB) and name the file, the place, what was expected and what was found. Writers write all or nothing.
#pragma once

#include <g3r/error.h>
#include <g3r/export.h>
#include <g3r/mesh.h>
#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace G3R_PUBLIC g3r {

/// What a file holds besides the points: every property, list, comment and element, kept so that write_cloud() can return it untouched.
class Attributes;

/// A point cloud as read from a file. All vectors with a value per point are empty or have one entry per point.
/// Scanner positions are those that a file states: VIEWPOINT of PCD (the identity, 0 0 0 1 0 0 0, is what writers put who do not know),
/// the poses of E57 (unknown where all are the identity) and of PTX.
struct Cloud {
  std::vector<Vec3> positions;                      ///< N points, file order; non-finite ones are kept (orient() leaves them out)
  std::vector<Vec3> normals;                        ///< normals in the file, not normalised; empty if absent or all zero
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< RGB
  std::vector<float> confidence;                    ///< a property named confidence or quality
  std::vector<Vec3> sensor_positions;               ///< where the scanner stood, one per scan, in input coordinates; empty if unknown
  std::vector<std::uint32_t> scan_of_point;         ///< index into sensor_positions; empty if there is one scan or none is known
  Scalar scalar = Scalar::kFloat64;                 ///< precision of the coordinates in the file
  std::string format;                               ///< for example "ply binary_little_endian"
  std::vector<std::string> property_names;          ///< as in the file, in its order
  std::shared_ptr<const Attributes> attributes;     ///< null when the format holds nothing else
  std::vector<std::string> warnings;                ///< one line each: what was odd and what was done about it
};

/// A box with sides along the axes.
struct Box {
  Vec3 low{};
  Vec3 high{};
};

struct ReadOptions {
  double min_opacity = 0.1;  ///< Gaussian splats: leave out splats below this opacity, 0..1
  /// Gaussian splats: keep all, also those below min_opacity and, where the file has scales and rotations, those that are no surface: at
  /// whose centre the splats together stop less than half of the light (floaters), or that from no side half of the light reaches (inside).
  bool all_splats = false;
  std::optional<Box> box{};  ///< leave out points outside of it; of COPC and EPT only cells that it meets are unpacked
  int levels = 0;            ///< COPC, EPT: levels of the octree to read, from the coarsest; 0 for all (as of other files, with a warning)
  int threads = 0;           ///< Gaussian splats: of the search for those that are no surface, 0 for all cores; the rest takes one
  const std::atomic<bool>* cancel = nullptr;  ///< when it becomes true that search throws Cancelled
};

/// Reads a cloud; the format is recognised by content, not by name. "-" reads standard input. A folder, or a pattern with * or ? that
/// names no file itself, stands for all files of points in it (LAS, LAZ, PLY, PCD, E57, PTX, PTS, XYZ, CSV, ASC, NPY, SPZ; of a pattern,
/// whatever it names), which become one cloud in the order of their names: properties of numbers that any of them has, 0 where one has
/// not. An ept.json, or the folder that holds one, stands for the cells of its octree.
/// O(file) time and memory. Throws IoError (not found, read error), InvalidInput (damaged, unknown or unusable; says where and what to do),
/// Cancelled, std::bad_alloc.
[[nodiscard]] Cloud read_cloud(const std::string& path, const ReadOptions& options = {});

/// The same from bytes in memory; `name` is used in messages.
[[nodiscard]] Cloud read_cloud_bytes(const void* bytes, std::size_t size, const std::string& name, const ReadOptions& options = {});

/// Reads a triangle mesh (PLY, OBJ, OFF, STL, glTF); polygons are cut into fans. Throws like read_cloud(), and NoFaces if it has none.
[[nodiscard]] Mesh read_mesh(const std::string& path);
/// The same from bytes in memory; `name` is used in messages.
[[nodiscard]] Mesh read_mesh_bytes(const void* bytes, std::size_t size, const std::string& name);

struct WriteOptions {
  bool ascii = false;                         ///< text instead of binary where the format has both
  bool cloud_compare_names = false;           ///< name the confidence "scalar_confidence" so that CloudCompare shows it at once
  const std::atomic<bool>* cancel = nullptr;  ///< when it becomes true the writer leaves nothing behind and throws Cancelled
  /// Points to LAS or LAZ: gets a line for each thing that these cannot hold as it is, and what became of it (null: nobody is told).
  std::vector<std::string>* warnings = nullptr;
};

/// Writes the points with all their properties, and (each may be null) N normals and N confidences, replacing those of the file.
/// The format follows the extension. Written whole or not at all: temporary file in the same folder, fsync, rename.
/// "-" writes to standard output. Throws IoError, InvalidInput (unknown extension, sizes that differ, a non-finite normal), Unavailable
/// (LAZ in a build without LASzip).
void write_cloud(const std::string& path, const Cloud& cloud, const std::vector<Vec3>* normals, const std::vector<float>* confidence,
                 const WriteOptions& options = {});

/// Writes a mesh; the format follows the extension. Whole or not at all; throws like write_cloud(), and InvalidInput for an empty mesh.
void write_mesh(const std::string& path, const Mesh& mesh, const WriteOptions& options = {});

/// Throws what write_*() would throw for this path (unknown extension, missing or read-only folder, same file as an input), before any
/// work. `for_mesh`: check the extension as a mesh format, else as a point format. Leaves nothing behind.
void check_output(const std::string& path, const std::vector<std::string>& inputs, bool for_mesh);

/// Writes bytes (a report, a page) whole or not at all; "-" writes to standard output. Throws IoError.
void write_file(const std::string& path, const std::string& bytes);

/// Text from a file made safe for a terminal: control characters, and bytes that are no UTF-8, become \xNN.
[[nodiscard]] std::string escape_text(const std::string& text);

}  // namespace g3r
