// Scenes: a flow with initial data, a name and a time span.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/flows/flow.h"

namespace isosyrk {

/// A simulation, as data.
struct Scene {
  std::string name;
  std::shared_ptr<const Flow> flow;
  Matrix initial;  ///< W at time 0, n x n; of spectral norm 1 where it is made of modes
  double time;     ///< end of the time span, in the time t of W' = [B(W), W], in which steps are h
};

/// What a scene of the list is made of, beside its name.
struct SceneParameters {
  Index n;                                                ///< size of its matrices
  std::optional<HbarConvention> hbar = {};                ///< Euler-Zeitlin only; "paper" if none
  std::optional<std::pair<Index, Index>> signature = {};  ///< pseudo_unitary only: p, q
};

/// Throws std::invalid_argument unless W₀ is n x n, finite, nonzero and skew-Hermitian: the largest
/// entry of |W₀ + W₀†| at most 1e-10 of the largest of |W₀|, so that the end of a run may be the
/// start of the next.  The message has the figure found.  n >= 1.
void require_initial_data(const Matrix& W0, Index n);
/// As above for the algebra of a flow: |W₀†J + JW₀| in place of |W₀ + W₀†|, and real or block
/// diagonal where the flow is.  The message begins with `what`.
void require_initial_data(const Flow& flow, const Matrix& W0,
                          std::string_view what = "initial data");

}  // namespace isosyrk
