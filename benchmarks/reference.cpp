#include "benchmarks/reference.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "benchmarks/npy_file.h"
#include "benchmarks/program.h"

namespace isosyrk {

double relative_error(const Matrix& W, const Matrix& reference) {
  return (W - reference).norm() / reference.norm();
}

Reference read_reference(const std::string& option, const std::string& folder, const Scene& scene,
                         HbarConvention hbar, const std::vector<Mode>& modes) {
  const Index n = scene.initial.rows();
  std::string path = folder + "/references.json";
  const auto refuse = [&](const std::string& why) {
    return BadArgument(fmt::format("{} {}: {}", option, path, why));
  };
  std::ifstream input(path);
  if (!input) throw refuse("cannot be read");
  try {
    const auto json = nlohmann::json::parse(input);
    if (json.at("format") != "isosyrk references 1") throw refuse("holds no reference solutions");
    if (json.at("scene") != scene.name || json.at("time") != scene.time ||
        json.at("hbar") != name(hbar) || json.at("modes_hash") != hash_of(modes)) {
      throw refuse("holds the solutions of another scene");
    }
    for (const auto& entry : json.at("references")) {
      if (entry.at("n") != n) continue;
      Reference reference{{}, entry.at("uncertainty")};
      path = fmt::format("{}/{}", folder, entry.at("file").get<std::string>());
      reference.W = read_npy(path, n);
      require_initial_data(reference.W, n);  // as every state of the flow is
      return reference;
    }
    throw refuse(fmt::format("has no solution for n = {}", n));
  } catch (const nlohmann::json::exception&) {
    throw refuse("is not a whole list of reference solutions");
  } catch (const std::invalid_argument& error) {
    throw refuse(error.what());
  }
}

}  // namespace isosyrk
