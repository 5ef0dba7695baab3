#include "tests/plain_isosyrk.h"

#include <vector>

#include "tests/support.h"

namespace isosyrk::testing {

Matrix plain_isosyrk(const Flow& flow, const Tableau& tableau, KIndex index, const Matrix& W0,
                     double h, long steps) {
  if (steps == 0) return W0;
  const Index n = flow.size();
  const auto s = static_cast<std::size_t>(tableau.stages());
  const auto a = [&tableau](std::size_t i, std::size_t j) {
    return tableau.a(static_cast<Index>(i), static_cast<Index>(j));
  };
  const auto B = [&flow, n](const Matrix& W) {
    Matrix generator(n, n);
    flow.generator(W, generator);
    return generator;
  };
  std::vector<Matrix> X(s, Matrix::Zero(n, n));
  std::vector<std::vector<Matrix>> K(s, X);
  std::vector<Matrix> W(s, W0);
  Matrix adjoint(n, n);
  for (int sweep = 0; sweep < 200; ++sweep) {
    const auto X_old = X;
    const auto K_old = K;
    const auto W_old = W;
    for (std::size_t i = 0; i < s; ++i) {
      Matrix sum_X = Matrix::Zero(n, n);
      for (std::size_t j = 0; j < s; ++j) sum_X += a(i, j) * X_old[j];
      X[i] = -h * product({W0 + sum_X, B(W_old[i])});
      for (std::size_t j = 0; j < s; ++j) {
        Matrix sum_K = sum_X;
        for (std::size_t k = 0; k < s; ++k) sum_K += a(j, k) * K_old[i][k];
        K[i][j] = h * product({B(W_old[index == KIndex::corrected ? j : i]), sum_K});
      }
    }
    double change = 0.0;
    for (std::size_t i = 0; i < s; ++i) {
      W[i] = W0;
      for (std::size_t j = 0; j < s; ++j) {
        flow.algebra().involution(X[j], adjoint);
        W[i] += a(i, j) * (X[j] - adjoint + K[i][j]);
      }
      change = std::max(change, (W[i] - W_old[i]).norm());
    }
    if (change < 1e-14) break;
  }
  Matrix W1 = W0;
  for (std::size_t i = 0; i < s; ++i) {
    const Matrix C = product({B(W[i]), W[i]});
    flow.algebra().involution(C, adjoint);
    W1 += h * tableau.b(static_cast<Index>(i)) * (C - adjoint);
  }
  return plain_isosyrk(flow, tableau, index, W1, h, steps - 1);
}

}  // namespace isosyrk::testing
