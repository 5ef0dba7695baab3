#include "benchmarks/table_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include "benchmarks/arguments.h"
#include "benchmarks/benchmark_program.h"
#include "benchmarks/command_line.h"
#include "benchmarks/product_rate.h"
#include "benchmarks/reference.h"
#include "benchmarks/stolen_time.h"
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/machine/clocks.h"
#include "isosyrk/scenes/euler_zeitlin_scenes.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/simulation/run.h"
#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {
namespace {

constexpr double step_size = 0.1;
constexpr long step_total = 50;
const std::vector<Index> sizes = {17, 33, 65, 129};
const std::vector<int> stage_counts = {1, 2, 3};

// What makes one table of the other.
struct Table {
  std::string name;  // "table1"; cells are named table1/group/n:17/s:2
  std::string description;
  Solver solver;
  int threads = 1;             // cells of 2 threads are named table2/group/n:17/s:2/threads:2
  Conditions conditions = {};  // in place of those of the same name

  IntegratorEntry entry(Formulation formulation, int stages) const {
    return gauss_entry(formulation, stages, solver, {.threads = threads});
  }
  // Products per second: what product_share is a share of.
  double product_rate(ProductBackend backend, Index n) const {
    constexpr double seconds = 0.03;
    return solver == Solver::fast ? split_product_rate(n, seconds)
                                  : isosyrk::product_rate(backend, n, seconds);
  }
};

Table published_table() {
  return {.name = "table1",
          .description =
              "Times 50 steps of each formulation at n = 17, 33, 65, 129 and s = 1, 2, 3 (the "
              "paper's Table 1).",
          .solver = Solver::published};
}

Table fast_table(int threads) {
  return {
      .name = "table2",
      .description =
          "Times 50 steps of the fast form of each formulation at n = 17, 33, 65, 129 and "
          "s = 1, 2, 3: the answers of Table 1, sooner.",
      .solver = Solver::fast,
      .threads = threads,
      .conditions = {
          {"products", fmt::format("split, {} kernels", gemm_kernels().front().name)},
          {"start",
           fmt::format("from the last {} steps, {} from n = 48 on, by weights fitted to how they "
                       "followed from each other; cold at first",
                       tuning.past_steps(17), tuning.past_steps(48))},
          {"update_order",
           "residuals in double precision, Jacobi; Newton corrections in single precision; from "
           "n = 48 on without what lies so far off the diagonal that it comes to a hundredth of "
           "the tolerance"}}};
}

struct CellId {
  const Table* table;
  Formulation formulation;
  Index n;
  int s;

  std::string name() const {
    const std::string cell =
        fmt::format("{}/{}/n:{}/s:{}", table->name, isosyrk::name(formulation), n, s);
    return table->threads == 1 ? cell : fmt::format("{}/threads:{}", cell, table->threads);
  }
};

std::vector<std::string> names_of(const std::vector<CellId>& cells) {
  std::vector<std::string> names;
  for (const CellId& cell : cells) names.push_back(cell.name());
  return names;
}

// The warm run of a cell: the 50 steps, untimed, in which the energy is watched.
struct WarmRun {
  RunReport report;
  double energy_error = 0.0;  // where it converged
};

WarmRun warm_run(const Scene& scene, Integrator& integrator) {
  ConservationWatch watch(scene);
  Matrix W = scene.initial;
  WarmRun warm;
  warm.report = run(integrator, W, step_size, step_total,
                    [&](long, const Matrix& V, const StepReport&) { watch.observe(V); });
  if (warm.report.converged()) warm.energy_error = watch.report(W).energy_error;
  return warm;
}

// Touches the integrator's memory and no more, where there is no warm run.
void warm_step(const Scene& scene, Integrator& integrator) {
  Matrix W = scene.initial;
  integrator.step(W, step_size);
}

// Progress over interleaved repetitions, during which Google Benchmark prints nothing.
class CellProgress {
 public:
  CellProgress(std::size_t cells, long repetitions) : cells_(cells), repetitions_(repetitions) {}

  void finished(const std::string& cell, double cpu_seconds_per_run, double wall_seconds) {
    Seen& seen = seen_[cell];
    ++seen.calls;
    seen.wall_seconds = wall_seconds;
    const double elapsed = isosyrk::wall_seconds() - start_;
    std::fputs(fmt::format("[{:4.0f} s{}] {}  {:.4g} s a run\n", elapsed, time_left(), cell,
                           cpu_seconds_per_run)
                   .c_str(),
               stderr);
  }

 private:
  struct Seen {
    long calls = 0;
    double wall_seconds = 0.0;
  };

  // Known once every cell was run.
  std::string time_left() const {
    if (seen_.size() < cells_) return "";
    double seconds = 0.0;
    for (const auto& [name, each] : seen_) {
      seconds += static_cast<double>(std::max(0L, repetitions_ - each.calls)) * each.wall_seconds;
    }
    return fmt::format(", about {:.0f} s left", seconds);
  }

  std::size_t cells_;
  long repetitions_;
  double start_ = wall_seconds();
  std::map<std::string, Seen> seen_;
};

/// One cell of the table.  One timed iteration is the whole run of 50 steps.
class Cell {
 public:
  Cell(const CellId& id, const IterationOptions& options, ProductBackend backend, bool warm,
       const std::optional<Reference>& reference, CellProgress& progress)
      : table_(*id.table),
        id_(id),
        options_(options),
        backend_(backend),
        warm_(warm),
        reference_(reference),
        progress_(progress) {}

  void time(benchmark::State& state) {
    set_up();
    const double wall_start = wall_seconds();
    if (warm_run_ && fails(state, warm_run_->report)) return;
    // The product rate of the moment, on both sides of what it is compared with.
    const double rate_before = table_.product_rate(backend_, id_.n);
    Matrix W = scene_.initial;
    RunReport timed;
    const auto processors_before = processor_times();
    const double run_start = wall_seconds();
    const double start = cpu_seconds();
    for ([[maybe_unused]] auto _ : state) {
      W = scene_.initial;
      timed = run(*integrator_, W, step_size, step_total);
      benchmark::DoNotOptimize(W.data());
    }
    const double elapsed = wall_seconds() - run_start;
    const double stolen = stolen_seconds(processors_before, processor_times(), table_.threads);
    // Of several threads each could have multiplied all the time that passed.
    const double seconds = (table_.threads == 1 ? cpu_seconds() - start : elapsed) /
                           static_cast<double>(state.iterations());
    const double rate = 0.5 * (rate_before + table_.product_rate(backend_, id_.n));
    if (fails(state, timed)) return;
    if (warm_run_ && timed.sweeps != warm_run_->report.sweeps) {
      fail_row(state, fmt::format("{} sweeps where the run before took {}", timed.sweeps,
                                  warm_run_->report.sweeps));
      return;
    }
    const Conservation kept = ConservationWatch(scene_).report(W);
    state.counters["sweeps_per_step"] = timed.sweeps_per_step();
    state.counters["products"] = static_cast<double>(timed.work.products);
    state.counters["poisson_solves"] = static_cast<double>(timed.work.poisson_solves);
    state.counters["spectrum_error"] = kept.spectrum_error;
    state.counters["skew_defect"] = kept.skew_defect;
    if (warm_run_) state.counters["energy_error"] = warm_run_->energy_error;
    state.counters["h_norm_B"] = h_norm_B_;
    if (reference_) {
      state.counters["relative_error"] = relative_error(W, reference_->W);
      state.counters["reference_uncertainty"] = reference_->uncertainty;
    }
    state.counters["product_share"] =
        timed.work.equivalent_products / rate / seconds / table_.threads;
    state.counters["stolen"] = stolen / elapsed / table_.threads;
    if (table_.solver == Solver::fast) {
      state.counters["equivalent_products"] = timed.work.equivalent_products;
    }
    progress_.finished(id_.name(), seconds, wall_seconds() - wall_start);
  }

 private:
  void set_up() {
    if (integrator_) return;  // repetitions share one cell
    scene_ = smooth_scene(id_.n);
    h_norm_B_ = step_size * generator_norms(scene_).B;
    integrator_ = table_.entry(id_.formulation, id_.s).make(scene_.flow, options_, backend_);
    if (warm_) {
      warm_run_ = warm_run(scene_, *integrator_);
    } else {
      warm_step(scene_, *integrator_);
    }
  }

  // Makes the row an error row if a run failed.
  static bool fails(benchmark::State& state, const RunReport& report) {
    if (report.converged()) return false;
    fail_row(state, fmt::format("{} at step {} (last change {:.2g})", isosyrk::name(report.status),
                                report.failed_step, report.last_change));
    return true;
  }

  const Table& table_;
  CellId id_;
  IterationOptions options_;
  ProductBackend backend_;
  bool warm_;
  const std::optional<Reference>& reference_;
  CellProgress& progress_;
  Scene scene_;
  double h_norm_B_ = 0.0;
  std::unique_ptr<Integrator> integrator_;
  std::optional<WarmRun> warm_run_;
};

}  // namespace

int time_table(Solver solver, int argc, char** argv) {
  const bool fast = solver == Solver::fast;
  const Table published = published_table();
  const Table table = fast ? fast_table(1) : published;
  CommandLine line{table.description +
                   "  Takes Google Benchmark's arguments as well, such as "
                   "--benchmark_filter=n:17/ and --benchmark_out=FILE."};
  BackendChoice choice;
  line.add_value("--products", choice, Named{&backend_choice_from_name},
                 "of published forms: fastest (default), openblas or eigen");
  bool no_warm_run = false;
  line.add_flag("--no-warm-run", no_warm_run,
                "one untimed step in place of an untimed run before the timed ones; rows then have "
                "no energy_error");
  bool with_published = false;
  int threads = 1;
  if (fast) {
    line.add_flag("--published", with_published, "times the cells of table1 too");
    line.add_value("--threads", threads, thread_count,
                   "1 (default) to 64; N > 1 times the cells by N threads too");
  }
  IterationOptions options;
  line.add_value("--max-sweeps", options.max_sweeps, Whole<int>{1, 1000000},
                 "sweeps allowed in a step (default 1000)");
  std::string references;
  line.add_value("--references", references, Text{},
                 "folder of recorded reference solutions: adds relative_error");
  line.allow_extras();
  if (const auto exit_code = line.parse(argc, argv)) return *exit_code;
  use_one_blas_thread();

  std::vector<const Table*> tables = {&table};
  if (with_published) tables.push_back(&published);
  std::optional<Table> threaded;
  note_more_threads_than_cores(table.name.c_str(), threads);
  if (threads > 1) {
    threaded = fast_table(threads);
    tables.push_back(&*threaded);
  }
  std::map<Index, std::vector<CellId>> cells;
  std::vector<std::string> names;
  for (const Index n : sizes) {
    for (const Formulation formulation : formulations()) {
      for (const int s : stage_counts) {
        for (const Table* each : tables) cells[n].push_back({each, formulation, n, s});
      }
    }
    for (std::string& name : names_of(cells[n])) names.push_back(std::move(name));
  }
  const BenchmarkArguments arguments = read_benchmark_arguments(line.remaining(), names);
  CellProgress progress(names.size(), arguments.repetitions);

  std::vector<BackendRates> rates;
  std::map<Index, std::optional<Reference>> reference;  // of each n that the filter leaves in
  for (const Index n : sizes) {
    if (line.has("--references") && arguments.selects_any(names_of(cells[n]))) {
      reference[n] = read_reference("--references", references, smooth_scene(n),
                                    HbarConvention::paper, default_modes());
    }
    rates.push_back(choose_backend(choice, n));
    for (const CellId& cell : cells[n]) {
      const auto timed = std::make_shared<Cell>(cell, options, rates.back().chosen, !no_warm_run,
                                                reference[n], progress);
      benchmark::RegisterBenchmark(cell.name().c_str(), [timed](benchmark::State& state) {
        timed->time(state);
      })->Unit(benchmark::kMillisecond);
    }
  }
  Conditions conditions = table.conditions;  // of those with one name the first stays
  conditions.merge(solver_conditions(options, HbarConvention::paper, default_modes()));
  Conditions machine = machine_conditions(table.name, choice, rates);
  if (with_published) conditions["published_products"] = machine["products"];
  conditions.merge(machine);
  if (const std::string remark = notice(); !remark.empty()) {
    print_error(table.name.c_str(), "note: " + remark);
  }
  return run_benchmarks(argv[0], arguments, conditions);
}

}  // namespace isosyrk
