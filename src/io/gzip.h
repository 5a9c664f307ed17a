// gzip, through zlib.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace g3r::io {

/// Unpacks a gzip stream piece by piece, so that its beginning can be judged before memory is taken for the rest.
class Gunzip {
 public:
  /// `bytes` must live as long as this. Throws std::bad_alloc.
  explicit Gunzip(std::string_view bytes);
  ~Gunzip();
  Gunzip(const Gunzip&) = delete;
  Gunzip& operator=(const Gunzip&) = delete;

  /// The next `count` bytes; fewer where the stream ends or is damaged.
  std::string read(std::size_t count);
  /// Whether the stream has been read to its end and its checksum agrees.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::string_view rest_;
  bool ended_ = false;
  bool damaged_ = false;
};

}  // namespace g3r::io
