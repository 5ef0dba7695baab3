// Writing what a run keeps between its steps, and reading it back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <type_traits>
#include <vector>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Passes the members of a class to a stream, or from a stream back into their places: bit for bit,
/// in the byte order of this machine.  A class lists what it keeps once, for both directions:
///
///     void archive(StateArchive& state) { state.pass(count_, h_, slopes_); }
///
/// Numbers, matrices, vectors and optionals of these, and whatever has such an archive() may be
/// passed.  A matrix or a vector is read only into one of its size, so that reading allocates
/// nothing, and what was written by an object of another size is refused.
class StateArchive {
 public:
  virtual ~StateArchive() = default;
  StateArchive(const StateArchive&) = delete;
  StateArchive& operator=(const StateArchive&) = delete;

  /// Returns whether the members are read.
  virtual bool is_reading() const = 0;

  /// Passes the parts, in this order.  Throws std::invalid_argument if what is read ends before, or
  /// is of another size, and std::ios_base::failure if it cannot be written.
  template <class... Parts>
  void pass(Parts&... parts) {
    (pass_one(parts), ...);
  }

 protected:
  StateArchive() = default;

 private:
  virtual void pass_bytes(void* bytes, std::size_t count) = 0;
  /// Passes the number of entries that follow, and throws unless there are as many places.
  void pass_size(std::size_t places);

  template <class Part>
  void pass_one(Part& part) {
    if constexpr (std::is_arithmetic_v<Part> || std::is_same_v<Part, Complex>) {
      pass_bytes(&part, sizeof(part));
    } else if constexpr (std::is_base_of_v<Eigen::PlainObjectBase<Part>, Part>) {
      pass_size(static_cast<std::size_t>(part.rows()));
      pass_size(static_cast<std::size_t>(part.cols()));
      pass_bytes(part.data(), static_cast<std::size_t>(part.size()) * sizeof(*part.data()));
    } else {
      part.archive(*this);
    }
  }
  template <class Part, std::size_t size>
  void pass_one(std::array<Part, size>& parts) {
    for (Part& part : parts) pass_one(part);
  }
  template <class Part>
  void pass_one(std::vector<Part>& parts) {
    pass_size(parts.size());
    for (Part& part : parts) pass_one(part);
  }
  template <class Part>
  void pass_one(std::optional<Part>& part) {
    bool is_there = part.has_value();
    pass_one(is_there);
    if (is_there && !part) part.emplace();
    if (!is_there) part.reset();
    if (part) pass_one(*part);
  }
};

/// Writes to a stream, which must outlive it.
class StateWriter final : public StateArchive {
 public:
  explicit StateWriter(std::ostream& to) : to_(to) {}
  bool is_reading() const override { return false; }

 private:
  void pass_bytes(void* bytes, std::size_t count) override;

  std::ostream& to_;
};

/// Reads from a stream, which must outlive it, what a StateWriter wrote.
class StateReader final : public StateArchive {
 public:
  explicit StateReader(std::istream& from) : from_(from) {}
  bool is_reading() const override { return true; }

 private:
  void pass_bytes(void* bytes, std::size_t count) override;

  std::istream& from_;
};

}  // namespace isosyrk
