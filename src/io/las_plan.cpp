#include "io/las_plan.h"

#include "io/cloud_from_table.h"
#include "io/las.h"
#include "io/source.h"
#include "io/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace g3r::io {

namespace {

constexpr const char* kAxisNames[] = {"x", "y", "z"};
constexpr double kWeek = 604800;  // seconds

std::string number_text(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

// Whether steps are coarser than the numbers as they were read: half a unit in the last place of the largest.
bool are_coarse(double scale, double largest, Scalar precision) {
  const double relative = precision == Scalar::kFloat32 ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon();
  return scale > relative * largest;
}

}  // namespace

void LasPlan::Facts::add(double value) {
  if (!std::isfinite(value)) {
    if (finite && whole) odd = value;
    finite = whole = false;
    return;
  }
  low = std::min(low, value);
  high = std::max(high, value);
  if (whole && value != std::nearbyint(value)) {
    odd = value;
    whole = false;
  }
}

bool LasPlan::Facts::fit(const LasPlace& place) const {
  if (place.bits == 64) return finite;
  return place.bits != 0 && whole && low >= place.low && high <= place.high;
}

LasPlan::LasPlan(const PointData& like)
    : columns_(plan_columns(like, Attributes::Dialect::kLas, false)),
      decimals_{Decimals(like.cloud.scalar), Decimals(like.cloud.scalar), Decimals(like.cloud.scalar)},
      precision_(like.cloud.scalar),
      colored_(!like.cloud.colors.empty()) {
  std::erase_if(columns_, [](const Column& column) {
    return column.from == Column::From::kPosition || column.from == Column::From::kColor || column.property.count != 1;
  });
  std::array<bool, kLasParts + 1> seen{};
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    others_.push_back(c);
    const LasPart part = columns_[c].from == Column::From::kTable ? las_part(columns_[c].property.name) : LasPart::kNone;
    if (part == LasPart::kNone || seen[static_cast<std::size_t>(part)]) continue;
    seen[static_cast<std::size_t>(part)] = true;
    Facts& facts = facts_.emplace_back();
    facts.column = c;
    facts.part = part;
  }
  if (!colored_ || like.table == nullptr) return;
  const Roles roles = find_roles(like.table->points());
  for (const std::size_t channel : roles.color) {
    if (channel == Element::npos) break;
    Column column;
    column.property = like.table->points().properties[channel];
    column.in_table = channel;
    channels_.emplace_back().column = columns_.size();
    columns_.push_back(std::move(column));
  }
}

const LasPlan::Facts* LasPlan::find(LasPart part) const {
  const auto found = std::find_if(facts_.begin(), facts_.end(), [part](const Facts& facts) { return facts.part == part; });
  return found == facts_.end() ? nullptr : &*found;
}

void LasPlan::add(const PointData& data) {
  const Facts* numbers = find(LasPart::kReturnNumbers);
  const Facts* flags = find(LasPart::kReturnFlags);
  const Facts* returns = numbers != nullptr ? numbers : flags != nullptr ? flags : find(LasPart::kReturnNumber);
  Rows rows(data, columns_);
  for (std::size_t i = 0; i < data.size(); ++i) {
    rows.next();
    for (std::size_t a = 0; a < 3; ++a) {
      const double value = data.cloud.positions[i][a];
      if (!std::isfinite(value)) throw InvalidInput("write_cloud: LAS cannot hold coordinates that are not finite");
      bounds_.low[a] = count_ == 0 ? value : std::min(bounds_.low[a], value);
      bounds_.high[a] = count_ == 0 ? value : std::max(bounds_.high[a], value);
      decimals_[a].add(value);
    }
    ++count_;
    for (Facts& facts : facts_) {
      const double value = rows.number(facts.column);
      facts.add(value);
      if (&facts == returns && value >= 0 && value < 256) ++return_bytes_[static_cast<std::size_t>(value)];
    }
    for (Facts& channel : channels_) channel.add(rows.number(channel.column));
    // The first return is number 1 in new formats: where no number is, the flags are those of an old one.
    if (numbers != nullptr && flags != nullptr && !mixed_) mixed_ = rows.number(numbers->column) == 0 && rows.number(flags->column) != 0;
  }
}

LasPlace LasPlan::place(const Facts& facts, LasFamily family) const {
  const bool are_new = find(LasPart::kReturnNumbers) != nullptr;
  const bool are_whole = are_new || find(LasPart::kReturnFlags) != nullptr;
  switch (facts.part) {
    case LasPart::kReturnNumber:
    case LasPart::kNumberOfReturns:
    case LasPart::kScanDirection:
    case LasPart::kEdgeOfFlightLine:
    case LasPart::kSynthetic:
    case LasPart::kKeyPoint:
    case LasPart::kWithheld:
    case LasPart::kOverlap:
    case LasPart::kScannerChannel:
      if (are_whole) return {};  // the bytes have it
      break;
    case LasPart::kReturnFlags:
    case LasPart::kScanAngle:
      if (mixed_) return {};  // means one thing in some points and another in others
      break;
    default:
      break;
  }
  return las_place(facts.part, family, family == LasFamily::kNew ? are_new : are_whole);
}

void LasPlan::choose_family() {
  const auto is_new = [&](const Facts& facts) {
    return facts.part == LasPart::kReturnNumbers || (!facts.fit(place(facts, LasFamily::kOld)) && facts.fit(place(facts, LasFamily::kNew)));
  };
  const bool is_long = count_ > std::numeric_limits<std::uint32_t>::max();  // which old formats cannot count
  family_ = is_long || std::any_of(facts_.begin(), facts_.end(), is_new) ? LasFamily::kNew : LasFamily::kOld;
}

std::string LasPlan::misfit(const Facts& facts) const {
  LasPlace best = place(facts, LasFamily::kNew);
  if (best.bits == 0) best = place(facts, LasFamily::kOld);
  if (best.bits == 0)
    return mixed_ ? "old and new point formats mean different things by it" : "return_flags or return_numbers hold the same";
  if (facts.fit(best)) return "the point formats that other columns need hold it differently";
  if (best.bits == 64) return "LAS holds finite numbers there, and some are not";
  const double odd = !facts.whole ? facts.odd : facts.low < best.low ? facts.low : facts.high;
  return "LAS holds whole numbers from " + number_text(best.low) + " to " + number_text(best.high) + " there, found " + number_text(odd);
}

void LasPlan::place_columns() {
  for (const Facts& facts : facts_) {
    const LasPlace at = place(facts, family_);
    if (!facts.fit(at)) continue;
    fields_.push_back({facts.column, at});
    placed_.push_back(facts.part);
  }
}

// Names for extra bytes that are neither those of fields nor twice the same, where needed with a number at the end.
void LasPlan::name_extras() {
  std::set<std::string> taken;
  for (const std::size_t c : others_) {
    if (std::any_of(fields_.begin(), fields_.end(), [c](const Field& field) { return field.column == c; })) continue;
    const std::string& full = columns_[c].property.name;
    std::string name = full.substr(0, kLasNameBytes);
    const auto is_free = [&] { return !is_las_name(name) && taken.insert(lower_case(name)).second; };
    for (int number = 2; !is_free(); ++number) {
      const std::string digits = std::to_string(number);
      name = full.substr(0, kLasNameBytes - 1 - digits.size());
      (name += '_') += digits;
    }
    extras_.push_back({c, name});
    const auto facts = std::find_if(facts_.begin(), facts_.end(), [c](const Facts& other) { return other.column == c; });
    if (facts == facts_.end() && !is_las_name(full)) continue;
    warnings_.push_back(quote(full) + " becomes extra bytes " + quote(name) + ": " +
                        (facts != facts_.end() ? misfit(*facts) : "the name is that of a field which holds something else"));
  }
}

void LasPlan::choose_steps() {
  std::string rounded;
  for (std::size_t a = 0; a < 3; ++a) {
    const double low = bounds_.low[a];
    const double high = bounds_.high[a];
    const std::optional<int> decimals = count_ == 0 ? std::nullopt : decimals_[a].count();
    const std::optional<DecimalSteps> exact = decimals ? exact_steps(low, high, *decimals) : std::nullopt;
    steps_[a] = exact ? *exact : fine_steps(low, high);
    if (exact || !are_coarse(steps_[a].scale(), std::max(std::abs(low), std::abs(high)), precision_)) continue;
    rounded += (rounded.empty() ? "" : ", ") + std::string(kAxisNames[a]) + " to " + number_text(steps_[a].scale());
  }
  if (!rounded.empty())
    warnings_.push_back("coordinates are rounded (" + rounded + "): with all their digits they need more than the 32 bits of LAS");
}

void LasPlan::finish() {
  choose_family();
  place_columns();
  name_extras();
  choose_steps();
  const auto is_deep = [](const Facts& channel) {
    return channel.whole && channel.low >= 0 && channel.high <= std::numeric_limits<std::uint16_t>::max();
  };
  const auto is_more = [](const Facts& channel) { return channel.high > std::numeric_limits<std::uint8_t>::max(); };
  if (channels_.size() == 3 && std::all_of(channels_.begin(), channels_.end(), is_deep) &&
      std::any_of(channels_.begin(), channels_.end(), is_more)) {
    for (const Facts& channel : channels_) deep_colors_.push_back(channel.column);
  }
}

bool LasPlan::has(LasPart part) const { return std::find(placed_.begin(), placed_.end(), part) != placed_.end(); }

bool LasPlan::has_return_numbers() const {
  return has(LasPart::kReturnNumber) || has(LasPart::kReturnNumbers) || (family_ == LasFamily::kOld && has(LasPart::kReturnFlags));
}

bool LasPlan::has_counts_of_returns() const {
  return has(LasPart::kNumberOfReturns) || has(LasPart::kReturnNumbers) || (family_ == LasFamily::kOld && has(LasPart::kReturnFlags));
}

std::array<std::uint64_t, 16> LasPlan::returns() const {
  std::array<std::uint64_t, 16> found{};
  if (!has_return_numbers()) {
    found[1] = count_;
    return found;
  }
  const std::size_t mask = family_ == LasFamily::kOld ? 7 : 15;
  for (std::size_t byte = 0; byte < return_bytes_.size(); ++byte) found[byte & mask] += return_bytes_[byte];
  return found;
}

bool LasPlan::absolute_time() const {
  return std::any_of(facts_.begin(), facts_.end(),
                     [](const Facts& facts) { return facts.part == LasPart::kGpsTime && facts.high > kWeek; });
}

}  // namespace g3r::io
