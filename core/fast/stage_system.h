// Stage system: the stage equations of one step of a fast form.
#pragma once

#include <memory>
#include <vector>

#include "isosyrk/fast/step_memory.h"
#include "isosyrk/iteration/attempt.h"
#include "isosyrk/iteration/work.h"
#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// The equations x = G(x) of one step W₀ -> W₁ of size h, for flows with J = I.  It says in which
/// order attempts to solve them are made, and does not know which of them is under way.
///
/// Order of calls in a step: bind; for each attempt start() or an x from the predictor, then those
/// of FixedPointSystem by the solver; update with the x that the solver accepted.
class StageSystem : public FixedPointSystem {
 public:
  /// Returns zero unknowns of the right shapes.
  virtual Unknowns unknowns() const = 0;

  /// Returns the attempts to solve a step, in order.  Each follows if those before it fail.
  /// `newton` is false where a study leaves out corrections.
  virtual std::vector<Attempt> attempts(bool newton) const;

  /// Returns an empty memory of what steps of this system leave to later ones, other than the
  /// unknowns.
  virtual std::unique_ptr<StepMemory> memory() const { return std::make_unique<NoMemory>(); }

  /// Begins a step from W₀ of size h, to be solved to the tolerance.  W₀ must stay unchanged until
  /// update().  The memory, one of memory(), is that of the steps before; this one joins them.
  virtual void bind(const SplitMatrix& W0, double h, double tolerance, StepMemory& memory) = 0;

  /// Sets x to the start values of an attempt that does not start from past steps.  Cold: Q = I,
  /// P = W₀, X = M = 0, W̃ = W₀.
  virtual void start(Unknowns& x, Start how) = 0;

  /// Computes W₁ from the accepted x.  May use what the last residual() has stored.
  virtual void update(SplitMatrix& W1, const Unknowns& x) = 0;

  /// True if products skip entries outside bands.
  virtual bool truncates() const = 0;
  /// Switches band truncation on or off.
  virtual void truncate(bool enabled) = 0;

  /// Returns the work since construction.
  virtual Work work() const = 0;
  /// Passes what work() counts to an archive, or goes on from what is read.
  virtual void archive_work(StateArchive& run) = 0;
};

}  // namespace isosyrk
