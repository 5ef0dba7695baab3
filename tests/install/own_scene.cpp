// Runs the scene that core/README.md shows, by its name in the list.
#include <isosyrk/catalogue/make_integrator.h>
#include <isosyrk/linalg/spectrum.h>
#include <isosyrk/scenes/scene_list.h>
#include <isosyrk/simulation/conservation.h>
#include <isosyrk/simulation/run.h>

#include <cmath>
#include <cstdio>

int main() {
  const isosyrk::Scene scene = isosyrk::scene_by_name("bloch_iserles", 6);
  isosyrk::Matrix answers[3];
  double energy_error = 0.0;
  int which = 0;
  for (const char* name : {"cotangent2", "group2", "algebra2"}) {
    isosyrk::Matrix& W = answers[which++] = scene.initial;
    const auto integrator = isosyrk::make_integrator(scene.flow, name);
    if (!isosyrk::run(*integrator, W, 0.1, 50).converged()) return 1;
    energy_error = std::abs(scene.flow->energy(W) / scene.flow->energy(scene.initial) - 1.0);
  }
  // Order 4 at h = 0.1; 50 steps of tolerance 1e-13, and a margin of 10.
  const bool moved = (answers[0] - scene.initial).norm() > 1e-2;
  const bool kept =
      energy_error < 1e-5 && isosyrk::spectrum_error(answers[1], scene.initial) < 5e-11;
  const bool one_map = (answers[0] - answers[1]).norm() + (answers[1] - answers[2]).norm() < 5e-11;
  std::printf("%s\n", moved && kept && one_map ? "coincide" : "differ");
  return 0;
}
