#include "io/recognise.h"

#include "io/grid_header.h"
#include "io/gzip.h"
#include "io/strangers.h"
#include "io/table.h"
#include "io/text.h"
#include "io/text_numbers.h"
#include "io/text_values.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace g3r::io {

namespace {

constexpr std::array<std::string_view, 16> kObjKeywords = {"v", "vn", "vt",     "vp",     "f",    "l",      "p",   "o",
                                                           "g", "s",  "mtllib", "usemtl", "call", "cstype", "deg", "mg"};
constexpr std::array<std::string_view, 4> kPcdKeywords = {"VERSION", "FIELDS", "COLUMNS", "SIZE"};

// The first lines that are neither blank nor comments.
class Beginning {
 public:
  explicit Beginning(std::string_view bytes) : lines_(bytes) {}
  bool next(std::string_view& line) {
    while (lines_.next_filled(line)) {
      if (line[0] != '#' && line.substr(0, 2) != "//") return true;
    }
    return false;
  }

 private:
  Lines lines_;
};

std::string_view first_word(std::string_view line) {
  std::string_view word;
  Tokens(line).next(word);
  return word;
}

// "OFF", "COFF", "STCN4nOFF" and the like, alone or with the first count glued to it.
bool is_off_magic(std::string_view word) {
  const std::size_t off = word.find("OFF");
  if (off == std::string_view::npos || off > 6) return false;
  const std::string_view after = word.substr(off + 3);
  return word.substr(0, off).find_first_not_of("STCN4n") == std::string_view::npos &&
         (after.empty() || after == "BINARY" || after.find_first_not_of("0123456789") == std::string_view::npos);
}

// A line of a table: three numbers, wherever they stand.
bool is_row(std::string_view line) { return count_numbers(line, separator_of(line)) >= 3; }

// Whether the line starts with a number, in quotes or not, whatever separates it from the next.
bool starts_with_number(std::string_view line) {
  if (!line.empty() && line[0] == '"') line.remove_prefix(1);
  const std::size_t end = line.find_first_of(" \t,;");
  double value = 0;
  return parse_double(line.substr(0, end), value) || is_like_number(line);
}

// Whether files of this extension are lines of numbers, so that several lines of words may come first. Of others, which a damaged header
// may begin, one may.
bool is_table_name(std::string_view ext) {
  constexpr std::array<std::string_view, 11> kTables = {"csv", "txt", "xyz", "asc", "dat", "pts", "neu", "tsv", "xyzrgb", "xyzi", "xyzn"};
  return std::find(kTables.begin(), kTables.end(), ext) != kTables.end();
}

std::size_t count_fields(std::string_view line) {
  std::size_t fields = 0;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t,;", at)) != std::string_view::npos; ++fields) {
    at = std::min(line.find_first_of(" \t,;", at), line.size());
  }
  return fields;
}

// SPZ is recognised among gzip files by the first bytes inside.
bool is_spz(std::string_view bytes) { return bytes.substr(0, 2) == "\x1f\x8b" && Gunzip(bytes).read(4) == "NGSP"; }

// PTX starts with two whole numbers on lines of their own, of which the first is not 0 (PTS: a number, and as many lines of columns); then
// come four lines of three numbers and four lines of four. A shorter file is a PTX that is cut.
bool is_ptx(std::string_view bytes) {
  constexpr std::array<std::size_t, 8> kColumns = {3, 3, 3, 3, 4, 4, 4, 4};
  Lines lines(bytes);
  std::string_view line;
  std::uint64_t columns = 0;
  std::uint64_t rows = 0;
  if (!lines.next_filled(line) || !parse_integer(line, columns) || columns == 0) return false;
  if (!lines.next_filled(line) || !parse_integer(line, rows)) return false;
  for (const std::size_t count : kColumns) {
    if (!lines.next_filled(line)) return true;
    if (count_values(line, ' ') != count) return !lines.ended();
  }
  return true;
}

std::string magic_of(const std::string& ext) {
  if (ext == "ply") return "the PLY magic \"ply\"";
  if (ext == "npy") return "the NPY magic \"\\x93NUMPY\"";
  if (ext == "las" || ext == "laz") return "the LAS magic \"LASF\"";
  if (ext == "e57") return "the E57 magic \"ASTM-E57\"";
  if (ext == "off") return "the OFF magic \"OFF\"";
  if (ext == "ptx") return "a PTX header (columns, rows, position, axes and matrix of a scan)";
  if (ext == "grd") return "the header of an ASCII grid (ncols, nrows, xllcorner, yllcorner, cellsize)";
  if (ext == "spz") return "SPZ (gzip, with the magic \"NGSP\" inside)";
  if (ext == "pcd") return "a PCD header (\"# .PCD\", VERSION, FIELDS)";
  if (ext == "glb") return "the GLB magic \"glTF\"";
  if (ext == "stl") return "an STL file (\"solid\", or 84 bytes and 50 bytes for each triangle it declares)";
  if (ext == "obj") return "OBJ lines (v x y z) with vertices";
  return "lines of numbers (text), or the magic of PLY, PCD, OFF, OBJ, STL, NPY, LAS, E57 or glTF";
}

}  // namespace

std::string_view without_mark(std::string_view bytes) {
  if (bytes.substr(0, 3) == "\xef\xbb\xbf") bytes.remove_prefix(3);
  return bytes;
}

bool is_binary_stl(std::string_view bytes, std::uint64_t file_size) {
  constexpr std::size_t kHeader = 80;
  constexpr std::uint64_t kTriangle = 50;
  return bytes.size() >= kHeader + 4 && file_size == kHeader + 4 + kTriangle * load<std::uint32_t>(bytes.data() + kHeader);
}

Format recognise(const Source& source) {
  const std::string ext = extension(source.name);
  const std::string_view bytes = without_mark(source.bytes);
  if (bytes.empty()) fail(source, "empty file (0 bytes): expected " + magic_of(ext));
  if (is_spz(bytes)) return Format::kSpz;
  if (const char* const stranger = find_stranger(bytes)) fail(source, "expected " + magic_of(ext) + ", found " + stranger);
  if (bytes.substr(0, 4) == "ply\n" || bytes.substr(0, 4) == "ply\r" || bytes.substr(0, 4) == "ply ") return Format::kPly;
  if (bytes.substr(0, 6) == "\x93NUMPY") return Format::kNpy;
  if (bytes.substr(0, 4) == "LASF") return Format::kLas;
  if (bytes.substr(0, 8) == "ASTM-E57") return Format::kE57;
  if (bytes.substr(0, 4) == "glTF") return Format::kGlb;
  if (bytes.substr(0, 6) == "# .PCD") return Format::kPcd;
  if (is_binary_stl(bytes, bytes.size())) return Format::kStlBinary;
  if (is_ptx(bytes)) return Format::kPtx;
  if (is_ascii_grid(bytes)) return Format::kAsciiGrid;

  Beginning beginning(bytes);
  std::string_view line;
  if (!beginning.next(line)) fail(source, "no points: only blank lines and comments");
  const std::string_view word = first_word(line);
  if (std::find(kPcdKeywords.begin(), kPcdKeywords.end(), word) != kPcdKeywords.end()) return Format::kPcd;
  if (is_off_magic(word)) return Format::kOff;
  if (word == "solid") return Format::kStlText;
  if (line[0] == '{') return Format::kGltf;
  if (std::find(kObjKeywords.begin(), kObjKeywords.end(), word) != kObjKeywords.end()) return Format::kObj;
  const bool named = count_fields(line) >= 3;  // a header line of a table
  const auto is_data = [&] { return starts_with_number(line) || is_row(line); };
  const int headers = is_table_name(ext) ? kMostHeaderLines : named ? 1 : 0;
  for (int k = 0; k < headers && !is_data() && beginning.next(line);) ++k;
  if (is_data() && line.find('\0') == std::string_view::npos) return Format::kText;
  const bool binary = bytes.substr(0, 4096).find('\0') != std::string_view::npos;
  fail_at_byte(source, 0,
               "unknown format: expected " + magic_of(ext) + ", found " + (binary ? "binary data " : "") + quote(bytes.substr(0, 80)));
}

}  // namespace g3r::io
