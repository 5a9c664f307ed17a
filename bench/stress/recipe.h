// What makes a cloud and the run on it: a line of words "key=value". Everything that is not named has its default, so a shorter line is a
// simpler case, which is what the shrinker goes by.
//
//   shape     solid, shell, wire, patch, terrain, room, curve, volume          parts     formulas that it is mixed from
//   seed      of the shape, the samples and everything random in them          points    how many are sampled
//   sampling  uniform, uneven, lines, raster, views
//   noise, step   standard deviation and raster of the coordinates, in spacings
//   outliers, duplicates   shares of the points                                missing   points that are not finite
//   far       1: one point a thousand sizes away                               float32   1: coordinates in single precision
//   unit_x, unit_y, unit_z    factors of the axes                              offset    added: none, utm, or ecef
//   all other keys: options of the run, see run_options.h
#pragma once

#include <map>
#include <string>

namespace g3r::stress {

class Recipe {
 public:
  Recipe() = default;
  /// "key=value key=value"; throws InvalidInput for a word without "=".
  explicit Recipe(const std::string& line);

  [[nodiscard]] std::string line() const;
  [[nodiscard]] bool has(const std::string& key) const { return words_.count(key) != 0; }
  [[nodiscard]] std::string text(const std::string& key, const std::string& otherwise = "") const;
  /// Throws InvalidInput if it is not a number.
  [[nodiscard]] double number(const std::string& key, double otherwise = 0) const;
  void set(const std::string& key, const std::string& value) { words_[key] = value; }
  void set(const std::string& key, double value);
  void erase(const std::string& key) { words_.erase(key); }
  [[nodiscard]] const std::map<std::string, std::string>& words() const { return words_; }

 private:
  std::map<std::string, std::string> words_;
};

}  // namespace g3r::stress
