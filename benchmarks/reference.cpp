#include "benchmarks/reference.h"

#include <fmt/format.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "benchmarks/modes_file.h"
#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/simulation/run.h"

namespace isosyrk {
namespace {

constexpr const char* file_format = "isosyrk reference 1";

struct Solution {
  Matrix W;
  ReferenceRun how;
};

// Doubles the steps until Richardson's estimate of the error, change / (2^order - 1), is down at
// rounding or no longer falls as the order says it should.
Solution refine(const Scene& scene, const std::string& integrator, ProductBackend backend) {
  constexpr double aim = 2e-14;
  constexpr long most_steps = 25600;
  SolverOptions options;
  options.tolerance = 1e-14;
  const IntegratorEntry& entry = integrator_entry(integrator);
  const auto method = entry.make(*scene.flow, options, backend);
  const double gain = std::pow(2.0, entry.order);

  Solution best;
  double last_change = std::numeric_limits<double>::infinity();
  for (long steps = 100; steps <= most_steps; steps *= 2) {
    Matrix W = scene.initial;
    const RunReport report = run(*method, W, scene.time / static_cast<double>(steps), steps);
    const bool have_coarser = best.how.steps > 0;
    if (!report.converged()) {
      if (have_coarser) break;
      continue;  // too large a step
    }
    const double change = have_coarser ? relative_error(best.W, W) : last_change;
    const bool still_falling = change < last_change / 2.0 || !have_coarser;
    if (have_coarser && change < 1e-10 && !still_falling) break;  // rounding: keep the coarser one
    best = {W, {integrator, steps, change / (gain - 1.0), report.products}};
    last_change = change;
    if (best.how.estimate < aim) break;
  }
  if (best.how.steps == 0) {
    throw UncertainReference(fmt::format("reference at n = {}: {} did not converge at {} steps",
                                         scene.initial.rows(), integrator, most_steps));
  }
  return best;
}

nlohmann::ordered_json as_json(const ReferenceRun& run) {
  return {{"integrator", run.integrator},
          {"steps", run.steps},
          {"estimate", run.estimate},
          {"products", run.products}};
}

ReferenceRun reference_run(const nlohmann::ordered_json& json) {
  return {json.at("integrator"), json.at("steps"), json.at("estimate"), json.at("products")};
}

}  // namespace

double relative_error(const Matrix& W, const Matrix& reference) {
  return (W - reference).norm() / reference.norm();
}

Reference compute_reference(const Scene& scene, ProductBackend backend, double largest) {
  const Solution first = refine(scene, "group5", backend);
  const Solution second = refine(scene, "rkmk4", backend);
  const double difference = relative_error(second.W, first.W);
  if (!(difference < largest)) {
    throw UncertainReference(fmt::format(
        "reference at n = {}: {} and {} differ by {:.2g}; must be below {:.2g}",
        scene.initial.rows(), first.how.integrator, second.how.integrator, difference, largest));
  }
  return {first.W, difference, first.how, second.how};
}

std::string reference_path(const std::string& folder, Index n) {
  return fmt::format("{}/reference_n{}.json", folder, n);
}

std::string to_json(const Reference& reference, const Scene& scene, HbarConvention hbar,
                    const std::vector<Mode>& modes) {
  const auto* numbers = reinterpret_cast<const double*>(reference.W.data());
  const nlohmann::ordered_json json = {
      {"format", file_format},
      {"scene", scene.name},
      {"n", scene.initial.rows()},
      {"time", scene.time},
      {"hbar", name(hbar)},
      {"modes_hash", hash_of(modes)},
      {"uncertainty", reference.uncertainty},
      {"first", as_json(reference.first)},
      {"second", as_json(reference.second)},
      {"W", std::vector<double>(numbers, numbers + 2 * reference.W.size())},
  };
  return json.dump() + "\n";
}

Reference read_reference(const std::string& option, const std::string& folder, const Scene& scene,
                         HbarConvention hbar, const std::vector<Mode>& modes) {
  const Index n = scene.initial.rows();
  const std::string path = reference_path(folder, n);
  const auto refuse = [&](const std::string& why) {
    return BadArgument(
        fmt::format("{} {}: {}; build/benchmarks/reference_solutions makes it", option, path, why));
  };
  std::ifstream input(path);
  if (!input) throw refuse("cannot be read");
  try {
    const nlohmann::ordered_json json = nlohmann::ordered_json::parse(input);
    if (json.at("format") != file_format) throw refuse("is no reference solution");
    if (json.at("scene") != scene.name || json.at("n") != n || json.at("time") != scene.time ||
        json.at("hbar") != name(hbar) || json.at("modes_hash") != hash_of(modes)) {
      throw refuse("is the solution of another scene");
    }
    const std::vector<double> numbers = json.at("W");
    if (static_cast<Index>(numbers.size()) != 2 * n * n) throw refuse("W is not n x n");
    Reference reference;
    reference.W = Eigen::Map<const Matrix>(reinterpret_cast<const Complex*>(numbers.data()), n, n);
    reference.uncertainty = json.at("uncertainty");
    reference.first = reference_run(json.at("first"));
    reference.second = reference_run(json.at("second"));
    return reference;
  } catch (const nlohmann::json::exception&) {
    throw refuse("is not a whole reference file");
  }
}

}  // namespace isosyrk
