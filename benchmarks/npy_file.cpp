#include "benchmarks/npy_file.h"

#include <fmt/format.h>

#include <bit>
#include <cctype>
#include <fstream>
#include <limits>
#include <regex>
#include <stdexcept>
#include <string_view>

namespace isosyrk {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::string_view magic = "\x93NUMPY";

[[noreturn]] void refuse(const std::string& why) { throw std::invalid_argument(why); }

// `count` bytes, or fewer where the file ends.
std::string read_bytes(std::istream& input, std::size_t count) {
  std::string bytes(count, '\0');
  input.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(input.gcount()));
  return bytes;
}

// The header without its blanks, which are padding.
std::string read_header(std::istream& input) {
  constexpr std::size_t most = 4096;  // that of an array of plain numbers has 118
  const std::string start = read_bytes(input, magic.size() + 2);
  if (!start.starts_with(magic) || start.size() < magic.size() + 2) refuse("is not a .npy file");
  const int version = static_cast<unsigned char>(start[magic.size()]);
  if (version != 1 && version != 2) {
    refuse(fmt::format("is of .npy format {}; must be 1 or 2", version));
  }
  std::size_t length = 0;
  for (int shift = 0; const char byte : read_bytes(input, version == 1 ? 2 : 4)) {
    length += std::size_t{static_cast<unsigned char>(byte)} << shift;
    shift += 8;
  }
  std::string header = read_bytes(input, std::min(length, most));
  if (header.size() < length) refuse("has a broken .npy header");
  std::erase_if(header, [](unsigned char c) { return std::isspace(c) != 0; });
  return header;
}

// Takes a key and its value out of a header, by a pattern whose first group is the value.  NumPy
// reads the keys in any order.
std::string take(std::string& header, const char* key_and_value) {
  std::smatch found;
  if (!std::regex_search(header, found, std::regex(key_and_value))) {
    refuse("has a broken .npy header");
  }
  std::string value = found[1];
  header = found.prefix().str() + found.suffix().str();
  return value;
}

}  // namespace

std::string npy(const Matrix& W) {
  // Magic, version, header length, then a Python literal padded to 64 bytes.
  std::string header = fmt::format(
      "{{'descr': '<c16', 'fortran_order': False, 'shape': ({}, {}), }}", W.rows(), W.cols());
  constexpr std::size_t preamble = 10;
  while ((preamble + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string contents = fmt::format("{}{}", magic, std::string_view("\x01\x00", 2));
  contents += static_cast<char>(header.size() & 0xffU);
  contents += static_cast<char>(header.size() >> 8U);
  contents += header;
  contents.append(reinterpret_cast<const char*>(W.data()),
                  static_cast<std::size_t>(W.size()) * sizeof(Complex));
  return contents;
}

Matrix read_npy(const std::string& path, Index n) {
  std::ifstream input(path, std::ios::binary);
  if (!input || input.peek() == EOF) refuse("cannot be read, or is empty");
  std::string header = read_header(input);
  const std::string dtype = take(header, R"('descr':('[^']*'|\[.*\]))");
  const std::string fortran_order = take(header, "'fortran_order':(True|False)");
  const std::string shape = take(header, R"('shape':\(([^)]*)\))");
  if (header != "{,,}" && header != "{,,,}") refuse("has a broken .npy header");
  if (dtype != "'<c16'") {
    refuse(fmt::format("is of dtype {:.40}; must be '<c16' (complex128)", dtype));
  }
  if (shape != fmt::format("{0},{0}", n)) {
    refuse(fmt::format("is of shape ({:.40}); must be ({},{})", shape, n, n));
  }
  Matrix W(n, n);
  const auto expected = static_cast<std::streamsize>(W.size() * sizeof(Complex));
  input.read(reinterpret_cast<char*>(W.data()), expected);
  std::streamsize found = input.gcount();
  input.ignore(std::numeric_limits<std::streamsize>::max());
  found += input.gcount();
  if (found != expected) {
    refuse(fmt::format("has {} bytes of entries; must have {}", found, expected));
  }
  if (fortran_order == "True") W.transposeInPlace();
  return W;
}

}  // namespace isosyrk
