#include "io/strangers.h"

namespace g3r::io {

namespace {

using std::string_view_literals::operator""sv;

struct Signature {
  std::string_view magic;
  const char* what;
};

constexpr Signature kStrangers[] = {
    {"\x1f\x8b"sv, "a gzip-compressed file; unpack it first"},
    {"PK\x03\x04"sv, "a zip archive (compressed); unpack it first"},
    {"BZh"sv, "a bzip2-compressed file; unpack it first"},
    {"\xfd"
     "7zXZ"sv,
     "an xz-compressed file; unpack it first"},
    {"(\xb5/\xfd"sv, "a zstd-compressed file; unpack it first"},
    {"x\x01"sv, "zlib-compressed data; uncompress it first"},
    {"x\x5e"sv, "zlib-compressed data; uncompress it first"},
    {"x\x9c"sv, "zlib-compressed data; uncompress it first"},
    {"x\xda"sv, "zlib-compressed data; uncompress it first"},
    {"NGSP"sv, "an SPZ file of version 4 or later, which g3r does not read; save it as version 3 or as PLY"},
    {"version https://git-lfs"sv, "a git-lfs pointer, not the file itself; run \"git lfs pull\""},
    {"<!DOCTYPE"sv, "an HTML page; the download failed"},
    {"<!doctype"sv, "an HTML page; the download failed"},
    {"<html"sv, "an HTML page; the download failed"},
    {"<?xml"sv, "an XML file, which is no point format"},
    {"# vtk DataFile"sv, "a VTK file; save it as PLY, for example with ParaView"},
    {"  0\nSECTION"sv, "a DXF drawing; save its points as text, one a line"},
    {"  0\r\nSECTION"sv, "a DXF drawing; save its points as text, one a line"},
    {"0\nSECTION"sv, "a DXF drawing; save its points as text, one a line"},
    {"0\r\nSECTION"sv, "a DXF drawing; save its points as text, one a line"},
    {"DSAA"sv, "a Surfer grid; save it as an ASCII grid of Arc/Info, for example with GDAL"},
    {"DSBB"sv, "a Surfer grid; save it as an ASCII grid of Arc/Info, for example with GDAL"},
    {"DSRB"sv, "a Surfer grid; save it as an ASCII grid of Arc/Info, for example with GDAL"},
    {"%PDF"sv, "a PDF file"},
    {"\x89HDF"sv, "an HDF5 file"},
    {"\xff\xfe"sv, "UTF-16 text; save it as UTF-8"},
    {"\xfe\xff"sv, "UTF-16 text; save it as UTF-8"},
};

}  // namespace

const char* find_stranger(std::string_view bytes) {
  for (const Signature& stranger : kStrangers) {
    if (bytes.starts_with(stranger.magic)) return stranger.what;
  }
  return nullptr;
}

}  // namespace g3r::io
