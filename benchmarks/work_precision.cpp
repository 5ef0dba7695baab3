// Accuracy against cost: every integrator over step sizes, and the formulations over tolerances.
//
// A line is one integrator at one n.  Its points are runs of the smooth scene to T, of more and
// more steps (as many as in Table 1 at least), until the error no longer falls, or a run took long
// enough and the slope of the line has settled.  First every run is made once and looked at; then
// all are timed, in turns, so that a slow minute of the machine falls on all lines alike.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "benchmarks/arguments.h"
#include "benchmarks/command_line.h"
#include "benchmarks/conditions.h"
#include "benchmarks/output_file.h"
#include "benchmarks/progress.h"
#include "benchmarks/raw_file.h"
#include "benchmarks/reference.h"
#include "benchmarks/timed_run.h"
#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/tableaux/gauss_tableau.h"

namespace isosyrk::work_precision {
namespace {

using Json = nlohmann::ordered_json;

// About a factor √2 apart, with Table 1's 50 among them.
const std::vector<long> default_steps = {5,    7,    10,   14,   20,   28,  35,  50,
                                         70,   100,  140,  200,  280,  400, 560, 800,
                                         1120, 1600, 2240, 3200, 4480, 6400};

const std::vector<Index> default_sizes = {17, 33, 65, 129};
const std::vector<Index> quick_sizes = {17, 33};

// A line that has settled ends with the first run, of at least Table 1's steps, that takes as many
// CPU seconds: so that all of n <= 65 takes under ten minutes, and n = 129 under thirty.
double long_enough(Index n) {
  if (n <= 17) return 0.2;
  if (n <= 33) return 0.5;
  if (n <= 65) return 1.4;
  return 7.0;
}

// One that has not settled ends with the first run that takes so many times as long.
constexpr double patience = 2.0;

constexpr long table1_step_count = 50;

// The tolerance study: Table 1's cells.  Not beyond n = 65, where it would take as long as all
// else.
constexpr Index largest_tolerance_size = 65;

struct Setting {
  Scene scene;
  Reference reference;
  GeneratorNorms norms;
  ProductBackend backend;

  Index n() const { return scene.initial.rows(); }
};

// A run to be timed again and again: what it is, and what it was when looked at.
struct Point {
  const Setting* setting = nullptr;
  Integrator* integrator = nullptr;
  long steps = 0;
  RunReport run{};
  std::string status{};
  Matrix W{};
  double error = std::nan("");
  Conservation kept{};
  std::array<double, 4> casimir_errors{};
  double angular_momentum_error = 0.0;
  double seconds_at_first = 0.0;
  std::vector<double> cpu_seconds{};

  bool usable() const { return !std::isnan(error); }
  double step() const { return setting->scene.time / static_cast<double>(steps); }
};

// A run of as many seconds is not disturbed by being looked at: its first time counts, and it is
// timed at most twice.
constexpr double long_run = 1.0;

// Looks at one run.  A run whose eigenvalues are off by a tenth of the largest, which is 1, has
// lost what it should keep, and is called unstable.
Point look(const Setting& setting, Integrator& integrator, long steps) {
  constexpr double lost = 0.1;
  Point point{.setting = &setting, .integrator = &integrator, .steps = steps};
  ConservationWatch watch(setting.scene);
  point.W = setting.scene.initial;
  const TimedRun timed = timed_run(integrator, point.W, point.step(), steps,
                                   [&](const Matrix& V) { watch.observe(V); });
  point.run = timed.run;
  point.seconds_at_first = timed.seconds;
  point.status = name(timed.run.status);
  if (!timed.run.converged()) return point;
  point.kept = watch.report(point.W);
  if (point.kept.spectrum_error > lost) {
    point.status = "unstable";
    return point;
  }
  point.casimir_errors = casimir_errors(point.W, setting.scene.initial);
  point.angular_momentum_error = angular_momentum_error(point.W, setting.scene.initial);
  point.error = relative_error(point.W, setting.reference.W);
  if (timed.seconds >= long_run) point.cpu_seconds.push_back(timed.seconds);
  return point;
}

// One repetition: as many runs as fill a hundredth of a second, so that the clock does not weigh.
void time_once(Point& point) {
  constexpr double least = 0.01;
  const double once = std::max(point.seconds_at_first, 1e-6);
  const int runs = std::max(1, static_cast<int>(std::ceil(least / once)));
  double seconds = 0.0;
  for (int k = 0; k < runs; ++k) {
    Matrix W = point.setting->scene.initial;
    seconds +=
        timed_run(*point.integrator, W, point.step(), point.steps, [](const Matrix&) {}).seconds;
  }
  point.cpu_seconds.push_back(seconds / runs);
}

struct Line {
  const IntegratorEntry* entry;
  std::unique_ptr<Integrator> integrator;
  std::vector<Point> points;
};

// log(error ratio) / log(step ratio) between two runs: the order, once steps are small.
double slope(const Point& coarse, const Point& fine) {
  return std::log(coarse.error / fine.error) /
         std::log(static_cast<double>(fine.steps) / static_cast<double>(coarse.steps));
}

// Whether the slope at the end of the line no longer changes, whatever it is.
bool has_settled(const std::vector<Point>& points) {
  constexpr double still = 0.1;
  if (points.size() < 3) return false;
  const Point* last = &points.back();
  const double change = slope(last[-1], last[0]) - slope(last[-2], last[-1]);
  return std::abs(change) < still;  // not where a run failed: its error is NaN
}

// More and more steps, as the head of this file says.
Line draw_line(const Setting& setting, const IntegratorEntry& entry,
               const std::vector<long>& step_counts, double enough) {
  constexpr double near_rounding = 1e-8;  // above, an error that does not fall is no floor yet
  Line line{&entry, entry.make(*setting.scene.flow, {}, setting.backend), {}};
  double last_error = std::nan("");
  for (const long steps : step_counts) {
    line.points.push_back(look(setting, *line.integrator, steps));
    Point& point = line.points.back();
    point.W.resize(0, 0);  // not needed again
    const bool at_floor = point.error < 2.0 * setting.reference.uncertainty ||
                          (last_error < near_rounding && point.error > 0.8 * last_error);
    const double wanted = has_settled(line.points) ? enough : patience * enough;
    const bool took_enough = point.usable() && point.seconds_at_first >= wanted;
    if ((at_floor || took_enough) && steps >= table1_step_count) break;
    last_error = point.error;
  }
  return line;
}

struct ToleranceCell {
  Formulation formulation;
  int stages;
  std::vector<double> tolerances;
  std::vector<std::unique_ptr<Integrator>> integrators;
  std::vector<Point> points;  // one for each tolerance, from loose to tight
};

ToleranceCell study_tolerance(const Setting& setting, Formulation formulation, int stages) {
  ToleranceCell cell{formulation, stages, {}, {}, {}};
  for (int exponent = 4; exponent <= 15; ++exponent) {
    SolverOptions options;
    options.tolerance = std::pow(10.0, -exponent);
    cell.tolerances.push_back(options.tolerance);
    cell.integrators.push_back(make_formulation(formulation, *setting.scene.flow,
                                                gauss_tableau(stages), options, setting.backend));
    cell.points.push_back(look(setting, *cell.integrators.back(), table1_step_count));
  }
  return cell;
}

Json costs_as_json(const Point& point) {
  return {{"sweeps", point.run.sweeps},
          {"products", point.run.products},
          {"poisson_solves", point.run.poisson_solves},
          {"cpu_seconds", point.cpu_seconds}};
}

// Numbers of a run that did not come to a usable end are null: nlohmann writes NaN so.
Json quality_as_json(const Point& point) {
  Json json = {{"n", point.setting->n()},
               {"steps", point.steps},
               {"step", point.step()},
               {"status", point.status}};
  if (!point.run.converged()) json["failed_step"] = point.run.failed_step;
  const double none = std::nan("");
  const bool usable = point.usable();
  json["error"] = point.error;
  json["spectrum_error"] = usable ? point.kept.spectrum_error : none;
  json["casimir_errors"] = usable ? Json(point.casimir_errors) : Json(nullptr);
  json["energy_error"] = usable ? point.kept.energy_error : none;
  json["angular_momentum_error"] = usable ? point.angular_momentum_error : none;
  json["skew_defect"] = usable ? point.kept.skew_defect : none;
  return json;
}

Json as_json(const Point& point, const IntegratorEntry& entry) {
  Json json = {{"integrator", entry.name}};
  json.update(quality_as_json(point));
  json["h_norm_B"] = point.step() * point.setting->norms.B;
  json["h_norm_ad_B"] = point.step() * point.setting->norms.ad_B;
  json["beyond_limit"] = point.step() * point.setting->norms.ad_B > entry.stability_limit;
  json.update(costs_as_json(point));
  return json;
}

// The error that the tolerance alone makes is the distance from the tightest that converged.
Json as_json(const ToleranceCell& cell, std::size_t at) {
  const Point& point = cell.points[at];
  const Matrix* tightest = nullptr;
  for (const Point& other : cell.points) {
    if (other.usable()) tightest = &other.W;
  }
  Json json = {{"formulation", name(cell.formulation)},
               {"stages", cell.stages},
               {"tolerance", cell.tolerances[at]}};
  json.update(quality_as_json(point));
  json["solver_error"] = point.usable() ? relative_error(point.W, *tightest) : std::nan("");
  json.update(costs_as_json(point));
  return json;
}

Json as_json(const ReferenceRun& run) {
  return {{"integrator", run.integrator}, {"steps", run.steps}};
}

// The command line.
struct Request {
  std::vector<Index> sizes;
  std::vector<const IntegratorEntry*> integrators;
  BackendChoice products;
  std::string references;
  std::vector<long> steps;
  long repetitions;
  std::optional<double> longest;
  std::optional<OutputFile> output;
};

struct Text {
  std::vector<std::string> sizes, integrators, steps;
  std::string products = "fastest";
  std::string references, out;
  std::string repetitions = "3";
  std::string longest;
  bool quick = false;
};

Request parse(const Text& text) {
  Request request;
  for (const std::string& n : text.sizes) {
    request.sizes.push_back(whole_number("--n", n, 5, 513));
  }
  if (request.sizes.empty()) request.sizes = text.quick ? quick_sizes : default_sizes;
  for (const std::string& wanted : text.integrators) {
    request.integrators.push_back(&integrator_entry(wanted));
  }
  if (request.integrators.empty()) {
    for (const IntegratorEntry& entry : integrators()) request.integrators.push_back(&entry);
  }
  for (const std::string& steps : text.steps) {
    request.steps.push_back(whole_number("--steps", steps, 1, 1000000));
  }
  if (request.steps.empty()) request.steps = default_steps;
  if (!std::is_sorted(request.steps.begin(), request.steps.end(), std::less_equal<>())) {
    throw BadArgument("--steps: must rise");
  }
  request.products = backend_choice(text.products);
  request.references = text.references;
  request.repetitions = whole_number("--repetitions", text.repetitions, 1, 1000);
  if (!text.longest.empty()) request.longest = positive_number("--longest", text.longest);
  request.output.emplace("--out", text.out);
  return request;
}

class Study {
 public:
  explicit Study(const Request& request) : request_(request) {
    for (const Index n : request.sizes) {
      auto setting = std::make_unique<Setting>();
      setting->scene = smooth_scene(n);
      setting->reference = read_reference("--references", request.references, setting->scene,
                                          HbarConvention::paper, default_modes());
      setting->norms = generator_norms(setting->scene);
      rates_.push_back(choose_backend(request.products, n));
      setting->backend = rates_.back().chosen;
      settings_.push_back(std::move(setting));
    }
  }

  void run() {
    for (const auto& setting : settings_) {
      for (const IntegratorEntry* entry : request_.integrators) {
        lines_.push_back(draw_line(*setting, *entry, request_.steps, enough(setting->n())));
        say(fmt::format("looked at {} at n = {}: {} runs", entry->name, setting->n(),
                        lines_.back().points.size()));
      }
    }
    for (const auto& setting : settings_) {
      if (setting->n() > largest_tolerance_size) continue;
      for (const Formulation formulation : formulations()) {
        for (int s = 1; s <= 3; ++s) {
          const std::string gauss = fmt::format("{}{}", name(formulation), s);
          const auto wanted = [&](const IntegratorEntry* entry) { return entry->name == gauss; };
          if (std::none_of(request_.integrators.begin(), request_.integrators.end(), wanted))
            continue;
          cells_.push_back(study_tolerance(*setting, formulation, s));
        }
      }
      say(fmt::format("looked at tolerances at n = {}", setting->n()));
    }
    for (long repetition = 1; repetition <= request_.repetitions; ++repetition) {
      for (Line& line : lines_) time_all(line.points, repetition);
      for (ToleranceCell& cell : cells_) time_all(cell.points, repetition);
      say(fmt::format("timed all runs, {} of {} times", repetition, request_.repetitions));
    }
  }

  Json as_json() const {
    Json json = {{"format", "isosyrk work_precision 1"}};
    json["context"] = context_json("work_precision", request_.products, rates_, {});
    json["scene"] = settings_.front()->scene.name;
    json["time"] = settings_.front()->scene.time;
    for (const auto& setting : settings_) {
      const Reference& reference = setting->reference;
      json["references"].push_back({{"n", setting->n()},
                                    {"uncertainty", reference.uncertainty},
                                    {"first", work_precision::as_json(reference.first)},
                                    {"second", work_precision::as_json(reference.second)}});
    }
    for (const IntegratorEntry* entry : request_.integrators) {
      json["integrators"].push_back(integrator_json(*entry));
      json["integrators"].back()["stability_limit"] = entry->stability_limit;
    }
    for (const Line& line : lines_) {
      for (const Point& point : line.points) {
        json["points"].push_back(work_precision::as_json(point, *line.entry));
      }
    }
    json["tolerance_points"] = Json::array();
    for (const ToleranceCell& cell : cells_) {
      for (std::size_t at = 0; at < cell.points.size(); ++at) {
        json["tolerance_points"].push_back(work_precision::as_json(cell, at));
      }
    }
    return json;
  }

 private:
  double enough(Index n) const { return request_.longest.value_or(long_enough(n)); }

  static void time_all(std::vector<Point>& points, long repetition) {
    for (Point& point : points) {
      if (point.usable() && timings(point) < wanted_timings(point, repetition)) time_once(point);
    }
  }

  static long timings(const Point& point) { return static_cast<long>(point.cpu_seconds.size()); }

  static long wanted_timings(const Point& point, long repetitions) {
    return point.seconds_at_first < long_run ? repetitions : std::min(repetitions, 2L);
  }

  // Of lines not yet drawn a guess: points cost less and less towards large steps.
  double seconds_left() const {
    constexpr double line_over_longest = 3.4;  // 1 + 1/√2 + 1/2 + ...
    const auto passes = static_cast<double>(request_.repetitions);
    double seconds = 0.0;
    for (std::size_t k = lines_.size(); k < settings_.size() * request_.integrators.size(); ++k) {
      const Index n = settings_[k / request_.integrators.size()]->n();
      seconds += (1.0 + passes) * line_over_longest * enough(n);
    }
    for (const Line& line : lines_) seconds += seconds_left(line.points);
    for (const ToleranceCell& cell : cells_) seconds += seconds_left(cell.points);
    return seconds;
  }

  double seconds_left(const std::vector<Point>& points) const {
    double seconds = 0.0;
    for (const Point& point : points) {
      if (!point.usable()) continue;
      seconds += point.seconds_at_first *
                 static_cast<double>(wanted_timings(point, request_.repetitions) - timings(point));
    }
    return seconds;
  }

  void say(const std::string& what) const {
    progress_.say(what, fmt::format("about {:.0f} s left", seconds_left()));
  }

  const Request& request_;
  std::vector<BackendRates> rates_;
  std::vector<std::unique_ptr<Setting>> settings_;
  std::vector<Line> lines_;
  std::vector<ToleranceCell> cells_;
  Progress progress_;
};

}  // namespace

int main_program(int argc, char** argv) {
  CommandLine line{
      "Runs every integrator over step sizes, and the three formulations over tolerances, and "
      "writes error, invariants and cost of each run as JSON."};
  Text text;
  line.option("--references", text.references, "folder of recorded reference solutions",
              CommandLine::Need::required);
  line.option("--out", text.out, "write the measurements here, as JSON",
              CommandLine::Need::required);
  line.option("--n", text.sizes, "matrix sizes (default 17 33 65 129)");
  line.option("--integrator", text.integrators, "names of integrators (default all)");
  line.option("--steps", text.steps, "numbers of steps to T, rising (default 5 to 6400)");
  line.option("--repetitions", text.repetitions, "timings of each run (default 3)");
  line.option("--longest", text.longest, "CPU seconds of a run that ends a line (default by n)");
  line.option("--products", text.products, "fastest (default), openblas or eigen");
  line.flag("--quick", text.quick, "n = 17 and 33 only");
  if (const auto exit_code = line.read(argc, argv)) return *exit_code;
  use_one_blas_thread();
  const Request request = parse(text);
  print_notice("work_precision");
  Study study(request);
  study.run();
  request.output->write(study.as_json().dump(1) + "\n");
  return exit_done;
}

}  // namespace isosyrk::work_precision
