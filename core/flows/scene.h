// Scenes: a flow with initial data, a name and a time span.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/flows/modes.h"

namespace isosyrk {

/// A simulation, as data.
struct Scene {
  std::string name;
  std::shared_ptr<const Flow> flow;
  Matrix initial;  ///< W at time 0, n x n; of spectral norm 1 where it is made of modes
  double time;     ///< end of the time span
};

/// Returns the Euler-Zeitlin scene with the given initial modes, T = 5.  Throws
/// std::invalid_argument for n < 2 and as require_valid(modes, n).
Scene euler_zeitlin_scene(std::string_view name, Index n, HbarConvention convention,
                          const std::vector<Mode>& modes);

/// Throws std::invalid_argument unless W₀ is n x n, finite, nonzero and skew-Hermitian: the largest
/// entry of |W₀ + W₀†| at most 1e-10 of the largest of |W₀|, so that the end of a run may be the
/// start of the next.  The message has the figure found.  n >= 1.
void require_initial_data(const Matrix& W0, Index n);
/// Returns the Euler-Zeitlin scene with the initial data W₀ as they are, T = 5.  Throws
/// std::invalid_argument for n < 2 and as require_initial_data.
Scene euler_zeitlin_scene(std::string_view name, HbarConvention convention, const Matrix& W0);

/// Returns the scene of the paper's Table 1: Euler-Zeitlin from a few smooth modes, T = 5.  Throws
/// std::invalid_argument for n < 2 and as require_valid(modes, n); the default modes need n >= 5.
Scene smooth_scene(Index n, HbarConvention convention = HbarConvention::paper,
                   const std::vector<Mode>& modes = default_modes());

/// Returns Euler-Zeitlin from rough_modes(n), T = 5.  Throws std::invalid_argument for n < 2.
Scene rough_scene(Index n, HbarConvention convention = HbarConvention::paper);

/// Returns "smooth" and "rough".
const std::vector<std::string>& scene_names();
/// Returns the initial modes of the scene with this name.  Throws std::invalid_argument, naming all
/// scenes, for another name, and as rough_modes(n).
std::vector<Mode> initial_modes(std::string_view scene, Index n);
/// Returns the scene with this name.  Throws as initial_modes and euler_zeitlin_scene.
Scene scene_by_name(std::string_view name, Index n,
                    HbarConvention convention = HbarConvention::paper);

}  // namespace isosyrk
