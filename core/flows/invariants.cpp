#include "isosyrk/flows/invariants.h"

#include "isosyrk/flows/spin.h"

namespace isosyrk {

std::array<double, 3> angular_momentum(const Matrix& W) {
  const Spin spin(W.rows());
  Complex raised = 0.0;  // tr((S_x + i S_y) W) = Σ ladder_i W_{i+1,i}
  Complex lowered = 0.0;
  Complex z = 0.0;
  for (Index i = 0; i < W.rows(); ++i) {
    z += spin.magnetic(i) * W(i, i);
    if (i + 1 < W.rows()) {
      raised += spin.ladder(i) * W(i + 1, i);
      lowered += spin.ladder(i) * W(i, i + 1);
    }
  }
  const Complex x = 0.5 * (raised + lowered);
  const Complex y = Complex(0.0, -0.5) * (raised - lowered);
  return {x.imag(), y.imag(), z.imag()};
}

}  // namespace isosyrk
