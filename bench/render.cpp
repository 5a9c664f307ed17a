// render IN... -o out.png [--z-up] [--dark] [--tile PIXELS] [--points]: four views of each file (out.png, out.1.png, ...).
// A file with triangles is drawn as a mesh; --points draws its vertices instead.
#include <g3r/io.h>
#include <g3r/view.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

namespace {

g3r::Scene read_scene(const std::string& path, bool points_only) {
  g3r::Scene scene;
  if (!points_only) {
    try {
      scene.mesh = g3r::read_mesh(path);
      return scene;
    } catch (const g3r::InvalidInput&) {  // no triangles: a cloud
    }
  }
  g3r::Cloud cloud = g3r::read_cloud(path);
  scene.points = std::move(cloud.positions);
  scene.normals = std::move(cloud.normals);
  scene.colors = std::move(cloud.colors);
  return scene;
}

int run(const std::vector<std::string>& arguments) {
  std::vector<std::string> inputs;
  std::string output;
  g3r::PictureOptions options;
  bool points_only = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& a = arguments[i];
    if (a == "-o" && i + 1 < arguments.size()) {
      output = arguments[++i];
    } else if (a == "--tile" && i + 1 < arguments.size()) {
      options.tile = std::atoi(arguments[++i].c_str());
    } else if (a == "--z-up") {
      options.up = g3r::Up::kZ;
    } else if (a == "--dark") {
      options.dark = true;
    } else if (a == "--points") {
      points_only = true;
    } else {
      inputs.push_back(a);
    }
  }
  if (inputs.empty() || output.empty()) {
    std::cerr << "usage: render IN... -o OUT.png [--z-up] [--dark] [--tile PIXELS] [--points]\n";
    return 64;
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::vector<std::uint8_t> png = g3r::view_png(read_scene(inputs[i], points_only), options);
    std::filesystem::path path = output;  // out.png, then out.1.png, out.2.png, ...
    if (i > 0) path.replace_extension(std::to_string(i) + path.extension().string());
    g3r::write_file(path.string(), std::string(png.begin(), png.end()));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "render: " << error.what() << "\n";
    return 1;
  }
}
