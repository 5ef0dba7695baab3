// What a step leaves to the next one.
#pragma once

#include "isosyrk/linalg/state_archive.h"

namespace isosyrk {

/// All that a method remembers of the steps of a run, beside the state: one object for each run.
/// Nothing else outlives a step but workspace.  Each of its parts is passed down to what reads it.
///
/// A run has one.  A step beside a run has another one, which is forgotten before the step: it is
/// the first step of a run of its own.
class StepMemory {
 public:
  virtual ~StepMemory() = default;
  /// Forgets all steps: the next one is the first of a run.  Allocates nothing.
  virtual void forget() = 0;
  /// Passes what forget() forgets to an archive, or takes it from there (Integrator::archive).
  virtual void archive(StateArchive& state) = 0;
};

/// The memory of a method that remembers nothing.
class NoMemory final : public StepMemory {
 public:
  void forget() override {}
  void archive(StateArchive&) override {}
};

}  // namespace isosyrk
