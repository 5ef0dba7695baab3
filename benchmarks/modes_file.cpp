#include "benchmarks/modes_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace isosyrk {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const auto comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

// A quote of the user's text that cannot spoil the one line of an error message.
std::string quoted(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
  return fmt::format("'{}{}'", shown, text.size() > 40 ? "..." : "");
}

constexpr std::array<std::string_view, 4> column_names = {"l", "m", "re", "im"};

}  // namespace

std::vector<Mode> read_modes(std::istream& input, const std::string& source) {
  int line_number = 0;
  const auto fail = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{}, line {}: {}", source, line_number, why));
  };

  std::string line;
  std::vector<Mode> modes;
  std::array<std::size_t, 4> column{};
  bool header_read = false;
  while (std::getline(input, line)) {
    ++line_number;
    std::string_view text = line;
    if (line_number == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    if (trimmed(text).empty()) continue;
    const std::vector<std::string_view> fields = fields_of(text);
    if (!header_read) {
      for (std::size_t k = 0; k < column_names.size(); ++k) {
        const auto at = std::find(fields.begin(), fields.end(), column_names[k]);
        if (at == fields.end()) {
          fail(
              fmt::format("column {} is missing; the header must name l,m,re,im", column_names[k]));
        }
        column[k] = static_cast<std::size_t>(at - fields.begin());
      }
      if (fields.size() != column_names.size()) {
        fail(fmt::format("{} columns; the header must name l,m,re,im and no other", fields.size()));
      }
      header_read = true;
      continue;
    }
    if (fields.size() != column_names.size()) {
      fail(fmt::format("{} fields; must be 4 (l,m,re,im)", fields.size()));
    }
    Mode mode{};
    double re = 0.0;
    double im = 0.0;
    const auto read = [&](std::size_t k, auto& value, const char* kind) {
      const std::string_view field = fields[column[k]];
      if (parse(field, value)) return;
      fail(fmt::format("{} = {} is not a {}", column_names[k], quoted(field), kind));
    };
    read(0, mode.l, "whole number");
    read(1, mode.m, "whole number");
    read(2, re, "number");
    read(3, im, "number");
    mode.value = {re, im};
    modes.push_back(mode);
  }
  if (input.bad()) throw std::invalid_argument(fmt::format("{}: cannot be read", source));
  if (!header_read) {
    throw std::invalid_argument(fmt::format("{}: empty; must have the header l,m,re,im", source));
  }
  if (modes.empty()) {
    throw std::invalid_argument(fmt::format("{}: no modes; must have at least one line", source));
  }
  return modes;
}

std::vector<Mode> read_modes_file(const std::string& path, Index n) {
  if (std::filesystem::is_directory(path)) {
    throw std::invalid_argument(fmt::format("--modes {}: is a directory, must be a file", path));
  }
  std::ifstream input(path);
  if (!input) throw std::invalid_argument(fmt::format("--modes {}: cannot be read", path));
  const std::string source = fmt::format("--modes {}", path);
  std::vector<Mode> modes = read_modes(input, source);
  try {
    require_valid(modes, n);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: {}", source, error.what()));
  }
  return modes;
}

std::string hash_of(const std::vector<Mode>& modes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const Mode& mode : modes) {
    const std::string line =
        fmt::format("{},{},{},{}\n", mode.l, mode.m, mode.value.real(), mode.value.imag());
    for (const char c : line) {
      hash ^= static_cast<unsigned char>(c);
      hash *= 0x100000001b3U;
    }
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace isosyrk
