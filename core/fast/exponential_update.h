// The update of the exponential Lie-Poisson methods in split-complex storage.
#pragma once

#include "isosyrk/fast/exponential_step.h"
#include "isosyrk/fast/split_exponential.h"
#include "isosyrk/fast/split_operations.h"

namespace isosyrk {

/// W₁ = U W₀ U†, U = e^Ω, the last of formula (2) of integrators/EXPONENTIAL.md.  Ω may err, and U
/// by a tenth of the tolerance: it is unitary to rounding (SplitExponential), and so is the
/// spectrum kept.  Work: that of SplitExponential.
class ExponentialUpdate {
 public:
  /// Operations and step must outlive it.  Only the constructor allocates.
  ExponentialUpdate(SplitOperations& operations, const ExponentialStep& step)
      : operations_(operations),
        step_(step),
        exponential_(operations.size(), operations.bands),
        Omega_(operations.size()) {}

  /// Sets W1.  It is not finite where ‖Ω‖ is beyond SplitExponential.
  void form(SplitMatrix& W1, const SplitMatrix& Omega);

  /// out = U X U†, with the U of the step before.  Products: 1.5, in single precision.
  void transport(SingleMatrix& out, const SingleMatrix& X);

 private:
  SplitOperations& operations_;
  const ExponentialStep& step_;
  SplitExponential exponential_;
  SplitMatrix Omega_;  // Ω, cut to its band
};

}  // namespace isosyrk
