// read_tool IN OUT: reads a cloud and writes it again, its finite points only if some are not. The judge of tests/badinputs runs it where
// only reading is in question.
#include <g3r/io.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>
#include <new>

namespace {

bool is_finite(const g3r::Vec3& p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

int convert(const std::string& in, const std::string& out) {
  g3r::check_output(out, {in}, false);
  const g3r::Cloud cloud = g3r::read_cloud(in);
  for (const std::string& warning : cloud.warnings) std::cerr << "read_tool: warning: " << g3r::escape_text(in) << ": " << warning << "\n";
  const auto odd =
      cloud.positions.size() - static_cast<std::size_t>(std::count_if(cloud.positions.begin(), cloud.positions.end(), is_finite));
  if (odd != 0) std::cerr << "read_tool: warning: " << g3r::escape_text(in) << ": " << odd << " points are not finite (NaN or inf)\n";
  const bool odd_normal = std::any_of(cloud.normals.begin(), cloud.normals.end(), [](const g3r::Vec3& n) { return !is_finite(n); });
  if (odd == 0 && !odd_normal) {
    g3r::write_cloud(out, cloud, nullptr, nullptr);
    return 0;
  }
  g3r::Cloud finite;
  std::copy_if(cloud.positions.begin(), cloud.positions.end(), std::back_inserter(finite.positions), is_finite);
  g3r::write_cloud(out, finite, nullptr, nullptr);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 64;
  try {
    return convert(argv[1], argv[2]);
  } catch (const g3r::InvalidInput& error) {
    std::cerr << "read_tool: " << error.what() << "\n";
    return 65;
  } catch (const g3r::IoError& error) {
    std::cerr << "read_tool: " << error.what() << "\n";
    return 74;
  } catch (const std::bad_alloc&) {
    std::cerr << "read_tool: out of memory\n";
    return 71;
  }
}
