// What a step of the fast forms costs: against n, and idea by idea from the published forms on.
//
// Against n the step size is such that h‖B(W₀)‖₂ is the same, so that sweeps stay comparable; the
// ideas are measured at Table 1's step.  Everything that is compared is timed in turns.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "benchmarks/arguments.h"
#include "benchmarks/clocks.h"
#include "benchmarks/command_line.h"
#include "benchmarks/conditions.h"
#include "benchmarks/output_file.h"
#include "benchmarks/peak.h"
#include "benchmarks/progress.h"
#include "benchmarks/raw_file.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/simulation/run.h"
#include "isosyrk/solver/predictor.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk::scaling {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<Index> default_sizes = {9, 17, 33, 65, 129, 257, 513};
const std::vector<Index> quick_sizes = {9, 17, 33, 65};
const std::vector<Index> idea_sizes = {17, 129};
const std::vector<Index> quick_idea_sizes = {17};
const std::vector<int> stage_counts = {1, 2, 3};

constexpr double scaling_h_norm_B = 0.4;
constexpr double table1_step = 0.1;
constexpr long warm_steps = Predictor::most + 1;  // until the predictor reads as many steps as it may
constexpr int repetitions = 7;
constexpr long most_steps = 200;

struct Measuring {
  double least_seconds;  // of a repetition
  Progress progress;
};

// One way to do the steps of a cell.
struct Variant {
  Json fields;  // what it is
  std::unique_ptr<Integrator> integrator;
  Matrix W = {};
  long steps = 0;  // of a repetition
  std::vector<double> seconds_per_step = {};
  RunReport total = {};
};

void require_converged(const RunReport& report, const Variant& variant) {
  if (report.converged()) return;
  throw SolverFailed(fmt::format("{}: {} at step {}", variant.fields.dump(), name(report.status),
                                 report.failed_step));
}

// Times all variants in turns, from the initial data on past the first steps, and returns what each
// step took.
Json timed(const Scene& scene, double h, std::vector<Variant>& variants, const Measuring& measuring,
           const std::string& title) {
  for (Variant& each : variants) {
    each.W = scene.initial;
    const double start = cpu_seconds();
    require_converged(run(*each.integrator, each.W, h, warm_steps), each);
    const double one = (cpu_seconds() - start) / static_cast<double>(warm_steps);
    each.steps =
        std::clamp(static_cast<long>(std::ceil(measuring.least_seconds / std::max(one, 1e-9))), 1L,
                   most_steps);
  }
  std::vector<double> product_seconds, peaks;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    product_seconds.push_back(1.0 / split_product_rate(scene.initial.rows(), 0.03));
    peaks.push_back(1e-9 * measured_peak_flops());
    for (Variant& each : variants) {
      const double start = cpu_seconds();
      const RunReport report = run(*each.integrator, each.W, h, each.steps);
      each.seconds_per_step.push_back((cpu_seconds() - start) / static_cast<double>(each.steps));
      require_converged(report, each);
      each.total.steps += report.steps;
      each.total.sweeps += report.sweeps;
      each.total.products += report.products;
      each.total.poisson_solves += report.poisson_solves;
      each.total.equivalent_products += report.equivalent_products;
    }
    measuring.progress.say(
        fmt::format("{}, repetition {} of {}", title, repetition + 1, repetitions), "");
  }
  Json rows = Json::array();
  for (const Variant& each : variants) {
    const auto steps = static_cast<double>(each.total.steps);
    Json row = each.fields;
    row["n"] = scene.initial.rows();
    row["step"] = h;
    row["seconds_per_step"] = each.seconds_per_step;
    row["sweeps_per_step"] = static_cast<double>(each.total.sweeps) / steps;
    row["equivalent_products_per_step"] = each.total.equivalent_products / steps;
    row["poisson_solves_per_step"] = static_cast<double>(each.total.poisson_solves) / steps;
    row["product_seconds"] = product_seconds;
    row["peak_gflops"] = peaks;
    rows.push_back(row);
  }
  return rows;
}

Json what_cell(Formulation formulation, int s) {
  return {{"formulation", name(formulation)}, {"stages", s}};
}

Json scaling_rows(Index n, const Measuring& measuring) {
  const Scene scene = smooth_scene(n);
  std::vector<Variant> variants;
  for (const Formulation formulation : formulations()) {
    for (const int s : stage_counts) {
      variants.push_back(
          {what_cell(formulation, s),
           make_fast_gauss(formulation, s, *scene.flow)});
    }
  }
  return timed(scene, scaling_h_norm_B / generator_norms(scene).B, variants, measuring,
               fmt::format("n = {}", n));
}

struct Idea {
  std::string name;
  bool rung;  // of the ladder
  FastOptions options;
};

// From plain sweeps from a cold start on, one idea more in each, up to what the fast form takes by
// default: the rungs of a ladder.  The other rows are each one thing other than the default.
std::vector<Idea> ideas(Index n) {
  const FastOptions by_default;
  const bool banded = n >= tuning.smallest_banded;
  FastOptions cold;
  cold.past_steps = 0;
  cold.newton = false;
  cold.bands = false;
  FastOptions predicted = cold;
  predicted.past_steps = by_default.past_steps;
  FastOptions corrected = predicted;
  corrected.newton = true;
  FastOptions both = corrected;
  both.bands = true;
  FastOptions cut = predicted;
  cut.bands = true;
  std::vector<Idea> all = {{"structure and split products", true, cold},
                           {"predictor", true, predicted},
                           {"Newton in single precision", true, corrected},
                           {"bands", banded, both},
                           {"by default", false, by_default},
                           {"bands, no Newton", false, cut}};
  for (const int steps : {6, 8, 12, 16, 20, 24}) {
    FastOptions other;
    other.past_steps = steps;
    all.push_back({fmt::format("{} past steps", steps), false, other});
  }
  return all;
}

Json idea_rows(const Scene& scene, Formulation formulation, int s, ProductBackend backend,
               const Measuring& measuring) {
  const auto what = [&](const std::string& idea, bool rung) {
    Json fields = what_cell(formulation, s);
    fields["idea"] = idea;
    fields["rung"] = rung;
    return fields;
  };
  std::vector<Variant> variants;
  variants.push_back(
      {what("published", true), gauss_entry(formulation, s).make(*scene.flow, {}, backend)});
  for (const Idea& idea : ideas(scene.initial.rows())) {
    variants.push_back(
        {what(idea.name, idea.rung),
         make_fast_gauss(formulation, s, *scene.flow, idea.options)});
  }
  return timed(
      scene, table1_step, variants, measuring,
      fmt::format("ideas, {} at n = {}, s = {}", name(formulation), scene.initial.rows(), s));
}

}  // namespace

int main_program(int argc, char** argv) {
  CommandLine line{
      "Times steps of the fast forms against n, and idea by idea from the published forms on, and "
      "writes what each step took as JSON."};
  std::string out;
  std::vector<std::string> sizes_text;
  bool quick = false;
  line.option("--out", out, "JSON file to write", CommandLine::Need::required);
  line.option("--n", sizes_text, "matrix sizes, 5 to 1025 (default 9 17 33 65 129 257 513)");
  line.flag("--quick", quick, "n up to 65, ideas at n = 17 only");
  std::string seconds = "0.05";
  line.option("--seconds", seconds, "CPU seconds of a repetition at least (default 0.05)");
  if (const auto exit_code = line.read(argc, argv)) return *exit_code;
  use_one_blas_thread();
  std::vector<Index> sizes = quick ? quick_sizes : default_sizes;
  if (!sizes_text.empty()) {
    sizes.clear();
    for (const std::string& text : sizes_text) sizes.push_back(whole_number("--n", text, 5, 1025));
  }
  const Measuring measuring{positive_number("--seconds", seconds), {}};
  const OutputFile output("--out", out);

  std::vector<BackendRates> rates;
  for (const Index n : sizes) rates.push_back(choose_backend({}, n));
  Json json = {{"format", "isosyrk scaling 2"}};
  json["context"] = context_json("scaling", {}, rates, {});
  json["h_norm_B"] = scaling_h_norm_B;
  json["kernels"] = gemm_kernels().front().name;
  json["points"] = Json::array();
  for (const Index n : sizes) {
    for (const Json& row : scaling_rows(n, measuring)) json["points"].push_back(row);
  }
  json["ideas"] = Json::array();
  for (const Index n : quick ? quick_idea_sizes : idea_sizes) {
    const Scene scene = smooth_scene(n);
    const ProductBackend backend = choose_backend({}, n).chosen;
    for (const Formulation formulation : formulations()) {
      for (const int s : stage_counts) {
        for (const Json& row : idea_rows(scene, formulation, s, backend, measuring)) {
          json["ideas"].push_back(row);
        }
      }
    }
  }
  output.write(json.dump(1) + "\n");
  return exit_done;
}

}  // namespace isosyrk::scaling
