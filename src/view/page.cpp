// view_html(): packs the scene as JSON and puts it, the style and the scripts of page/ into page/page.html.
#include "view/pack.h"
#include "view/scene.h"

#include <g3r/g3r.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

namespace g3r {
namespace view::files {
extern const std::string_view page_html, page_css, scene_js, render_js, figures_js, controls_js;
}  // namespace view::files

namespace {

using Bytes = std::vector<std::uint8_t>;
using Json = nlohmann::ordered_json;

// Indices of the points to show: all finite ones, or every so many of them.
std::vector<std::size_t> choose_points(const Scene& scene, std::size_t most, std::size_t& finite) {
  std::vector<std::size_t> all;
  all.reserve(scene.points.size());
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (view::is_finite(scene.points[i])) all.push_back(i);
  }
  finite = all.size();
  if (finite <= most) return all;
  std::vector<std::size_t> chosen(most);
  const double step = static_cast<double>(finite) / static_cast<double>(most);
  for (std::size_t i = 0; i < most; ++i) chosen[i] = all[static_cast<std::size_t>(static_cast<double>(i) * step)];
  return chosen;
}

template <class Append>
std::string packed(const std::vector<std::size_t>& chosen, const Append& append) {
  Bytes bytes;
  for (const std::size_t i : chosen) append(bytes, i);
  return view::base64(bytes);
}

Json points_json(const Scene& scene, const view::Box& box, std::size_t most) {
  std::size_t finite = 0;
  const std::vector<std::size_t> chosen = choose_points(scene, most, finite);
  Json json = {{"given", scene.points.size()}, {"finite", finite}, {"shown", chosen.size()}, {"spacing", 0.0}};
  if (chosen.empty()) return json;
  json["spacing"] = view::estimate_spacing(scene.points, box) * std::sqrt(static_cast<double>(finite) / static_cast<double>(chosen.size()));
  json["position"] = packed(chosen, [&](Bytes& out, std::size_t i) { view::append_position(out, scene.points[i], box); });
  if (!scene.normals.empty()) {
    json["normal"] = packed(chosen, [&](Bytes& out, std::size_t i) { view::append_normal(out, scene.normals[i]); });
  }
  if (!scene.confidence.empty()) {
    json["confidence"] = packed(chosen, [&](Bytes& out, std::size_t i) { view::append_unit(out, scene.confidence[i]); });
  }
  if (!scene.colors.empty()) {
    json["color"] =
        packed(chosen, [&](Bytes& out, std::size_t i) { out.insert(out.end(), scene.colors[i].begin(), scene.colors[i].end()); });
  }
  if (!scene.normals.empty() && !scene.true_normals.empty()) {
    json["error"] = packed(
        chosen, [&](Bytes& out, std::size_t i) { view::append_unit(out, view::normal_error(scene.normals[i], scene.true_normals[i])); });
  }
  return json;
}

// Figures over all points, shown or not.
Json truth_json(const Scene& scene) {
  if (scene.normals.empty() || scene.true_normals.empty()) return nullptr;
  std::size_t compared = 0, wrong = 0;
  double sum = 0;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (!view::is_finite(scene.points[i])) continue;
    const float error = view::normal_error(scene.normals[i], scene.true_normals[i]);
    ++compared;
    wrong += error > 0.5F ? 1 : 0;
    sum += error;
  }
  return {{"compared", compared}, {"wrong_side", wrong}, {"mean_error", compared > 0 ? sum / static_cast<double>(compared) : 0}};
}

Json mesh_json(const Mesh& mesh, const view::Box& box, std::size_t most) {
  const std::size_t count = mesh.triangles.size();
  if (count == 0) return nullptr;
  Json json = {{"given", count}, {"shown", count <= most ? count : 0}, {"vertices", mesh.vertices.size()}};
  if (count > most) return json;
  Bytes positions, triangles, colors, confidence;
  for (const Vec3& p : mesh.vertices) view::append_position(positions, p, box);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) view::append_index(triangles, v);
  }
  json["position"] = view::base64(positions);
  json["triangle"] = view::base64(triangles);
  for (const auto& c : mesh.colors) colors.insert(colors.end(), c.begin(), c.end());
  if (!colors.empty()) json["color"] = view::base64(colors);
  for (const float c : mesh.confidence) view::append_unit(confidence, c);
  if (!confidence.empty()) json["confidence"] = view::base64(confidence);
  return json;
}

// The report as a value. What nests deeper than any report is refused, as writing it would use up the stack.
Json parse_report(const std::string& text) {
  constexpr int kDeepest = 64;  // Reports need four.
  const auto shallow = [](int depth, Json::parse_event_t, const Json&) {
    if (depth > kDeepest) throw InvalidInput("view: the report is nested too deeply");
    return true;
  };
  Json report = Json::parse(std::string_view(text), shallow, false);
  if (report.is_discarded()) throw InvalidInput("view: the report is not JSON");
  const auto schema = report.is_object() ? report.find("schema") : report.end();
  if (schema == report.end() || *schema != "g3r.report")
    throw InvalidInput("view: the report is not one of g3r: its schema is not g3r.report");
  return report;
}

// JSON that may stand inside a <script> element: no "<" is left in it.
std::string script_safe(const Json& json) {
  std::string safe;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string escape_html(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

// Replaces every "{{name}}" of the template; one pass, so that inserted text is never searched.
std::string fill(std::string_view page, const std::vector<std::pair<std::string_view, std::string_view>>& values) {
  std::string out;
  for (std::size_t at = 0;;) {
    const std::size_t open = page.find("{{", at);
    out += page.substr(at, open - at);
    if (open == std::string_view::npos) return out;
    const std::size_t close = page.find("}}", open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    for (const auto& [key, value] : values) {
      if (key == name) out += value;
    }
    at = close + 2;
  }
}

}  // namespace

std::string view_html(const Scene& scene, const PageOptions& options) {
  const view::Box box = view::check_scene(scene);
  const Json report = scene.report.empty() ? Json(nullptr) : parse_report(scene.report);
  const std::string title = scene.title.empty() ? "g3r" : scene.title;
  const Json json = {{"title", title},
                     {"version", std::string(version())},
                     {"up", options.up == Up::kZ ? "z" : "y"},
                     {"low", box.low},
                     {"high", box.high},
                     {"side", box.longest_side()},
                     {"points", points_json(scene, box, options.max_points)},
                     {"mesh", mesh_json(scene.mesh, box, options.max_triangles)},
                     {"truth", truth_json(scene)},
                     {"report", report}};
  const std::string data = script_safe(json);
  const std::string name = escape_html(title);
  return fill(view::files::page_html, {{"title", name},
                                       {"style", view::files::page_css},
                                       {"scene", view::files::scene_js},
                                       {"render", view::files::render_js},
                                       {"figures", view::files::figures_js},
                                       {"controls", view::files::controls_js},
                                       {"data", data}});
}

}  // namespace g3r
