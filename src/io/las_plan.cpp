#include "io/las_plan.h"

#include "io/cloud_from_table.h"
#include "io/las_extra_bytes.h"
#include "io/source.h"
#include "io/text.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

namespace g3r::io {

namespace {

constexpr double kWeek = 604800;  // seconds

}  // namespace

LasPlan::LasPlan(const PointData& like)
    : columns_(plan_columns(like, Attributes::Dialect::kLas, false)),
      coordinates_(like.cloud.scalar),
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
    LasColumn& named = named_.emplace_back();
    named.column = c;
    named.part = part;
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

const LasColumn* LasPlan::find(LasPart part) const {
  const auto found = std::find_if(named_.begin(), named_.end(), [part](const LasColumn& named) { return named.part == part; });
  return found == named_.end() ? nullptr : &*found;
}

void LasPlan::add(const PointData& data) {
  const LasColumn* numbers = find(LasPart::kReturnNumbers);
  const LasColumn* flags = find(LasPart::kReturnFlags);
  const LasColumn* returns = numbers != nullptr ? numbers : flags != nullptr ? flags : find(LasPart::kReturnNumber);
  Rows rows(data, columns_);
  for (std::size_t i = 0; i < data.size(); ++i) {
    rows.next();
    coordinates_.add(data.cloud.positions[i]);
    for (LasColumn& named : named_) {
      const double value = rows.number(named.column);
      named.add(value);
      if (&named == returns && value >= 0 && value < 256) ++return_bytes_[static_cast<std::size_t>(value)];
    }
    for (LasColumn& channel : channels_) channel.add(rows.number(channel.column));
    if (numbers != nullptr && flags != nullptr) add_returns(rows.number(numbers->column), rows.number(flags->column));
  }
}

// The first return is number 1 in new formats. Where no number is the flags are those of an old one, if they number a return, or if other
// points have numbers, so that those of this one would be known too; else all come from a new one whose writer knew of no returns.
void LasPlan::add_returns(double numbers, double flags) {
  is_numbered_ = is_numbered_ || numbers != 0;
  if (numbers != 0 || flags == 0 || !(flags >= 0 && flags < 256)) return;
  has_flags_alone_ = true;
  const auto byte = static_cast<unsigned>(flags);
  const unsigned number = byte % 8, count = byte / 8 % 8;
  has_old_ = has_old_ || (number >= 1 && number <= count);
}

LasPlace LasPlan::place(const LasColumn& named, LasFamily family) const {
  const bool are_new = find(LasPart::kReturnNumbers) != nullptr;
  const bool are_whole = are_new || find(LasPart::kReturnFlags) != nullptr;
  switch (named.part) {
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
      if (is_mixed()) return {};  // means one thing in some points and another in others
      break;
    default:
      break;
  }
  return las_place(named.part, family, family == LasFamily::kNew ? are_new : are_whole);
}

void LasPlan::choose_family() {
  const auto is_new = [&](const LasColumn& named) {
    return named.part == LasPart::kReturnNumbers ||
           (!named.fits(place(named, LasFamily::kOld)) && named.fits(place(named, LasFamily::kNew)));
  };
  const bool is_long = count() > std::numeric_limits<std::uint32_t>::max();  // which old formats cannot count
  family_ = is_long || std::any_of(named_.begin(), named_.end(), is_new) ? LasFamily::kNew : LasFamily::kOld;
}

std::string LasPlan::misfit(const LasColumn& named) const {
  LasPlace best = place(named, LasFamily::kNew);
  if (best.bits == 0) best = place(named, LasFamily::kOld);
  if (best.bits == 0)
    return is_mixed() ? "old and new point formats mean different things by it" : "return_flags or return_numbers hold the same";
  if (named.fits(best)) return "the point formats that other columns need hold it differently";
  return named.misfit(best);
}

void LasPlan::place_columns() {
  for (const LasColumn& named : named_) {
    const LasPlace at = place(named, family_);
    if (!named.fits(at)) continue;
    fields_.push_back({named.column, at});
    placed_.push_back(named.part);
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
    const auto named = std::find_if(named_.begin(), named_.end(), [c](const LasColumn& other) { return other.column == c; });
    if (named == named_.end() && !is_las_name(full)) continue;
    warnings_.push_back(quote(full) + " becomes extra bytes " + quote(name) + ": " +
                        (named != named_.end() ? misfit(*named) : "the name is that of a field which holds something else"));
  }
}

void LasPlan::choose_deep_colors() {
  const auto is_deep = [](const LasColumn& channel) {
    return channel.whole && channel.low >= 0 && channel.high <= std::numeric_limits<std::uint16_t>::max();
  };
  const auto is_more = [](const LasColumn& channel) { return channel.high > std::numeric_limits<std::uint8_t>::max(); };
  if (channels_.size() == 3 && std::all_of(channels_.begin(), channels_.end(), is_deep) &&
      std::any_of(channels_.begin(), channels_.end(), is_more)) {
    for (const LasColumn& channel : channels_) deep_colors_.push_back(channel.column);
  }
}

void LasPlan::finish() {
  choose_family();
  place_columns();
  name_extras();
  std::string rounded = coordinates_.finish();
  if (!rounded.empty()) warnings_.push_back(std::move(rounded));
  choose_deep_colors();
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
    found[1] = count();
    return found;
  }
  const std::size_t mask = family_ == LasFamily::kOld ? 7 : 15;
  for (std::size_t byte = 0; byte < return_bytes_.size(); ++byte) found[byte & mask] += return_bytes_[byte];
  return found;
}

bool LasPlan::absolute_time() const {
  return std::any_of(named_.begin(), named_.end(),
                     [](const LasColumn& named) { return named.part == LasPart::kGpsTime && named.high > kWeek; });
}

}  // namespace g3r::io
