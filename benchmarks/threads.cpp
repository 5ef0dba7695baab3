// What threads gain: the time that passes for a step of a fast form by each number of threads, in
// turns, and whether the answers are the same bit for bit.
#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/command_line.h"
#include "isosyrk/catalogue/make_integrator.h"
#include "isosyrk/machine/clocks.h"
#include "isosyrk/scenes/scene_list.h"
#include "isosyrk/split/parallel.h"

namespace isosyrk::threads {
namespace {

using nlohmann::json;

// What is asked for.
struct Request {
  Index n = 0;
  std::string integrator, scene = "rough";
  double step = 0.0, tolerance = 1e-8;
  long steps = 4, warmup = 2;
  int repetitions = 3;
  std::vector<int> threads;
};

// What one number of threads has taken.
struct Row {
  int threads;
  std::vector<double> seconds = {};  // that pass for a step, one for each repetition
  std::vector<double> looking = {};  // that pass until the state is there
  double all_seconds = 0.0;          // of all steps
  OperationTimes times = {};         // of the same
  Matrix W = {};
};

std::optional<int> read(Request& request, int argc, char** argv) {
  CommandLine line{"Times a step of a fast form by several numbers of threads, and compares bits."};
  line.add_value("--n", request.n, Whole<Index>{5, 4096}, "matrix size, 5 to 4096").required();
  line.add_value("--integrator", request.integrator, Text{}, "name of a listed integrator")
      .required();
  line.add_value("--step", request.step, Real{"positive and finite", positive}, "step size h > 0")
      .required();
  line.add_value("--scene", request.scene, Text{}, "of Euler-Zeitlin (default rough)");
  line.add_value("--tolerance", request.tolerance, Real{"at least 1e-15, and finite", 1e-15},
                 "of the fast form (default 1e-8)");
  line.add_value("--steps", request.steps, Whole<long>{1, 1000000}, "that are timed (default 4)");
  line.add_value("--warmup", request.warmup, Whole<long>{0, 1000000},
                 "steps before these (default 2)");
  line.add_value("--repetitions", request.repetitions, Whole<int>{1, 1000},
                 "interleaved, each from the start (default 3)");
  std::vector<std::string> threads;
  line.add_values("--threads", threads, "numbers of threads, as 1 2 4").required();
  if (const auto code = line.parse(argc, argv)) return code;
  for (const std::string& each : threads) {
    request.threads.push_back(thread_count("--threads", each));
  }
  require_scene("--scene", request.scene);
  return {};
}

void run(const Request& request, const Scene& scene, Row& row) {
  const auto integrator = of_option([&] {
    return make_integrator(scene.flow, request.integrator,
                           {.solver = Solver::fast,
                            .iteration = {.tolerance = request.tolerance},
                            .threads = row.threads});
  });
  integrator->set_state(scene.initial);
  const auto advance = [&](long steps) {
    for (long k = 0; k < steps; ++k) {
      if (integrator->step(request.step).status != Status::converged) {
        throw SolverFailed(fmt::format("{}: step {} failed", request.integrator, k + 1));
      }
    }
  };
  advance(request.warmup);
  measure_operations(&row.times);  // a few clock readings an operation, less than 1 % of a step
  const double begin = wall_seconds();
  advance(request.steps);
  const double taken = wall_seconds() - begin;
  measure_operations(nullptr);
  row.all_seconds += taken;
  row.seconds.push_back(taken / static_cast<double>(request.steps));
  row.W.resize(request.n, request.n);
  const double before = wall_seconds();
  integrator->state(row.W);
  row.looking.push_back(wall_seconds() - before);
}

json of_row(const Row& row, const Row& first, long steps) {
  return {{"threads", row.threads},
          {"seconds", row.seconds},
          {"looking", row.looking},
          {"operations", static_cast<double>(row.times.operations) /
                             static_cast<double>(steps * static_cast<long>(row.seconds.size()))},
          {"serial", 1.0 - row.times.within / row.all_seconds},
          {"waiting", 1.0 - row.times.busy / (row.threads * row.times.within)},
          {"same", std::memcmp(row.W.data(), first.W.data(),
                               sizeof(Complex) * static_cast<std::size_t>(row.W.size())) == 0}};
}

}  // namespace

int main_program(int argc, char** argv) {
  Request request;
  if (const auto code = read(request, argc, argv)) return *code;
  const Scene scene = of_option([&] { return scene_by_name(request.scene, request.n); });
  std::vector<Row> rows;
  for (const int threads : request.threads) rows.push_back({.threads = threads});
  for (int k = 0; k < request.repetitions; ++k) {
    for (Row& row : rows) run(request, scene, row);
  }
  json found = json::array();
  for (const Row& row : rows) found.push_back(of_row(row, rows.front(), request.steps));
  fmt::print("{}\n", json{{"n", request.n},
                          {"integrator", request.integrator},
                          {"scene", request.scene},
                          {"step", request.step},
                          {"tolerance", request.tolerance},
                          {"steps", request.steps},
                          {"rows", found}}
                         .dump());
  require_printed();
  return exit_done;
}

}  // namespace isosyrk::threads
