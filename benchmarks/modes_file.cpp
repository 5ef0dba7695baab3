#include "benchmarks/modes_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
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

constexpr std::array<std::string_view, 4> column_names = {"l", "m", "re", "im"};

}  // namespace

std::vector<Mode> read_modes(std::istream& input, const std::string& source, Index n) {
  std::string place = source;
  const auto fail = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{}: {}", place, why));
  };
  std::vector<Mode> modes;
  std::vector<std::string> columns;  // in the order of the header
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    place = fmt::format("{}, line {}", source, number);
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (trimmed(line).empty()) continue;
    const std::vector<std::string_view> fields = fields_of(line);
    if (columns.empty()) {
      columns.assign(fields.begin(), fields.end());
      if (!std::ranges::is_permutation(columns, column_names)) {
        fail("the header must name l,m,re,im and no other");
      }
      continue;
    }
    if (fields.size() != columns.size()) {
      fail(fmt::format("{} fields; must be 4 (l,m,re,im)", fields.size()));
    }
    Mode mode{};
    double re = 0.0;
    double im = 0.0;
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const std::string& column = columns[k];
      const bool is_whole = column == "l" || column == "m";
      const bool is_parsed = is_whole ? parse(fields[k], column == "l" ? mode.l : mode.m)
                                      : parse(fields[k], column == "re" ? re : im);
      if (!is_parsed) {
        fail(fmt::format("{} = '{:.40}' is not a {}", column, fields[k],
                         is_whole ? "whole number" : "number"));
      }
    }
    mode.value = {re, im};
    try {
      require_valid_mode(mode, n);
    } catch (const std::invalid_argument& error) {
      fail(error.what());
    }
    modes.push_back(mode);
  }
  place = source;
  if (input.bad()) fail("cannot be read");
  if (columns.empty()) fail("empty; must have the header l,m,re,im");
  if (modes.empty()) fail("no modes; must have at least one line");
  return modes;
}

std::vector<Mode> read_modes_file(const std::string& path, Index n) {
  if (std::filesystem::is_directory(path)) {
    throw std::invalid_argument(fmt::format("--modes {}: is a directory, must be a file", path));
  }
  std::ifstream input(path);
  if (!input) throw std::invalid_argument(fmt::format("--modes {}: cannot be read", path));
  const std::string source = fmt::format("--modes {}", path);
  std::vector<Mode> modes = read_modes(input, source, n);
  try {
    require_valid(modes, n);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: {}", source, error.what()));
  }
  return modes;
}

}  // namespace isosyrk
