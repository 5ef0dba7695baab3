// A hash by which other data, or a damaged file, are recognised: FNV-1a with 64 bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace isosyrk {

inline constexpr std::uint64_t hash_of_nothing = 0xcbf29ce484222325U;

/// Returns the hash of some bytes and then these, from that of the first.
inline std::uint64_t hash_after(std::uint64_t hash, const char* bytes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    hash ^= static_cast<unsigned char>(bytes[i]);
    hash *= 0x100000001b3U;
  }
  return hash;
}

}  // namespace isosyrk
