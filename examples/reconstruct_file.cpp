// reconstruct_file IN OUT: a file of points in, a file with a mesh out.
#include <g3r/g3r.h>
#include <g3r/io.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 3) return std::fputs("usage: reconstruct_file IN OUT\n", stderr), 64;
  try {
    const g3r::Cloud cloud = g3r::read_cloud(argv[1]);
    const g3r::Reconstruction r = g3r::reconstruct(cloud.positions);
    g3r::write_mesh(argv[2], r.mesh);
    std::printf("%zu triangles, %s, genus %ld\n", r.check.triangles, r.check.closed ? "closed" : "not closed", r.check.genus);
    for (const std::string& warning : r.orientation.stats.warnings) std::printf("warning: %s\n", warning.c_str());
  } catch (const g3r::Error& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 1;
  }
}
