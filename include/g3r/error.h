// Every error that g3r throws. All derive from g3r::Error, which derives from std::runtime_error.
// The library never prints, never exits and never changes global state. Running out of memory is std::bad_alloc.
#pragma once

#include <g3r/export.h>

#include <stdexcept>
#include <string>

namespace G3R_PUBLIC g3r {

/// Base of all errors. what() is one line of plain text, safe to print on a terminal.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The data or an option cannot be used: too few points, a damaged file, an option out of range.
class InvalidInput : public Error {
 public:
  using Error::Error;
};

/// A file that is no mesh: what read_mesh() throws where there are no faces, in contrast to faces that cannot be used.
class NoFaces : public InvalidInput {
 public:
  using InvalidInput::InvalidInput;
};

/// A file could not be opened, read, created or written. what() names the file and the system's reason.
class IoError : public Error {
 public:
  enum class Kind {
    kNotFound,      ///< the input does not exist or may not be read
    kCannotCreate,  ///< the output cannot be created there, or is the input itself
    kFailed         ///< reading or writing broke off: disk full, device error
  };
  IoError(Kind kind, const std::string& what) : Error(what), kind_(kind) {}
  [[nodiscard]] Kind kind() const noexcept { return kind_; }

 private:
  Kind kind_;
};

/// The request is sound, but this build or this machine cannot serve it.
class Unavailable : public Error {
 public:
  using Error::Error;
};

/// The caller's Monitor asked to stop.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace g3r
