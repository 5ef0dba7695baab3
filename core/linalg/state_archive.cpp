#include "isosyrk/linalg/state_archive.h"

#include <istream>
#include <ostream>
#include <stdexcept>

namespace isosyrk {

void StateArchive::pass_size(std::size_t places) {
  std::uint64_t size = places;
  pass_bytes(&size, sizeof(size));
  if (size != places) throw std::invalid_argument("state: is of a run of another size");
}

void StateWriter::pass_bytes(void* bytes, std::size_t count) {
  to_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  if (!to_) throw std::ios_base::failure("state: cannot be written");
}

void StateReader::pass_bytes(void* bytes, std::size_t count) {
  from_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(count));
  if (!from_) throw std::invalid_argument("state: ends too early");
}

}  // namespace isosyrk
