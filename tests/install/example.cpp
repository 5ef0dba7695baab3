#include <isosyrk/catalogue/make_integrator.h>
#include <isosyrk/linalg/spectrum.h>
#include <isosyrk/scenes/euler_zeitlin_scenes.h>
#include <isosyrk/simulation/run.h>
#include <cstdio>

int main() {
  const isosyrk::Scene scene = isosyrk::smooth_scene(33);
  const auto integrator =
      isosyrk::make_integrator(scene.flow, "group2", {.solver = isosyrk::Solver::fast});
  isosyrk::Matrix W = scene.initial;
  const isosyrk::RunReport report = isosyrk::run(*integrator, W, 0.1, 50);
  if (!report.converged()) return 1;
  std::printf("%ld sweeps, spectrum error %.1e\n", report.sweeps,
              isosyrk::spectrum_error(W, scene.initial));
}
