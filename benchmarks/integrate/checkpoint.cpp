#include "benchmarks/integrate/checkpoint.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <streambuf>

#include "benchmarks/integrate/whole_file.h"
#include "benchmarks/program.h"
#include "isosyrk/linalg/byte_hash.h"

namespace isosyrk {
namespace {

// A checkpoint is this line, that of the header, the state, and the hash of all that.
constexpr const char* first_line = "isosyrk checkpoint 1";
using Hash = std::uint64_t;

// Passes bytes on to a stream, and hashes them.
class HashingBuffer final : public std::streambuf {
 public:
  explicit HashingBuffer(std::ostream& to) : to_(to) {}
  Hash hash() const { return hash_; }

 private:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    hash_ = hash_after(hash_, bytes, static_cast<std::size_t>(count));
    to_.write(bytes, count);
    return to_ ? count : 0;
  }
  int overflow(int byte) override {
    const char one = static_cast<char>(byte);
    return xsputn(&one, 1) == 1 ? byte : EOF;
  }

  std::ostream& to_;
  Hash hash_ = hash_of_nothing;
};

// Returns whether a stream ends in the hash of all before it.
bool is_whole(std::istream& input) {
  input.seekg(0, std::ios::end);
  const std::streamoff length = input.tellg();
  std::streamoff left = length - static_cast<std::streamoff>(sizeof(Hash));
  if (left < 0) return false;
  input.seekg(0);
  Hash hash = hash_of_nothing;
  std::string piece(std::size_t{1} << 20U, '\0');
  while (left > 0) {
    const auto wanted = std::min(left, static_cast<std::streamoff>(piece.size()));
    if (!input.read(piece.data(), wanted)) return false;
    hash = hash_after(hash, piece.data(), static_cast<std::size_t>(wanted));
    left -= wanted;
  }
  Hash written = 0;
  input.read(reinterpret_cast<char*>(&written), sizeof(written));
  return input && written == hash;
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const CheckpointHeader& header,
                      const ArchiveRun& archive) {
  replace_whole_file("--snapshots", path, [&](std::ostream& output) {
    HashingBuffer hashing(output);
    std::ostream hashed(&hashing);
    const nlohmann::ordered_json line = {{"step", header.step}, {"command", header.command}};
    hashed << first_line << '\n' << line.dump() << '\n';
    StateWriter writer(hashed);
    archive(writer);
    const Hash hash = hashing.hash();
    output.write(reinterpret_cast<const char*>(&hash), sizeof(hash));
  });
}

Checkpoint::Checkpoint(std::filesystem::path path) : path_(std::move(path)) {
  std::ifstream input(path_, std::ios::binary);
  if (!input) refuse("is not there; there is nothing to go on from");
  if (!is_whole(input)) refuse("is damaged: its checksum is not that of its bytes");
  input.clear();
  input.seekg(0);
  std::string line;
  std::getline(input, line);
  if (line != first_line) refuse(fmt::format("begins with '{:.40}', not '{}'", line, first_line));
  std::getline(input, line);
  const auto header = nlohmann::ordered_json::parse(line, nullptr, false);
  if (header.is_discarded()) refuse("has no header");
  header_ = {.step = header.at("step"), .command = header.at("command")};
  begin_ = input.tellg();
}

void Checkpoint::refuse(const std::string& why) const {
  throw BadArgument(fmt::format("--resume: {} {}", path_.string(), why));
}

void Checkpoint::read(const ArchiveRun& archive) const {
  std::ifstream input(path_, std::ios::binary);
  input.seekg(begin_);
  StateReader reader(input);
  try {
    archive(reader);
  } catch (const std::invalid_argument& error) {
    refuse(fmt::format("is of no such run ({})", error.what()));
  }
}

}  // namespace isosyrk
