// Scenes: a flow with initial data, a name and a time span.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/scenes/modes.h"

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
/// As above for the algebra of a flow: |W₀†J + JW₀| in place of |W₀ + W₀†|, and real or block
/// diagonal where the flow is.  The message begins with `what`.
void require_initial_data(const Flow& flow, const Matrix& W0,
                          std::string_view what = "initial data");
/// Returns the Euler-Zeitlin scene with the initial data W₀ as they are, T = 5.  Throws
/// std::invalid_argument for n < 2 and as require_initial_data.
Scene euler_zeitlin_scene(std::string_view name, HbarConvention convention, const Matrix& W0);

/// Returns the scene of the paper's Table 1: Euler-Zeitlin from a few smooth modes, T = 5.  Throws
/// std::invalid_argument for n < 2 and as require_valid(modes, n); the default modes need n >= 5.
Scene smooth_scene(Index n, HbarConvention convention = HbarConvention::paper,
                   const std::vector<Mode>& modes = default_modes());

/// Returns Euler-Zeitlin from rough_modes(n), T = 5.  Throws std::invalid_argument for n < 2.
Scene rough_scene(Index n, HbarConvention convention = HbarConvention::paper);

/// Returns the initial modes of the scene "smooth" or "rough".  Throws std::invalid_argument for
/// another name, and as rough_modes(n).
std::vector<Mode> initial_modes(std::string_view scene, Index n);

/// What a scene of the list is made of, beside its name.
struct SceneParameters {
  Index n;                                                ///< size of its matrices
  std::optional<HbarConvention> hbar = {};                ///< Euler-Zeitlin only; "paper" if none
  std::optional<std::pair<Index, Index>> signature = {};  ///< pseudo_unitary only: p, q
};

/// Returns the names of all scenes; those of Euler-Zeitlin come first.
const std::vector<std::string>& scene_names();
/// Tells whether this is a scene of Euler-Zeitlin: "smooth" or "rough".
bool is_euler_zeitlin(std::string_view scene);
/// Returns the scene with this name.  Throws std::invalid_argument, naming all scenes, for another
/// name, and for parameters that the scene does not have or that are out of its range.
Scene scene_by_name(std::string_view name, const SceneParameters& parameters);
/// Returns a scene that has no parameters but n.
inline Scene scene_by_name(std::string_view name, Index n) {
  return scene_by_name(name, SceneParameters{.n = n});
}

}  // namespace isosyrk
