// Matrices of the user's go through every kind of integrator and back, and are freed by whoever
// holds them: the library was compiled for another vector unit than this program.
#include <isosyrk/catalogue/integrator_list.h>
#include <isosyrk/catalogue/make_integrator.h>
#include <isosyrk/scenes/euler_zeitlin_scenes.h>
#include <isosyrk/simulation/run.h>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

using isosyrk::Matrix;

namespace {

bool advances_any_memory(const std::string& name, isosyrk::Solver solver) {
  for (const isosyrk::Index n : {5, 8, 17}) {
    isosyrk::Scene scene = isosyrk::smooth_scene(n);
    const auto integrator = isosyrk::make_integrator(scene.flow, name, {.solver = solver});

    Matrix W = scene.initial;
    if (!isosyrk::run(*integrator, W, 0.05, 3).converged()) return false;

    std::vector<isosyrk::Complex> numbers(static_cast<std::size_t>(n * n) + 1);
    Eigen::Map<Matrix> mapped(numbers.data() + 1, n, n);
    mapped = scene.initial;
    const auto another = isosyrk::make_integrator(scene.flow, name, {.solver = solver});
    if (!isosyrk::run(*another, mapped, 0.05, 3).converged()) return false;
    if (mapped != W) return false;

    // What the library allocated is resized and freed here, and the other way round.
    Matrix own = Matrix::Zero(2, 2);
    std::swap(scene.initial, own);
    own.resize(n + 3, n + 3);
    scene.initial.resize(n, n);
    scene.initial = W;
    scene.flow->generator(W, scene.initial);
    Matrix moved = std::move(scene.initial);
    moved.conservativeResize(n + 1, n + 1);
  }
  return true;
}

}  // namespace

int main() {
  for (const isosyrk::IntegratorEntry& entry : isosyrk::integrators()) {
    for (const isosyrk::Solver solver : {isosyrk::Solver::published, isosyrk::Solver::fast}) {
      if (solver == isosyrk::Solver::fast && !entry.has_fast_form()) continue;
      if (!advances_any_memory(entry.name, solver)) {
        std::printf("%s failed\n", entry.name.c_str());
        return 1;
      }
    }
  }
  std::printf("sound\n");
}
