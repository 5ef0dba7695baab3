#include "benchmarks/integrate/integrate_arguments.h"

#include <fmt/ranges.h>

#include "benchmarks/command_line.h"
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/scenes/scene_list.h"

namespace isosyrk {
namespace {

// The command line as text; every value is read strictly by `parse`.
struct Text {
  std::string n, stages, formulation, integrator, step, time;
  std::string tolerance = "1e-13";
  std::string max_sweeps = "1000";
  std::string hbar;
  std::string products = "fastest";
  std::string solver = "published";
  std::string threads = "1";
  std::string scene = "smooth";
  std::string modes, initial, signature;
  std::string output;
  bool json = false;
};

bool given(const CLI::App& line, const char* option) { return line.count(option) > 0; }

// --integrator, or --formulation and --stages, and --solver.
void choose_integrator(const Text& text, const CLI::App& line, IntegrateRequest& request) {
  if (given(line, "--integrator") && (given(line, "--formulation") || given(line, "--stages"))) {
    throw BadArgument(
        fmt::format("--integrator {}: must stand alone, in place of --formulation and --stages",
                    text.integrator));
  }
  if (text.solver != "published" && text.solver != "fast") {
    throw BadArgument(fmt::format("--solver '{}': must be published or fast", text.solver));
  }
  const bool fast = text.solver == "fast";
  if (fast && given(line, "--products")) {
    throw BadArgument(fmt::format(
        "--solver fast: has products of its own; must stand without --products {}", text.products));
  }
  if (!fast && given(line, "--threads")) {
    throw BadArgument(
        fmt::format("--threads {}: must go with --solver fast; others have one", text.threads));
  }
  request.threads = thread_count("integrate", text.threads);
  request.method = text.solver;
  const FastOptions options = with_defaults({.threads = request.threads}, request.n);
  if (given(line, "--integrator")) {
    request.integrator =
        fast ? fast_entry(text.integrator, options) : integrator_entry(text.integrator);
    return;
  }
  if (!given(line, "--stages")) throw BadArgument("--stages is required, or --integrator");
  if (!given(line, "--formulation"))
    throw BadArgument("--formulation is required, or --integrator");
  const int stages = static_cast<int>(whole_number("--stages", text.stages, 1, max_stages));
  request.formulation = formulation_from_name(text.formulation);
  request.integrator = fast ? fast_gauss_entry(*request.formulation, stages, options)
                            : gauss_entry(*request.formulation, stages);
}

// P,Q of --signature.
std::pair<Index, Index> signature_of(const std::string& text) {
  const auto comma = text.find(',');
  if (comma == std::string::npos) {
    throw BadArgument(fmt::format("--signature '{}': must be P,Q", text));
  }
  return {whole_number("--signature", text.substr(0, comma), 1, 4095),
          whole_number("--signature", text.substr(comma + 1), 1, 4095)};
}

// --scene, --modes or --initial.
void choose_scene(const Text& text, const CLI::App& line, IntegrateRequest& request) {
  require_scene("--scene", text.scene);
  request.scene = text.scene;
  // Other scenes have no modes, and take --initial for their own flow.
  const bool own_flow = !is_euler_zeitlin(text.scene);
  if (own_flow && given(line, "--modes")) {
    throw BadArgument(fmt::format("--modes {}: goes with Euler-Zeitlin, not with --scene {}",
                                  text.modes, text.scene));
  }
  const bool scene_has_data = given(line, "--scene") && !own_flow;
  if (scene_has_data + given(line, "--modes") + given(line, "--initial") > 1) {
    throw BadArgument("--scene, --modes, --initial: each has initial data; must be one of them");
  }
  if (given(line, "--signature")) request.signature = signature_of(text.signature);
  if (given(line, "--modes")) {
    request.scene = "modes";
    request.modes_file = text.modes;
    return;
  }
  if (given(line, "--initial")) {
    if (!own_flow) request.scene = "initial";
    request.initial_file = text.initial;
    return;
  }
  if (request.scene == "smooth" && request.n < 5) {
    throw BadArgument(fmt::format(
        "--n {}: the default modes (l <= 4) need n >= 5; smaller n needs --modes or --initial",
        request.n));
  }
}

IntegrateRequest parse(const Text& text, const CLI::App& line) {
  IntegrateRequest request{};
  request.n = whole_number("--n", text.n, 2, 4096);
  choose_integrator(text, line, request);
  request.step = real_number("--step", text.step, "positive and finite", positive);
  request.time = real_number("--time", text.time, "0 or positive, and finite", 0.0);
  request.steps = step_count(request.time, request.step);
  request.solver.tolerance =
      real_number("--tolerance", text.tolerance, "at least 1e-15, and finite", 1e-15);
  request.solver.max_sweeps =
      static_cast<int>(whole_number("--max-sweeps", text.max_sweeps, 1, 1000000));
  if (given(line, "--hbar")) request.hbar = hbar_convention_from_name(text.hbar);
  request.products = backend_choice_from_name(text.products);
  choose_scene(text, line, request);
  if (given(line, "--hbar") && !request.is_euler_zeitlin()) {
    throw BadArgument(fmt::format("--hbar {}: goes with Euler-Zeitlin, not with --scene {}",
                                  text.hbar, text.scene));
  }
  if (given(line, "--output")) request.output_file = text.output;
  request.json = text.json;
  return request;
}

}  // namespace

std::variant<IntegrateRequest, int> read_integrate_arguments(int argc, char** argv) {
  CLI::App line{
      "Integrates a scene, Euler-Zeitlin by default, with one formulation of an isospectral "
      "symplectic Runge-Kutta (Gauss) method, or with any listed integrator."};
  Text text;
  line.add_option("--n", text.n, "matrix size, 2 to 4096")->required();
  line.add_option("--stages", text.stages, "stages of the Gauss tableau, 1 to 20");
  line.add_option("--formulation", text.formulation, "cotangent, group or algebra");
  line.add_option("--integrator", text.integrator,
                  "name of a listed integrator, in place of --formulation and --stages");
  line.add_option("--step", text.step, "step size h > 0")->required();
  line.add_option("--time", text.time, "end time T >= 0, a whole number of steps")->required();
  line.add_option("--tolerance", text.tolerance,
                  "of the fixed point, relative to W, >= 1e-15 (default 1e-13)");
  line.add_option("--max-sweeps", text.max_sweeps, "sweeps allowed in a step (default 1000)");
  line.add_option("--hbar", text.hbar, "paper: 2/sqrt(n(n-1)) (default); standard: 2/sqrt(n^2-1)");
  line.add_option("--products", text.products, "fastest (default), openblas or eigen");
  line.add_option("--solver", text.solver,
                  "published (default), or fast: the same answer to the tolerance, sooner");
  line.add_option("--threads", text.threads, "of --solver fast, 1 (default) to 64");
  line.add_option("--scene", text.scene,
                  fmt::format("one of {} (default smooth)", fmt::join(scene_names(), ", ")));
  line.add_option("--signature", text.signature, "P,Q with P + Q = n, of pseudo_unitary");
  line.add_option("--modes", text.modes, "initial modes, CSV with the header l,m,re,im");
  line.add_option("--initial", text.initial, "W at time 0, NumPy .npy as --output writes it");
  line.add_option("--output", text.output, "write W(T) as NumPy .npy, complex128");
  line.add_flag("--json", text.json, "print one JSON object")->disable_flag_override();
  if (const auto exit_code = read_arguments(line, argc, argv)) return *exit_code;
  return of_option([&] { return parse(text, line); });
}

}  // namespace isosyrk
