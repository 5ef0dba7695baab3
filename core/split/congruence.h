// The congruence Q† W Q of a skew-Hermitian W in split-complex storage.
#pragma once

#include "isosyrk/split/skew.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

/// out = Q† W Q, exactly skew-Hermitian, by one product and one triangle.  WQ becomes W Q.
template <class Real>
void congruence(SplitMatrixOf<Real>& out, SplitMatrixOf<Real>& WQ, SplitProductsOf<Real>& products,
                const SplitMatrixOf<Real>& Q, const SplitMatrixOf<Real>& W) {
  products.form(into(WQ, W * Q));
  products.form(into(out, adjoint(Q) * WQ).upper_triangle());
  mirror_skew(out);
}

}  // namespace isosyrk
