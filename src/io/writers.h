// One writer per format. The data are checked; the file is committed by the caller.
#pragma once

#include "io/columns.h"
#include "io/las_output.h"
#include "io/output_file.h"
#include "io/rows.h"

namespace g3r::io {

void write_ply(const PointData& data, OutputFile& file);
/// The parts of write_ply() for a binary file of points alone, whose rows write_rows() may write some at a time.
std::vector<Column> ply_columns(const PointData& data);
std::string ply_header(const std::vector<std::string>& comments, std::uint64_t points, const std::vector<Column>& columns);
void write_xyz(const PointData& data, char separator, bool counted, OutputFile& file);
void write_pcd(const PointData& data, OutputFile& file);
void write_npy(const PointData& data, OutputFile& file);
void write_las(const PointData& data, LasOutput& out);
void write_obj(const PointData& data, OutputFile& file);

void write_ply_mesh(const Mesh& mesh, bool ascii, OutputFile& file);
void write_obj_mesh(const Mesh& mesh, OutputFile& file);
void write_off_mesh(const Mesh& mesh, OutputFile& file);
void write_glb_mesh(const Mesh& mesh, OutputFile& file);
void write_stl_mesh(const Mesh& mesh, bool ascii, OutputFile& file);

}  // namespace g3r::io
