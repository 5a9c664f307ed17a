#include "io/tiles.h"

#include "io/cloud_from_table.h"
#include "io/table.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include <glob.h>

namespace g3r::io {

namespace {

namespace fs = std::filesystem;

// No .txt and .obj: folders hold texts that are no points, and meshes.
constexpr std::array<std::string_view, 11> kExtensions = {"las", "laz", "ply", "pcd", "e57", "ptx", "pts", "xyz", "csv", "npy", "spz"};

constexpr std::size_t kMostWarnings = 8;  // of all files together

std::vector<std::string> files_of_folder(const std::string& path) {
  std::vector<std::string> files;
  std::error_code error;
  fs::directory_iterator entry(path, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().string();
    std::error_code ignored;
    const bool points = std::find(kExtensions.begin(), kExtensions.end(), extension(name)) != kExtensions.end();
    if (points && entry->is_regular_file(ignored)) files.push_back(name);
  }
  if (error) throw IoError(IoError::Kind::kNotFound, escape_text(path) + ": " + error.message());
  if (files.empty())
    throw IoError(
        IoError::Kind::kNotFound,
        escape_text(path) + ": a folder without files of points (.las, .laz, .ply, .pcd, .e57, .ptx, .pts, .xyz, .csv, .npy, .spz)");
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> files_of_pattern(const std::string& path) {
  struct Matches {
    ~Matches() { ::globfree(&found); }
    glob_t found{};
  } matches;
  const int result = ::glob(path.c_str(), GLOB_NOSORT, nullptr, &matches.found);
  if (result == GLOB_NOSPACE) throw std::bad_alloc();
  std::vector<std::string> files;
  for (std::size_t i = 0; result == 0 && i < matches.found.gl_pathc; ++i) {
    std::error_code ignored;
    if (fs::is_regular_file(matches.found.gl_pathv[i], ignored)) files.emplace_back(matches.found.gl_pathv[i]);
  }
  if (files.empty()) throw IoError(IoError::Kind::kNotFound, escape_text(path) + ": no file has such a name");
  std::sort(files.begin(), files.end());
  return files;
}

// Where a column of the whole comes from in each of the clouds.
struct Merged {
  enum class What { kPosition, kNormal, kColor, kConfidence, kProperty };
  What what = What::kProperty;
  std::size_t axis = 0;
};

class Merger {
 public:
  explicit Merger(const std::vector<Cloud>& clouds) : clouds_(clouds) { plan(); }

  Element merge() {
    for (const Cloud& cloud : clouds_) {
      append(cloud);
      element_.count += cloud.positions.size();
    }
    return std::move(element_);
  }

 private:
  void add(const std::string& name, Type type, Merged column) {
    const std::size_t found = element_.find(name);
    if (found == Element::npos) {
      element_.properties.emplace_back();
      element_.properties.back().name = name;
      element_.properties.back().type = type;
      columns_.push_back(column);
    } else if (element_.properties[found].type != type) {
      element_.properties[found].type = Type::kFloat64;
    }
  }

  void plan() {
    const auto any = [&](const auto& has) { return std::any_of(clouds_.begin(), clouds_.end(), has); };
    using What = Merged::What;
    const auto triple = [&](const std::array<const char*, 3>& names, Type type, What what) {
      for (std::size_t a = 0; a < 3; ++a) add(names[a], type, {what, a});
    };
    const bool doubles = any([](const Cloud& c) { return c.scalar == Scalar::kFloat64; });
    triple({"x", "y", "z"}, doubles ? Type::kFloat64 : Type::kFloat32, What::kPosition);
    if (any([](const Cloud& c) { return !c.normals.empty(); })) triple({"nx", "ny", "nz"}, Type::kFloat64, What::kNormal);
    if (any([](const Cloud& c) { return !c.colors.empty(); })) triple({"red", "green", "blue"}, Type::kUint8, What::kColor);
    if (any([](const Cloud& c) { return !c.confidence.empty(); })) add("confidence", Type::kFloat32, {What::kConfidence, 0});
    const std::size_t known = element_.properties.size();
    for (const Cloud& cloud : clouds_) {
      if (cloud.attributes == nullptr) continue;
      const Element& points = cloud.attributes->points();
      const std::vector<bool> special = special_properties(points);
      for (std::size_t i = 0; i < points.properties.size(); ++i) {
        const Property& property = points.properties[i];
        const std::size_t found = element_.find(property.name);
        if (!special[i] && !property.list && property.count == 1 && (found == Element::npos || found >= known))
          add(property.name, property.type, {What::kProperty, 0});
      }
    }
  }

  // Those that positions, normals, colours and confidence come from.
  static std::vector<bool> special_properties(const Element& points) {
    const Roles roles = find_roles(points);
    std::vector<bool> special(points.properties.size());
    const auto mark = [&](std::size_t property) {
      if (property != Element::npos) special[property] = true;
    };
    for (std::size_t a = 0; a < 3; ++a) {
      mark(roles.position[a]);
      mark(roles.normal[a]);
      mark(roles.color[a]);
    }
    mark(roles.packed_color);
    mark(roles.confidence);
    return special;
  }

  void append(const Cloud& cloud) {
    const Element* points = cloud.attributes == nullptr ? nullptr : &cloud.attributes->points();
    std::vector<std::size_t> from(columns_.size(), Element::npos);
    for (std::size_t c = 0; points != nullptr && c < columns_.size(); ++c) {
      if (columns_[c].what == Merged::What::kProperty) from[c] = points->find(element_.properties[c].name);
    }
    static const Element kNothing;
    RecordLayout layout(points == nullptr ? kNothing : *points);
    const char* record = points == nullptr ? nullptr : points->data.data();
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      if (record != nullptr) layout.seek(record);
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        double value = 0;
        if (from[c] != Element::npos) {
          value = load_as_double(points->properties[from[c]].type, record + layout.offset(from[c]));
        } else {
          value = own_value(cloud, columns_[c], i);
        }
        char stored[8];
        const Type type = element_.properties[c].type;
        store_double(type, value, stored);
        element_.data.append(stored, size_of(type));
      }
      if (record != nullptr) record += layout.size();
    }
  }

  static double own_value(const Cloud& cloud, const Merged& column, std::size_t i) {
    switch (column.what) {
      case Merged::What::kPosition:
        return cloud.positions[i][column.axis];
      case Merged::What::kNormal:
        return cloud.normals.empty() ? 0 : cloud.normals[i][column.axis];
      case Merged::What::kColor:
        return cloud.colors.empty() ? 0 : cloud.colors[i][column.axis];
      case Merged::What::kConfidence:
        return cloud.confidence.empty() ? 0 : static_cast<double>(cloud.confidence[i]);
      case Merged::What::kProperty:
        break;
    }
    return 0;
  }

  const std::vector<Cloud>& clouds_;
  Element element_ = make_vertex_element();
  std::vector<Merged> columns_;
};

void merge_scanners(const std::vector<Cloud>& clouds, Cloud& whole) {
  if (std::any_of(clouds.begin(), clouds.end(), [](const Cloud& c) { return c.sensor_positions.empty(); })) return;
  for (const Cloud& cloud : clouds) {
    const auto first = static_cast<std::uint32_t>(whole.sensor_positions.size());
    whole.sensor_positions.insert(whole.sensor_positions.end(), cloud.sensor_positions.begin(), cloud.sensor_positions.end());
    for (std::size_t i = 0; i < cloud.positions.size(); ++i)
      whole.scan_of_point.push_back(first + (cloud.scan_of_point.empty() ? 0 : cloud.scan_of_point[i]));
  }
  if (whole.sensor_positions.size() == 1) whole.scan_of_point = {};
}

void merge_warnings(const std::vector<Cloud>& clouds, const std::vector<std::string>& names, Cloud& whole) {
  std::size_t more = 0;
  for (std::size_t k = 0; k < clouds.size(); ++k) {
    for (const std::string& warning : clouds[k].warnings) {
      if (whole.warnings.size() < kMostWarnings) {
        whole.warnings.push_back(escape_text(names[k]) + ": " + warning);
      } else {
        ++more;
      }
    }
  }
  if (more != 0) whole.warnings.push_back("and " + std::to_string(more) + " more warnings about these files");
}

}  // namespace

std::vector<std::string> find_tiles(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return files_of_folder(path);
  if (path.find_first_of("*?") == std::string::npos || fs::exists(path, ignored)) return {};
  return files_of_pattern(path);
}

void forget_las(Cloud& cloud) {
  if (cloud.attributes == nullptr || cloud.attributes->dialect != Attributes::Dialect::kLas) return;
  auto table = std::make_shared<Attributes>();
  table->elements.push_back(cloud.attributes->points());
  cloud.attributes = std::move(table);
}

Cloud merge_clouds(std::vector<Cloud>& clouds, const std::vector<std::string>& names, const std::string& path) {
  if (clouds.size() == 1) return std::move(clouds[0]);
  Cloud whole;
  whole.format = std::to_string(clouds.size()) + " files";
  const auto same = [&](const Cloud& cloud) { return cloud.format == clouds[0].format; };
  if (std::all_of(clouds.begin(), clouds.end(), same)) whole.format += " of " + clouds[0].format;
  auto table = std::make_shared<Attributes>();
  table->elements.push_back(Merger(clouds).merge());
  merge_scanners(clouds, whole);
  merge_warnings(clouds, names, whole);
  clouds.clear();
  fill_cloud({{}, path}, std::move(table), whole);
  return whole;
}

}  // namespace g3r::io
