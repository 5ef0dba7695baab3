// Fuzzes the reading of modes files.  An input is the contents of such a file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>

#include "benchmarks/modes_file.h"
#include "benchmarks/product_rate.h"
#include "isosyrk/flows/invariants.h"
#include "tests/fuzz/property.h"

namespace isosyrk::fuzzing {
namespace {

constexpr Index n = 9;

using Modes = std::vector<Mode>;

std::optional<Modes> read(const std::string& text) {
  return accepted([&] {
    std::istringstream input(text);
    Modes modes = read_modes(input, "modes.csv");
    require_valid(modes, n);
    return modes;
  });
}

bool same(const Modes& first, const Modes& second) {
  return std::equal(
      first.begin(), first.end(), second.begin(), second.end(),
      [](const Mode& a, const Mode& b) { return a.l == b.l && a.m == b.m && a.value == b.value; });
}

// What require_valid promises, said again.
void check_valid(const Modes& modes) {
  bool some_nonzero = false;
  for (const Mode& mode : modes) {
    require(1 <= mode.l && mode.l < n, "1 <= l < n");
    require(0 <= mode.m && mode.m <= mode.l, "0 <= m <= l");
    require(std::isfinite(mode.value.real()) && std::isfinite(mode.value.imag()), "finite values");
    require(mode.m > 0 || mode.value.imag() == 0.0, "im = 0 where m = 0");
    const auto alike = [&](const Mode& other) { return other.l == mode.l && other.m == mode.m; };
    require(std::count_if(modes.begin(), modes.end(), alike) == 1, "each (l, m) once");
    some_nonzero = some_nonzero || mode.value != 0.0;
  }
  require(some_nonzero, "not all zero");
}

// The numbers of an accepted text, each read by the C library instead: a second reader that may
// take for granted what the first has checked.
std::vector<double> plain_numbers(const std::string& text) {
  std::vector<double> numbers;
  std::size_t begin = text.find('\n', text.find("im"));  // the end of the header
  while (begin < text.size()) {
    begin = text.find_first_not_of(", \t\r\n", begin);
    if (begin == std::string::npos) break;
    const std::size_t end = std::min(text.find_first_of(", \t\r\n", begin), text.size());
    const std::string field = text.substr(begin, end - begin);
    char* stop = nullptr;
    numbers.push_back(std::strtod(field.c_str(), &stop));
    require(stop == field.c_str() + field.size(), "what is read as a number is one");
    begin = end;
  }
  return numbers;
}

void check_numbers(const std::string& text, const Modes& modes) {
  std::vector<double> expected = plain_numbers(text);
  std::vector<double> found;
  for (const Mode& mode : modes) {
    found.insert(found.end(), {static_cast<double>(mode.l), static_cast<double>(mode.m),
                               mode.value.real(), mode.value.imag()});
  }
  std::sort(expected.begin(), expected.end());  // columns stand in any order
  std::sort(found.begin(), found.end());
  require(found == expected, "every number of the file is in the modes, and no other");
}

std::string written_out(const Modes& modes) {
  std::string text = "\xEF\xBB\xBFim, re ,m,l\r\n";
  for (const Mode& mode : modes) {
    text +=
        fmt::format("{},{:+}, {},{}\r\n\n", mode.value.imag(), mode.value.real(), mode.m, mode.l);
  }
  return text;
}

// However large or small the values, they are as good as any: only their ratios matter.
void check_usable(const Modes& modes) {
  const Matrix W = vorticity_from_modes(modes, n);
  require(W.allFinite(), "W is finite");
  require(skew_defect(W) == 0.0, "W is exactly skew-Hermitian");
  require(std::abs(spectral_norm(W) - 1.0) < 1e-13, "W has spectral norm 1");
}

}  // namespace

void check(const std::string& text) {
  const std::optional<Modes> modes = read(text);
  const std::optional<Modes> again = read(text);
  require(modes.has_value() == again.has_value(), "the same answer twice");
  if (!modes) return;
  require(same(*modes, *again) && hash_of(*modes) == hash_of(*again), "the same modes twice");
  check_valid(*modes);
  check_numbers(text, *modes);
  const std::optional<Modes> copy = read(written_out(*modes));
  require(copy && same(*modes, *copy), "modes written out and read again are the same");
  check_usable(*modes);
}

}  // namespace isosyrk::fuzzing

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  isosyrk::use_one_blas_thread();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isosyrk::fuzzing::check(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
