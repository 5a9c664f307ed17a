#include "io/gzip.h"

#include <algorithm>
#include <limits>
#include <new>

#define ZLIB_CONST  // zlib reads its input only
#include <zlib.h>

namespace g3r::io {

namespace {

constexpr int kGzipOnly = 16 + MAX_WBITS;  // zlib's way to ask for a gzip header and checksum

// zlib's memory comes from operator new, as all other memory does.
void* allocate(void* /*unused*/, unsigned count, unsigned size) { return ::operator new (std::size_t{count} * size, std::nothrow); }
void release(void* /*unused*/, void* memory) { ::operator delete(memory); }

}  // namespace

struct Gunzip::State {
  z_stream stream{};
};

Gunzip::Gunzip(std::string_view bytes) : state_(std::make_unique<State>()), rest_(bytes) {
  state_->stream.zalloc = allocate;
  state_->stream.zfree = release;
  if (inflateInit2(&state_->stream, kGzipOnly) != Z_OK) throw std::bad_alloc();
}

Gunzip::~Gunzip() { inflateEnd(&state_->stream); }

std::string Gunzip::read(std::size_t count) {
  std::string out(count, '\0');
  std::size_t done = 0;
  z_stream& stream = state_->stream;
  constexpr std::size_t kMost = std::numeric_limits<unsigned>::max();
  while (done < count && !ended_ && !damaged_) {
    const std::size_t given = std::min(rest_.size(), kMost);
    const std::size_t wanted = std::min(count - done, kMost);
    stream.next_in = reinterpret_cast<const Bytef*>(rest_.data());
    stream.avail_in = static_cast<unsigned>(given);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + done);
    stream.avail_out = static_cast<unsigned>(wanted);
    const int result = inflate(&stream, Z_NO_FLUSH);
    if (result == Z_MEM_ERROR) throw std::bad_alloc();
    const std::size_t used = given - stream.avail_in;
    const std::size_t made = wanted - stream.avail_out;
    rest_.remove_prefix(used);
    done += made;
    ended_ = result == Z_STREAM_END;
    damaged_ = (result != Z_OK && !ended_) || (used == 0 && made == 0);
  }
  out.resize(done);
  return out;
}

}  // namespace g3r::io
