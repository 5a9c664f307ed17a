#include "gpu/kernel_cache.h"

#include "base/platform.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <system_error>

namespace g3r::gpu {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargest = 64u << 20;  // bytes of a file that is worth reading; binaries have some 100 KB
constexpr std::string_view kMagic = "g3r kernels 1\n";

// FNV-1a. Two lanes of it make a key; whoever can write the cache needs no collision to replace a file.
std::uint64_t hash(std::string_view bytes, std::uint64_t start) {
  std::uint64_t h = start;
  for (const char c : bytes) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return h;
}

std::string hex(std::uint64_t a, std::uint64_t b) {
  std::array<char, 33> text{};
  std::snprintf(text.data(), text.size(), "%016llx%016llx", static_cast<unsigned long long>(a), static_cast<unsigned long long>(b));
  return text.data();
}

std::string digest(std::string_view bytes) { return hex(hash(bytes, 0xcbf29ce484222325ULL), hash(bytes, 0x9e3779b97f4a7c15ULL)); }

}  // namespace

KernelCache::KernelCache(std::string_view everything) : key_(digest(everything)) {
  const fs::path where = platform::cache_folder();
  if (!where.empty()) file_ = where / "g3r" / ("kernels-" + key_);
}

// The file: magic, key, digest of the binary, each a line, and the binary.
std::vector<unsigned char> KernelCache::read() const {
  if (file_.empty()) return {};
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file_, error);
  if (error || size > kLargest) return {};
  std::ifstream in(file_, std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const std::string head = std::string(kMagic) + key_ + '\n';
  const std::size_t start = head.size() + key_.size() + 1;
  if (all.size() <= start || all.compare(0, head.size(), head) != 0) return {};
  const std::string_view binary = std::string_view(all).substr(start);
  if (all.compare(head.size(), key_.size() + 1, digest(binary) + '\n') != 0) return {};
  return {binary.begin(), binary.end()};
}

void KernelCache::write(const std::vector<unsigned char>& binary) const {
  if (file_.empty() || binary.empty()) return;
  std::error_code error;
  fs::create_directories(file_.parent_path(), error);
  fs::path unfinished = file_;
  unfinished += hex(platform::process(), reinterpret_cast<std::uintptr_t>(this));  // of this writer alone
  {
    std::ofstream out(unfinished, std::ios::binary | std::ios::trunc);
    const std::string_view bytes(reinterpret_cast<const char*>(binary.data()), binary.size());
    out << kMagic << key_ << '\n' << digest(bytes) << '\n' << bytes;
    if (!out.flush()) {
      out.close();
      fs::remove(unfinished, error);
      return;
    }
  }
  fs::rename(unfinished, file_, error);
  if (error) fs::remove(unfinished, error);
}

std::string first_complaint(std::string_view log, std::string_view otherwise) {
  for (std::size_t begin = 0; begin < log.size();) {
    const std::size_t end = std::min(log.find('\n', begin), log.size());
    const std::string_view line = log.substr(begin, end - begin);
    if (line.find("error") != std::string_view::npos) {
      std::string text;
      for (const char c : line) text += c >= ' ' && c < 127 ? c : ' ';
      return text;
    }
    begin = end + 1;
  }
  return std::string(otherwise);
}

}  // namespace g3r::gpu
