// g3r view IN... -o OUT: a page (.html) or a picture (.png) of a cloud, a mesh, or both.
#include "base/platform.h"
#include "io/source.h"

#include <g3r/io.h>
#include <g3r/view.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "commands.h"
#include "exit_code.h"
#include "files.h"
#include "text.h"

namespace g3r::cli {
namespace {

Cloud read_and_warn(const std::string& path, const Input& input, const ReadOptions& options, Console& console) {
  Cloud cloud = input.cloud(options);
  for (const std::string& warning : cloud.warnings) console.warn(escape_text(path) + ": " + warning);
  return cloud;
}

void add_cloud(const std::string& path, const Input& input, const ReadOptions& options, Scene& scene, Console& console) {
  if (!scene.points.empty()) throw UsageError("view shows one cloud and one mesh; " + path + " is a second cloud");
  Cloud cloud = read_and_warn(path, input, options, console);
  scene.points = std::move(cloud.positions);
  scene.normals = std::move(cloud.normals);
  scene.confidence = std::move(cloud.confidence);
  scene.colors = std::move(cloud.colors);
}

void add_file(const std::string& path, const ReadOptions& options, Scene& scene, Console& console) {
  const Input input(path);
  auto [mesh, refused] = input.mesh();
  if (!refused.empty()) console.warn("shown as points: " + refused);
  if (!mesh) return add_cloud(path, input, options, scene, console);
  if (!scene.mesh.triangles.empty()) throw UsageError("view shows one cloud and one mesh; " + path + " is a second mesh");
  scene.mesh = std::move(*mesh);
}

void add_truth(const std::string& path, const ReadOptions& options, Scene& scene, Console& console) {
  Cloud truth = read_and_warn(path, Input(path), options, console);
  if (truth.normals.empty()) throw InvalidInput(path + ": has no normals to compare with");
  if (truth.normals.size() != scene.points.size()) {
    throw InvalidInput(path + ": " + std::to_string(truth.normals.size()) + " points, but the cloud has " +
                       std::to_string(scene.points.size()));
  }
  scene.true_normals = std::move(truth.normals);
}

std::string read_text(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(platform::path_of(path), std::ios::binary).rdbuf();
  return text.str();
}

Scene read_scene(const Settings& settings, Session& session) {
  const ReadOptions options = session.cancellable(settings.read_options);
  Console& console = session.console();
  Scene scene;
  for (const std::string& path : settings.shown) {
    const std::string name = path == "-" ? "standard input" : platform::name_of(platform::path_of(path).filename());
    scene.title += (scene.title.empty() ? "" : ", ") + name;
    add_file(path, options, scene, console);
  }
  if (!settings.truth.empty()) add_truth(settings.truth, options, scene, console);
  if (!settings.figures.empty()) scene.report = read_text(settings.figures);
  return scene;
}

}  // namespace

int run_view(const Settings& settings, Session& session) {
  const Scene scene = session.stage("read", [&] { return read_scene(settings, session); });
  const bool picture = io::extension(settings.output) == "png";
  const std::size_t triangles = scene.mesh.triangles.size();
  if (!picture && triangles > settings.page.max_triangles) {
    session.console().warn("the mesh is not in the page: it has " + counted(triangles, "triangle") + ", and a page shows " +
                           with_commas(settings.page.max_triangles) + " at most; a picture (.png) shows them all");
  }
  const std::string bytes = session.stage("draw", [&] {
    if (!picture) return view_html(scene, settings.page);
    PictureOptions options = settings.picture;
    options.threads = settings.options.threads;
    const std::vector<std::uint8_t> png = view_png(scene, options);
    return std::string(png.begin(), png.end());
  });
  session.stage("write", [&] { write_text(settings.output, bytes); });
  session.console().say("wrote " + settings.output);
  return kOk;
}

}  // namespace g3r::cli
