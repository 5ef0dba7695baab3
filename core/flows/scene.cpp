#include "isosyrk/flows/scene.h"

#include <fmt/ranges.h>

#include <cmath>
#include <stdexcept>

namespace isosyrk {

Scene euler_zeitlin_scene(std::string_view name, Index n, HbarConvention convention,
                          const std::vector<Mode>& modes) {
  return {std::string(name), std::make_shared<EulerZeitlin>(n, convention),
          vorticity_from_modes(modes, n), 5.0};
}

void require_initial_data(const Matrix& W0, Index n) {
  constexpr double largest_defect = 1e-10;
  const auto refuse = [](const std::string& why) {
    throw std::invalid_argument("initial data: " + why);
  };
  if (W0.rows() != n || W0.cols() != n) {
    refuse(fmt::format("{} x {}; must be {} x {}", W0.rows(), W0.cols(), n, n));
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const Complex entry = W0(i, j);
      if (std::isfinite(entry.real()) && std::isfinite(entry.imag())) continue;
      refuse(fmt::format("entry ({}, {}) is {}{:+}i; must be finite", i, j, entry.real(),
                         entry.imag()));
    }
  }
  const double largest = W0.cwiseAbs().maxCoeff();
  if (largest == 0.0) refuse("all entries are 0; some must be nonzero");
  const double defect = (W0 + W0.adjoint()).cwiseAbs().maxCoeff() / largest;
  if (!(defect <= largest_defect)) {
    refuse(
        fmt::format("the largest entry of |W + W†| is {:.3g} of the largest of |W|; must be at "
                    "most {:.0e} (skew-Hermitian)",
                    defect, largest_defect));
  }
}

Scene euler_zeitlin_scene(std::string_view name, HbarConvention convention, const Matrix& W0) {
  const Index n = W0.rows();
  auto flow = std::make_shared<EulerZeitlin>(n, convention);
  require_initial_data(W0, n);
  return {std::string(name), std::move(flow), W0, 5.0};
}

Scene smooth_scene(Index n, HbarConvention convention, const std::vector<Mode>& modes) {
  return euler_zeitlin_scene("smooth", n, convention, modes);
}

Scene rough_scene(Index n, HbarConvention convention) {
  return euler_zeitlin_scene("rough", n, convention, rough_modes(n));
}

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> names = {"smooth", "rough"};
  return names;
}

std::vector<Mode> initial_modes(std::string_view scene, Index n) {
  if (scene == "smooth") return default_modes();
  if (scene == "rough") return rough_modes(n);
  throw std::invalid_argument(
      fmt::format("scene '{}': must be one of {}", scene, fmt::join(scene_names(), ", ")));
}

Scene scene_by_name(std::string_view name, Index n, HbarConvention convention) {
  return euler_zeitlin_scene(name, n, convention, initial_modes(name, n));
}

}  // namespace isosyrk
