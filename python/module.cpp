// The extension module: each function turns arrays into views, calls the library once and gives the result away. What users see is
// python/g3r/*.py.
#include <g3r/g3r.h>
#include <g3r/io.h>
#include <g3r/metrics.h>
#include <g3r/names.h>
#include <g3r/view.h>

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "job.h"
#include "options.h"
#include "text.h"
#include "tiles.h"

namespace g3r::python {
namespace {

using Text = std::string;

// The value of an option that is one of a few words: g3r/names.h.
template <class T>
void take_choice(const nb::dict& from, const char* name, T& into) {
  if (!from.contains(name)) return;
  Text word;
  take(from, name, word);
  const std::optional<T> value = parse<T>(word);
  if (!value) throw InvalidInput(Text(name) + " must be one of " + words<T>("'") + ", not '" + word + "'");
  into = *value;
}

// A length: a number in input units, or what parse_length() takes.
void take_length(const nb::dict& from, const char* name, bool may_be_zero, Length& into) {
  if (!from.contains(name)) return;
  const nb::object given = from[name];
  const std::optional<Length> length = parse_length(nb::cast<Text>(nb::str(given)));
  if (!length || (length->value == 0 && length->unit != Length::Unit::kAuto && !may_be_zero)) {
    throw InvalidInput(Text(name) + " must be 'auto', a number " + (may_be_zero ? "0 or more" : "above 0") +
                       ", 'X%', 'Xh' (point spacings) or 'Xn' (normalised), not " + nb::cast<Text>(nb::repr(given)));
  }
  into = *length;
}

Options read_options(const nb::dict& from) {
  Options options;
  take_choice(from, "preset", options.preset);
  take_choice(from, "method", options.method);
  take(from, "wnnc_widths", options.wnnc_widths);
  take_choice(from, "solver", options.solver);
  take_length(from, "epsilon", false, options.epsilon);
  take_length(from, "noise", true, options.noise);
  take(from, "degree", options.degree);
  take(from, "harmonics", options.harmonics);
  take(from, "schedule", options.schedule);
  take(from, "tolerance", options.tolerance);
  take(from, "accuracy", options.accuracy);
  take(from, "condition_number", options.condition_number);
  take(from, "threads", options.threads);
  take(from, "device", options.device);
  take(from, "max_memory", options.max_memory);
  options.hints = read_hints(from);
  return options;
}

MeshOptions read_mesh_options(const nb::dict& from) {
  MeshOptions options;
  take_choice(from, "mesher", options.mesher);
  take_choice(from, "trim", options.trim);
  take(from, "trim_distance", options.trim_distance);
  take(from, "depth", options.depth);
  take(from, "keep_largest", options.keep_largest);
  take(from, "min_component", options.min_component);
  take(from, "faces", options.faces);
  take(from, "keep_all", options.keep_all);
  take_length(from, "noise", true, options.noise);
  take(from, "threads", options.threads);
  take(from, "device", options.device);
  take(from, "max_memory", options.max_memory);
  return options;
}

// What is known of the points before the solve comes first.
void prepend(const std::vector<Text>& warnings, Stats& stats) {
  stats.warnings.insert(stats.warnings.begin(), warnings.begin(), warnings.end());
}

nb::tuple give_mesh(Mesh&& mesh) {
  const nb::object none = nb::none();
  return nb::make_tuple(give_rows(std::move(mesh.vertices)), give_rows(std::move(mesh.triangles)),
                        mesh.colors.empty() ? none : nb::cast(give_rows(std::move(mesh.colors))),
                        mesh.confidence.empty() ? none : nb::cast(give_values(std::move(mesh.confidence))));
}

// (normals, areas, confidence, report)
nb::tuple orient_points(const PointsArray& array, const nb::dict& keywords, const std::vector<Text>& warnings, const nb::object& progress) {
  const PointsView points = points_view(array);
  const Options options = read_options(keywords);
  Orientation result;
  run_job(progress, [&](const Monitor& monitor) { result = orient(points, options, monitor); });
  prepend(warnings, result.stats);
  const Text report = report_json(result.stats);
  return nb::make_tuple(give_rows(std::move(result.normals)), give_values(std::move(result.areas)),
                        give_values(std::move(result.confidence)), report);
}

// (normals, areas, confidence, report, mesh)
nb::tuple reconstruct_points(const PointsArray& array, const std::optional<Rows<std::uint8_t>>& colors, const nb::dict& keywords,
                             const std::vector<Text>& warnings, const nb::object& progress) {
  const PointsView points = points_view(array);
  const Options options = read_options(keywords);
  const MeshOptions mesh_options = read_mesh_options(keywords);
  const auto point_colors = copy_rows<std::uint8_t>(colors);
  Reconstruction result;
  run_job(progress, [&](const Monitor& monitor) {
    result = reconstruct(points, options, mesh_options, monitor);
    if (!point_colors.empty()) {
      carry_attributes(result.mesh, points, point_colors, result.orientation.confidence, {{}, monitor.cancel}, result.orientation.normals);
    }
  });
  Orientation& o = result.orientation;
  prepend(warnings, o.stats);
  const Text report = report_json(o.stats, &result.check);
  return nb::make_tuple(give_rows(std::move(o.normals)), give_values(std::move(o.areas)), give_values(std::move(o.confidence)), report,
                        give_mesh(std::move(result.mesh)));
}

nb::tuple mesh_points(const PointsArray& array, const PointsArray& normals, const nb::dict& keywords, const nb::object& progress) {
  const MeshOptions options = read_mesh_options(keywords);
  const PointsView points = points_view(array), directions = points_view(normals);
  Mesh mesh;
  MeshReport report;
  run_job(progress, [&](const Monitor& monitor) { mesh = mesh_oriented(points, directions, options, monitor, &report); });
  warn_caller(report.stats.warnings);
  return give_mesh(std::move(mesh));
}

Field make_field(const PointsArray& array, const Rows<double>& normals, const Values<double>& areas, double width, const Text& device) {
  Orientation orientation;
  orientation.normals = copy_rows<double>(normals);
  orientation.areas = copy_values<double>(areas);
  const PointsView points = points_view(array);
  const nb::gil_scoped_release release;
  return Field(points, orientation, width, device);
}

auto field_value(const Field& field, const PointsArray& queries) {
  const PointsView view = points_view(queries);
  std::vector<double> values;
  run_job(nb::none(), [&](const Monitor& monitor) { values = field.value(view, monitor); });
  return give_values(std::move(values));
}

auto field_gradient(const Field& field, const PointsArray& queries) {
  const PointsView view = points_view(queries);
  std::vector<Vec3> gradients;
  run_job(nb::none(), [&](const Monitor& monitor) { gradients = field.gradient(view, monitor); });
  return give_rows(std::move(gradients));
}

std::shared_ptr<Cloud> read_points(const nb::bytes& path, double min_opacity, bool all_splats,
                                   const std::optional<std::array<double, 6>>& box, int levels, int threads) {
  ReadOptions options;
  options.min_opacity = min_opacity;
  options.all_splats = all_splats;
  if (box) options.box = Box{{(*box)[0], (*box)[1], (*box)[2]}, {(*box)[3], (*box)[4], (*box)[5]}};
  options.levels = levels;
  options.threads = threads;
  const Text name = name_of(path);
  std::shared_ptr<Cloud> cloud;
  run_job(nb::none(), [&](const Monitor& monitor) {
    options.cancel = monitor.cancel;
    cloud = std::make_shared<Cloud>(read_cloud(name, options));
  });
  return cloud;
}

void write_points(const nb::bytes& path, const std::shared_ptr<Cloud>& source, const std::optional<PointsArray>& positions,
                  const std::optional<PointsArray>& normals, const std::optional<Rows<std::uint8_t>>& colors,
                  const std::optional<Values<float>>& confidence, bool ascii, bool cloud_compare_names) {
  Cloud fresh;
  if (!source) {
    if (!positions) throw InvalidInput("there are no points to write");
    fresh.positions = copy_points(positions);
    fresh.colors = copy_rows<std::uint8_t>(colors);
    fresh.scalar = positions->dtype() == nb::dtype<float>() ? Scalar::kFloat32 : Scalar::kFloat64;
  }
  const std::vector<Vec3> directions = copy_points(normals);
  const std::vector<float> trust = copy_values<float>(confidence);
  WriteOptions options{ascii, cloud_compare_names};
  std::vector<Text> warnings;
  options.warnings = &warnings;
  const Text name = name_of(path);
  {
    const nb::gil_scoped_release release;
    write_cloud(name, source ? *source : fresh, directions.empty() ? nullptr : &directions, trust.empty() ? nullptr : &trust, options);
  }
  warn_caller(warnings);
}

Mesh copy_mesh(const std::optional<PointsArray>& vertices, const std::optional<Rows<std::uint32_t>>& faces,
               const std::optional<Rows<std::uint8_t>>& colors, const std::optional<Values<float>>& confidence) {
  return {copy_points(vertices), copy_rows<std::uint32_t>(faces), copy_rows<std::uint8_t>(colors), copy_values<float>(confidence)};
}

void write_faces(const nb::bytes& path, const PointsArray& vertices, const Rows<std::uint32_t>& faces,
                 const std::optional<Rows<std::uint8_t>>& colors, const std::optional<Values<float>>& confidence, bool ascii) {
  const Mesh mesh = copy_mesh(vertices, faces, colors, confidence);
  const Text name = name_of(path);
  const nb::gil_scoped_release release;
  write_mesh(name, mesh, WriteOptions{ascii, false});
}

nb::tuple read_faces(const nb::bytes& path) {
  const Text name = name_of(path);
  Mesh mesh;
  {
    const nb::gil_scoped_release release;
    mesh = read_mesh(name);
  }
  return give_mesh(std::move(mesh));
}

nb::dict score_directions(const PointsArray& normals, const PointsArray& truth) {
  const NormalScore score = score_normals(copy_points(normals), copy_points(truth));
  nb::dict out;
  out["ae_p"] = score.ae;
  out["pco"] = score.pco;
  out["rmse"] = score.rmse;
  out["rmse_unoriented"] = score.rmse_unoriented;
  out["pgp5"] = score.pgp5;
  out["pgp10"] = score.pgp10;
  return out;
}

nb::dict score_faces(const PointsArray& vertices, const Rows<std::uint32_t>& faces, const PointsArray& true_vertices,
                     const Rows<std::uint32_t>& true_faces, std::size_t samples, std::uint64_t seed, const std::vector<double>& distances) {
  const Mesh mesh{copy_points(vertices), copy_rows<std::uint32_t>(faces), {}, {}};
  const Mesh truth{copy_points(true_vertices), copy_rows<std::uint32_t>(true_faces), {}, {}};
  MeshScore score;
  run_job(nb::none(), [&](const Monitor& monitor) { score = score_mesh(mesh, truth, {samples, seed, distances}, monitor); });
  nb::dict out;
  out["cd"] = score.chamfer;
  out["ae_m"] = score.ae;
  out["hd"] = score.hausdorff;
  out["normal_consistency"] = score.normal_consistency;
  nb::list f_scores;
  for (const FScore& f : score.f_scores) {
    nb::dict at;
    at["distance"] = f.distance;
    at["precision"] = f.precision;
    at["recall"] = f.recall;
    at["f"] = f.f;
    f_scores.append(at);
  }
  out["f_scores"] = f_scores;
  return out;
}

struct PyScene {
  Scene scene;
};

PyScene make_scene(const Text& title, const std::optional<PointsArray>& points, const std::optional<PointsArray>& normals,
                   const std::optional<Values<float>>& confidence, const std::optional<Rows<std::uint8_t>>& colors,
                   const std::optional<PointsArray>& true_normals, const std::optional<PointsArray>& vertices,
                   const std::optional<Rows<std::uint32_t>>& faces, const std::optional<Rows<std::uint8_t>>& vertex_colors,
                   const std::optional<Values<float>>& vertex_confidence, const Text& report) {
  return {{title, copy_points(points), copy_points(normals), copy_values<float>(confidence), copy_rows<std::uint8_t>(colors),
           copy_points(true_normals), copy_mesh(vertices, faces, vertex_colors, vertex_confidence), report}};
}

// An exception class of g3r/_errors.py.
nb::object error_class(const char* name) { return nb::module_::import_("g3r._errors").attr(name); }

void translate_error(const std::exception_ptr& pointer, void* /*unused*/) {
  const auto raise = [](const char* name, const char* what) { PyErr_SetString(error_class(name).ptr(), what); };
  try {
    std::rethrow_exception(pointer);
  } catch (const NoFaces& error) {
    raise("NoFaces", error.what());
  } catch (const InvalidInput& error) {
    raise("InputError", error.what());
  } catch (const IoError& error) {
    raise(error.kind() == IoError::Kind::kNotFound ? "FileMissingError" : "FileError", error.what());
  } catch (const Unavailable& error) {
    raise("UnavailableError", error.what());
  } catch (const Cancelled& error) {
    raise("Cancelled", error.what());
  } catch (const Error& error) {
    raise("Error", error.what());
  }
}

// A (n,) view of a member of a cloud, kept alive by it; None if it is empty.
template <class T>
nb::object values_of(const nb::handle& owner, const std::vector<T>& values) {
  if (values.empty()) return nb::none();
  return nb::cast(nb::ndarray<nb::numpy, const T, nb::ndim<1>>(values.data(), {values.size()}, owner));
}

// A (n, 3) view of a member of a cloud, kept alive by it; None if it is empty.
template <class T>
nb::object rows_of(const nb::handle& owner, const std::vector<std::array<T, 3>>& rows) {
  if (rows.empty()) return nb::none();
  return nb::cast(nb::ndarray<nb::numpy, const T, nb::ndim<2>>(rows.data(), {rows.size(), 3}, owner));
}

// (name, driver, software, memory) of every device.
std::vector<std::tuple<Text, Text, bool, std::size_t>> devices() {
  const nb::gil_scoped_release release;
  std::vector<std::tuple<Text, Text, bool, std::size_t>> out;
  for (const ComputeDevice& d : compute_devices()) out.emplace_back(d.name, d.driver, d.software, d.memory);
  return out;
}

// The members of BuildInfo, in order.
std::tuple<bool, bool, bool, Text, bool, bool> module_build_info() {
  const BuildInfo info = build_info();
  return {info.laz, info.e57, info.poisson, info.instruction_set, info.opencl, info.cuda};
}

void bind(nb::module_& m) {
  m.attr("__version__") = Text(version());
  nb::register_exception_translator(translate_error);

  nb::class_<Field>(m, "Field").def("value", &field_value).def("gradient", &field_gradient);
  nb::class_<PyScene>(m, "Scene");
  nb::class_<Cloud>(m, "Cloud")
      .def_prop_ro("points", [](nb::handle self) { return rows_of(self, nb::cast<const Cloud&>(self).positions); })
      .def_prop_ro("normals", [](nb::handle self) { return rows_of(self, nb::cast<const Cloud&>(self).normals); })
      .def_prop_ro("colors", [](nb::handle self) { return rows_of(self, nb::cast<const Cloud&>(self).colors); })
      .def_prop_ro("confidence", [](nb::handle self) { return values_of(self, nb::cast<const Cloud&>(self).confidence); })
      .def_prop_ro("sensor_positions", [](nb::handle self) { return rows_of(self, nb::cast<const Cloud&>(self).sensor_positions); })
      .def_prop_ro("scan_of_point", [](nb::handle self) { return values_of(self, nb::cast<const Cloud&>(self).scan_of_point); })
      .def_ro("format", &Cloud::format)
      .def_prop_ro("property_names", [](const Cloud& self) { return exact_texts(self.property_names); })
      .def_prop_ro("warnings", [](const Cloud& self) { return printable(self.warnings); });

  m.def("orient", &orient_points, nb::arg("points"), nb::arg("options"), nb::arg("warnings"), nb::arg("progress").none());
  m.def("reconstruct", &reconstruct_points, nb::arg("points"), nb::arg("colors").none(), nb::arg("options"), nb::arg("warnings"),
        nb::arg("progress").none());
  m.def("mesh", &mesh_points, nb::arg("points"), nb::arg("normals"), nb::arg("options"), nb::arg("progress").none());
  m.def("devices", &devices);
  m.def("build_info", &module_build_info);
  m.def("field", &make_field, nb::arg("points"), nb::arg("normals"), nb::arg("areas"), nb::arg("width"), nb::arg("device"));
  m.def("read_cloud", &read_points, nb::arg("path"), nb::arg("min_opacity"), nb::arg("all_splats"), nb::arg("box").none(),
        nb::arg("levels"), nb::arg("threads"));
  m.def("write_cloud", &write_points, nb::arg("path"), nb::arg("source").none(), nb::arg("positions").none(), nb::arg("normals").none(),
        nb::arg("colors").none(), nb::arg("confidence").none(), nb::arg("ascii"), nb::arg("cloud_compare_names"));
  m.def("score_normals", &score_directions, nb::arg("normals"), nb::arg("truth"));
  m.def("score_mesh", &score_faces, nb::arg("vertices"), nb::arg("faces"), nb::arg("true_vertices"), nb::arg("true_faces"),
        nb::arg("samples"), nb::arg("seed"), nb::arg("distances"));
  m.def("read_mesh", &read_faces, nb::arg("path"));
  m.def("write_mesh", &write_faces, nb::arg("path"), nb::arg("vertices"), nb::arg("faces"), nb::arg("colors").none(),
        nb::arg("confidence").none(), nb::arg("ascii"));
  m.def("scene", &make_scene, nb::arg("title"), nb::arg("points").none(), nb::arg("normals").none(), nb::arg("confidence").none(),
        nb::arg("colors").none(), nb::arg("true_normals").none(), nb::arg("vertices").none(), nb::arg("faces").none(),
        nb::arg("vertex_colors").none(), nb::arg("vertex_confidence").none(), nb::arg("report"));
  m.def(
      "write_file",
      [](const nb::bytes& path, const nb::bytes& data) {
        write_file(name_of(path), {data.c_str(), data.size()});
      },
      nb::arg("path"), nb::arg("data"));
  m.def(
      "view_html",
      [](const PyScene& scene, bool z_up, std::size_t max_points) {
        PageOptions options;
        options.up = z_up ? Up::kZ : Up::kY;
        options.max_points = max_points;
        const nb::gil_scoped_release release;
        return view_html(scene.scene, options);
      },
      nb::arg("scene"), nb::arg("z_up"), nb::arg("max_points"));
  m.def(
      "view_png",
      [](const PyScene& scene, bool z_up, int tile) {
        PictureOptions options;
        options.up = z_up ? Up::kZ : Up::kY;
        options.tile = tile;
        std::vector<std::uint8_t> png;
        {
          const nb::gil_scoped_release release;
          png = view_png(scene.scene, options);
        }
        return nb::bytes(png.data(), png.size());
      },
      nb::arg("scene"), nb::arg("z_up"), nb::arg("tile"));
  bind_tiles(m);
}

}  // namespace
}  // namespace g3r::python

NB_MODULE(_g3r, m) { g3r::python::bind(m); }
