// What scripts/check_regression asks of a build: counts and errors of cells of Table 1 and Table 2
// in one JSON object, or, as a server, how long a cell takes whenever asked.  A cell of Table 2 is
// named by its fast form: fast_group/n:17/s:2.
//
// A count depends on rounding, which decides in which sweep an iteration ends.  With --roundings N
// each cell is also run from N states that differ from its initial one by rounding: what counts of
// two builds may differ by, though both do the same.
//
// The server answers each line `CELL STEPS RUNS` on its input, CELL being a place in the list of
// cells, with the CPU seconds of that many runs; so two builds can take turns without starting
// anew.
#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <iostream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <sstream>
#include <tuple>

#include "benchmarks/allocation_count.h"
#include "benchmarks/arguments.h"
#include "benchmarks/command_line.h"
#include "benchmarks/conditions.h"
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/machine/clocks.h"
#include "isosyrk/scenes/euler_zeitlin_scenes.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/simulation/run.h"

namespace isosyrk::regression_cells {
namespace {

using Json = nlohmann::ordered_json;

constexpr double step_size = 0.1;
constexpr long step_total = 50;
// One backend for all, so that counts can be compared with those recorded elsewhere.
constexpr ProductBackend backend = ProductBackend::openblas;
constexpr Index largest_listed = 17;  // answers of larger n are not written out

struct Cell {
  std::string name;
  Formulation formulation;
  Index n;
  int s;
  Solver solver;

  bool is_fast() const { return solver == Solver::fast; }
};

Cell read_cell(const std::string& name) {
  std::smatch parts;
  if (!std::regex_match(name, parts, std::regex("(fast_)?(.*)/n:(.*)/s:(.*)"))) {
    throw BadArgument(fmt::format("cell '{}': must be like group/n:17/s:2", name));
  }
  const std::string what = fmt::format("cell '{}':", name);
  return {name, formulation_from_name(parts.str(2)),
          whole_number(what + " n", parts.str(3), 5, 4096),
          static_cast<int>(whole_number(what + " s", parts.str(4), 1, max_stages)),
          parts[1].matched ? Solver::fast : Solver::published};
}

using Scenes = std::map<Index, Scene>;

const Scene& scene_of(const Cell& cell, Scenes& scenes) {
  if (!scenes.contains(cell.n)) scenes.emplace(cell.n, smooth_scene(cell.n));
  return scenes.at(cell.n);
}

std::unique_ptr<Integrator> make(const Cell& cell, const Scene& scene) {
  return gauss_entry(cell.formulation, cell.s, cell.solver).make(scene.flow, {}, backend);
}

// ---- the report

struct Measured {
  Json json;
  Matrix W;  // at the end
};

Json entries_of(const Matrix& W) {
  Json entries = Json::array();
  for (Index k = 0; k < W.size(); ++k) {
    entries.push_back({W.data()[k].real(), W.data()[k].imag()});
  }
  return entries;
}

// Returns W₀ with each number moved by a unit in the last place or none, skew-Hermitian as before.
Matrix moved_by_rounding(const Matrix& W0, std::uint64_t draw) {
  std::mt19937_64 random(draw);
  const auto moved = [&random](double number) {
    const double units = static_cast<double>(random() % 3) - 1.0;
    return number * (1.0 + units * std::numeric_limits<double>::epsilon());
  };
  Matrix W = W0;
  for (Index c = 0; c < W.cols(); ++c) {
    for (Index r = c; r < W.rows(); ++r) {
      W(r, c) = Complex(moved(W0(r, c).real()), moved(W0(r, c).imag()));
      if (r != c) W(c, r) = -std::conj(W(r, c));
    }
  }
  return W;
}

Json counts_of(const Cell& cell, const RunReport& report) {
  Json counts = {{"sweeps", report.sweeps}, {"poisson_solves", report.work.poisson_solves}};
  if (cell.is_fast()) {  // whose sweeps take more or fewer products, as their corrections do
    counts["equivalent_products"] = report.work.equivalent_products;
  } else {
    counts["products"] = report.work.products;
  }
  return counts;
}

Measured measure(const Cell& cell, const Scene& scene, int roundings) {
  const IntegratorEntry entry = gauss_entry(cell.formulation, cell.s);
  const auto integrator = make(cell, scene);
  Matrix W = scene.initial;
  integrator->step(W, step_size);  // the BLAS sets up its own buffers in its first product
  W = scene.initial;
  RunReport report;
  const long allocations =
      allocations_during([&] { report = run(*integrator, W, step_size, step_total); });
  Json json = {{"name", cell.name},
               {"n", cell.n},
               {"status", name(report.status)},
               {"steps", step_total},
               {"tolerance", IterationOptions{}.tolerance},
               {"norm", scene.initial.norm()},
               {"contraction", step_size / entry.linear_limit(generator_frequencies(scene))},
               {"allocations", allocations}};
  json.update(counts_of(cell, report));
  json["other_roundings"] = Json::array();
  for (int draw = 1; draw <= roundings; ++draw) {
    Matrix V = moved_by_rounding(scene.initial, static_cast<std::uint64_t>(draw));
    const RunReport other = run(*make(cell, scene), V, step_size, step_total);
    if (!other.converged()) json["status"] = name(other.status);
    json["other_roundings"].push_back(counts_of(cell, other));
  }
  if (report.converged()) {
    ConservationWatch watch(scene);
    const Conservation kept = watch.report(W);
    json["spectrum_error"] = kept.spectrum_error;
    json["skew_defect"] = kept.skew_defect;
    if (cell.n <= largest_listed) json["W"] = entries_of(W);
  }
  return {std::move(json), std::move(W)};
}

int report(const std::vector<Cell>& cells, int roundings) {
  Scenes scenes;
  std::vector<Measured> measured;
  std::map<std::tuple<Formulation, Index, int>, const Matrix*> published;
  measured.reserve(cells.size());
  for (const Cell& cell : cells) {
    measured.push_back(measure(cell, scene_of(cell, scenes), roundings));
    if (!cell.is_fast()) published[{cell.formulation, cell.n, cell.s}] = &measured.back().W;
  }
  Json json = {{"format", "isosyrk regression_cells 2"}};
  for (const auto& conditions : {machine_conditions("regression_cells", backend, {}),
                                 solver_conditions({}, HbarConvention::paper, default_modes())}) {
    for (const auto& [name, value] : conditions) json["context"][name] = value;
  }
  json["cells"] = Json::array();
  for (std::size_t k = 0; k < cells.size(); ++k) {
    // A published form is compared with group, a fast one with its published form.
    const Cell& cell = cells[k];
    const Formulation other = cell.is_fast() ? cell.formulation : Formulation::group;
    const auto found = published.find({other, cell.n, cell.s});
    if (found != published.end() && measured[k].json["status"] == "converged") {
      measured[k].json[cell.is_fast() ? "distance_to_published" : "distance_to_group"] =
          (measured[k].W - *found->second).cwiseAbs().maxCoeff();
    }
    json["cells"].push_back(std::move(measured[k].json));
  }
  fmt::print("{}\n", json.dump());
  require_printed();
  return exit_done;
}

// ---- the server

// Every run starts from W₀.  A fast form starts cold there, since it predicts only from the state
// at which its last step ended.
double seconds_of(Integrator& integrator, const Scene& scene, long steps, long runs) {
  Matrix W = scene.initial;
  long sweeps = 0;
  const double start = cpu_seconds();
  for (long k = 0; k < runs; ++k) {
    W = scene.initial;
    const RunReport report = run(integrator, W, step_size, steps);
    if (!report.converged()) throw SolverFailed("a run did not converge");
    if (k > 0 && report.sweeps != sweeps) throw SolverFailed("a run did not repeat the one before");
    sweeps = report.sweeps;
  }
  return cpu_seconds() - start;
}

int serve(const std::vector<Cell>& cells) {
  Scenes scenes;
  std::vector<std::unique_ptr<Integrator>> integrators;
  for (const Cell& cell : cells) {
    const Scene& scene = scene_of(cell, scenes);
    integrators.push_back(make(cell, scene));
    seconds_of(*integrators.back(), scene, 1, 1);  // touches all memory
  }
  fmt::print("ready\n");
  require_printed();
  for (std::string line; std::getline(std::cin, line); require_printed()) {
    std::istringstream input(line);
    std::size_t cell = 0;
    long steps = 0;
    long runs = 0;
    if (!(input >> cell >> steps >> runs) || cell >= cells.size() || steps < 1 || runs < 1) {
      throw BadArgument(
          fmt::format("'{}': must be CELL STEPS RUNS, CELL below {}", line, cells.size()));
    }
    fmt::print("{}\n", seconds_of(*integrators[cell], scenes.at(cells[cell].n), steps, runs));
  }
  return exit_done;
}

}  // namespace

int main_program(int argc, char** argv) {
  CommandLine line{
      "Counts and errors of cells of Tables 1 and 2 as JSON, or their times on demand."};
  std::vector<std::string> names;
  line.add_values("cells", names, "names like group/n:17/s:2 and fast_group/n:17/s:2").required();
  int roundings = 0;
  line.add_value("--roundings", roundings, Whole<int>{0, 100},
                 "count also from so many states moved by rounding (default: 0)");
  bool as_server = false;
  line.add_flag("--serve", as_server, "answer lines `CELL STEPS RUNS` with CPU seconds");
  if (const auto exit_code = line.parse(argc, argv)) return *exit_code;
  use_one_blas_thread();
  std::vector<Cell> cells;
  for (const std::string& name : names) cells.push_back(read_cell(name));
  return as_server ? serve(cells) : report(cells, roundings);
}

}  // namespace isosyrk::regression_cells
