// The compiled half of the NumPy module: scenes, integrators and measures on arrays.  isosyrk/
// checks the arguments and holds what a user sees.
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <set>

#include "blas_threads.h"
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/catalogue/integrator_list.h"
#include "isosyrk/catalogue/measured_limits.h"
#include "isosyrk/flows/harmonic.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/flows/laplacian.h"
#include "isosyrk/flows/spherical_harmonics.h"
#include "isosyrk/machine/memory.h"
#include "isosyrk/scenes/euler_zeitlin_scenes.h"
#include "isosyrk/scenes/scene_list.h"
#include "isosyrk/simulation/conservation.h"
#include "python_flow.h"
#include "signals.h"
#include "stepper.h"

namespace isosyrk::python {
namespace {

namespace py = pybind11;

/// Lets other threads run Python meanwhile.
using Aside = py::call_guard<py::gil_scoped_release, OneBlasThread>;

using ModeTuple = std::tuple<int, int, double, double>;

std::vector<Mode> modes_of(const std::vector<ModeTuple>& tuples) {
  std::vector<Mode> modes;
  for (const auto& [l, m, re, im] : tuples) modes.push_back({l, m, {re, im}});
  return modes;
}

Scene scene_of_generator(const std::string& name, const Array& initial, py::handle generator) {
  Matrix W0 = matrix_of(initial);
  auto flow = std::make_shared<PythonFlow>(W0.rows(), W0.stableNorm(), generator);
  return {name, std::move(flow), std::move(W0), 5.0};
}

double energy_of(const Scene& scene, const Matrix& W) {
  const Energy energy = scene.flow->energy(W);
  if (!energy.is_double()) {
    throw py::value_error(fmt::format(
        "energy: is about 1e{:.0f} for this W of norm {:.3g}, which no double holds; that "
        "of c W is c^2 times as large",
        energy.log10(), W.stableNorm()));
  }
  return energy.value();
}

struct Switch {
  const char* name;
  void (*turn_off)(FastOptions& options);
};
constexpr Switch switches[] = {
    {"predictor", [](FastOptions& options) { options.past_steps = 0; }},
    {"newton", [](FastOptions& options) { options.newton = false; }},
    {"bands", [](FastOptions& options) { options.bands = false; }},
    {"explicit_start", [](FastOptions& options) { options.explicit_start = false; }},
    {"graded_series", [](FastOptions& options) { options.graded_series = false; }},
    {"error_estimates", [](FastOptions& options) { options.error_estimates = false; }}};

std::vector<std::string> switch_names() {
  std::vector<std::string> names;
  for (const Switch& each : switches) names.emplace_back(each.name);
  return names;
}

FastOptions switches_without(const std::set<std::string>& without) {
  FastOptions options;
  for (const Switch& each : switches) {
    if (without.count(each.name) > 0) each.turn_off(options);
  }
  return options;
}

std::unique_ptr<Stepper> make_stepper(const Scene& scene, const std::string& name,
                                      const std::string& solver, double tolerance, int max_sweeps,
                                      int threads, const std::set<std::string>& without,
                                      const std::string& products) {
  FastOptions options = switches_without(without);
  options.threads = threads;
  const Index n = scene.initial.rows();
  const IntegratorEntry entry =
      integrator_entry(name, solver_from_name(solver), with_defaults(options, n));
  require_memory(fmt::format("n = {} with {}", n, name), entry, n);
  const OneBlasThread one_blas_thread;
  const ProductBackend backend =
      products == "eigen" ? ProductBackend::eigen : ProductBackend::openblas;
  const IterationOptions iteration = {tolerance, max_sweeps, &handle_signals};
  return std::make_unique<Stepper>(entry.make(scene.flow, iteration, backend));
}

template <auto property>
bool keeps(const IntegratorEntry& entry) {
  return entry.keeps.*property;
}

template <auto field>
auto of_run(const Stepper::Outcome& outcome) {
  return outcome.run.*field;
}
// The same of its work.
template <auto field>
auto of_work(const Stepper::Outcome& outcome) {
  return outcome.run.work.*field;
}

void bind_scenes(py::module_& module) {
  py::class_<Scene>(module, "Scene")
      .def_readonly("name", &Scene::name)
      .def_readonly("time", &Scene::time)
      .def_property_readonly("n", [](const Scene& scene) { return scene.initial.rows(); })
      .def_property_readonly("initial",
                             [](const py::object& self) {
                               const Matrix& W = self.cast<const Scene&>().initial;
                               Array view({W.rows(), W.cols()}, W.data(), self);
                               view.attr("flags").attr("writeable") = false;
                               return view;
                             })
      .def("energy",
           [](const Scene& scene, const Array& W) { return energy_of(scene, matrix_of(W)); })
      .def("generator",
           [](const Scene& scene, const Array& W) {
             return copy_of(scene.flow->dense_generator(matrix_of(W)));
           })
      .def("require_initial_data",
           [](const Scene& scene, const Array& W) {
             require_initial_data(*scene.flow, matrix_of(W));
           })
      .def("starting_at",
           [](const Scene& scene, const Array& W) {
             require_initial_data(*scene.flow, matrix_of(W));
             return Scene{scene.name, scene.flow, matrix_of(W), scene.time};
           })
      .def(
          "generator_norms",
          [](const Scene& scene, bool co_rotating) {
            const GeneratorNorms norms = generator_norms(generator_frequencies(scene, co_rotating));
            return std::pair(norms.B, norms.ad_B);
          },
          Aside());
  module.def(
      "scene_by_name",
      [](const std::string& name, Index n, const std::optional<std::string>& hbar,
         const std::optional<std::pair<Index, Index>>& signature) {
        SceneParameters parameters{.n = n, .signature = signature};
        if (hbar) parameters.hbar = hbar_convention_from_name(*hbar);
        return scene_by_name(name, parameters);
      },
      Aside());
  module.def("scene_names", &scene_names);
  module.def("is_euler_zeitlin", &is_euler_zeitlin);
  module.def(
      "scene_of_modes",
      [](const std::string& name, const std::vector<ModeTuple>& modes, Index n,
         const std::string& hbar) {
        return euler_zeitlin_scene(name, n, hbar_convention_from_name(hbar), modes_of(modes));
      },
      Aside());
  module.def(
      "scene_of_initial",
      [](const std::string& name, const Array& W0, const std::string& hbar) {
        return euler_zeitlin_scene(name, hbar_convention_from_name(hbar), matrix_of(W0));
      },
      Aside());
  module.def("scene_of_generator", &scene_of_generator);
  module.def("require_initial_data",
             [](const Array& W) { require_initial_data(matrix_of(W), W.shape(0)); });
  module.def("hash_of_modes",
             [](const std::vector<ModeTuple>& modes) { return hash_of(modes_of(modes)); });
  module.def("hash_of_scene",
             [](const std::string& name, Index n) { return hash_of(initial_modes(name, n)); });
}

void bind_integrators(py::module_& module) {
  py::class_<IntegratorEntry>(module, "Entry")
      .def_readonly("name", &IntegratorEntry::name)
      .def_readonly("stages", &IntegratorEntry::stages)
      .def_readonly("order", &IntegratorEntry::order)
      .def_property_readonly("method", &IntegratorEntry::method)
      .def_property_readonly("family", [](const IntegratorEntry& e) { return name(e.family); })
      .def_property_readonly("formulation",
                             [](const IntegratorEntry& e) -> std::optional<std::string_view> {
                               if (!e.formulation) return {};
                               return name(*e.formulation);
                             })
      .def_readonly("co_rotating", &IntegratorEntry::co_rotating)
      .def_readonly("projected", &IntegratorEntry::projected)
      .def_readonly("stability_limit", &IntegratorEntry::stability_limit)
      .def_property_readonly("has_fast_form", &IntegratorEntry::has_fast_form)
      .def_property_readonly("isospectral", &keeps<&Properties::isospectral>)
      .def_property_readonly("lie_poisson", &keeps<&Properties::lie_poisson>)
      .def_property_readonly("symmetric", &keeps<&Properties::symmetric>)
      .def_property_readonly("spectrum_at_any_tolerance",
                             &keeps<&Properties::spectrum_at_any_tolerance>)
      .def_readonly("explicit", &IntegratorEntry::is_explicit)
      .def(
          "linear_limit",
          [](const IntegratorEntry& e, const Scene& scene) -> std::optional<double> {
            if (!e.linear_limit) return {};
            return e.linear_limit(generator_frequencies(scene, e.co_rotating)) *
                   generator_norms(scene).B;
          },
          Aside());
  module.def("integrators", &integrators);
  module.def("measured_limit", [](const std::string& name, const std::string& solver, Index n) {
    return measured_limit(integrator_entry(name).name, solver_from_name(solver), n);
  });
  module.def("integrator_entry",
             [](const std::string& name) -> IntegratorEntry { return integrator_entry(name); });

  module.def("switch_names", &switch_names);

  py::class_<Stepper::Outcome>(module, "Outcome")
      .def(py::init<>())
      .def_property_readonly("status", [](const Stepper::Outcome& o) { return name(o.run.status); })
      .def_property_readonly("failed_step", &of_run<&RunReport::failed_step>)
      .def_property_readonly("steps", &of_run<&RunReport::steps>)
      .def_property_readonly("sweeps", &of_run<&RunReport::sweeps>)
      .def_property_readonly("products", &of_work<&Work::products>)
      .def_property_readonly("equivalent_products", &of_work<&Work::equivalent_products>)
      .def_property_readonly("poisson_solves", &of_work<&Work::poisson_solves>)
      .def_property_readonly("projections", &of_work<&Work::projections>)
      .def_property_readonly("contraction", &of_run<&RunReport::contraction>)
      .def_property_readonly("last_change", &of_run<&RunReport::last_change>)
      .def_readonly("seconds", &Stepper::Outcome::seconds)
      .def_readonly("begun", &Stepper::Outcome::begun);
  py::class_<Stepper::Calls>(module, "Calls")
      .def(py::init<py::object, py::object, long, py::object>());
  py::class_<Stepper>(module, "Stepper")
      .def(py::init(&make_stepper), py::arg("scene"), py::arg("name"), py::kw_only(),
           py::arg("solver"), py::arg("tolerance"), py::arg("max_sweeps"), py::arg("threads"),
           py::arg("without"), py::arg("products"))
      .def("run", &Stepper::run)
      .def("timed_run", &Stepper::timed_run);
}

void bind_measures(py::module_& module) {
  module.def(
      "spectrum", [](const Array& W) { return spectrum(matrix_of(W)); }, Aside());
  module.def(
      "spectrum_error",
      [](const Array& W, const Array& W0) { return spectrum_error(matrix_of(W), matrix_of(W0)); },
      Aside());
  module.def("skew_defect", [](const Array& W) { return skew_defect(matrix_of(W)); });
  module.def(
      "casimir_errors",
      [](const Array& W, const Array& W0) { return casimir_errors(matrix_of(W), matrix_of(W0)); },
      Aside());
  module.def("angular_momentum_error", [](const Array& W, const Array& W0) {
    return angular_momentum_error(matrix_of(W), matrix_of(W0));
  });
}

void bind_fields(py::module_& module) {
  module.def(
      "harmonic_coefficients", [](const Array& W) { return harmonic_coefficients(matrix_of(W)); },
      Aside());
  module.def("along_latitudes", &along_latitudes, Aside());
  module.def(
      "laplace",
      [](const Array& P) {
        Matrix W(P.shape(0), P.shape(0));
        Laplacian(P.shape(0)).apply(matrix_of(P), W);
        return W;
      },
      Aside());
  module.def(
      "solve_poisson",
      [](const Array& W) {
        Matrix P(W.shape(0), W.shape(0));
        Laplacian(W.shape(0)).solve_skew_hermitian(matrix_of(W), 1.0, P);
        return P;
      },
      Aside());
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.attr("version") = ISOSYRK_VERSION;
  module.def("end_runs", &end_runs);
  bind_scenes(module);
  bind_integrators(module);
  bind_measures(module);
  bind_fields(module);
}

}  // namespace isosyrk::python
