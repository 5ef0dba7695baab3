#include "isosyrk/flows/spin_chain.h"

namespace isosyrk {

void SpinChain::generator(const Matrix& W, Matrix& B) const {
  const Index n = size();
  B.middleRows(2, n - 4) = W.topRows(n - 4) + W.bottomRows(n - 4);
  B.topRows(2) = W.bottomRows(2) + W.middleRows(2, 2);
  B.bottomRows(2) = W.middleRows(n - 4, 2) + W.topRows(2);
}

double SpinChain::hamiltonian(const Matrix& W) const {
  const Index n = size();
  const auto coupling = [](const auto& a, const auto& b) {
    return a.conjugate().cwiseProduct(b).sum().real();
  };
  return -coupling(W.topRows(n - 2), W.bottomRows(n - 2)) - coupling(W.bottomRows(2), W.topRows(2));
}

}  // namespace isosyrk
