// ISOSYRK once more, as the equations read and with no thought of speed: a second implementation to
// compare core/algebra_form with, and the place to try the paper's misprint.
#pragma once

#include "isosyrk/flows/flow.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk::testing {

/// Which B stands in front of K_ij.
enum class KIndex {
  corrected,  ///< h B(W̃_j) ( ... )
  printed,    ///< h B(W̃_i) ( ... ), as the paper has it
};

/// So many steps, each iterated to tolerance 1e-14 or 200 sweeps.
Matrix plain_isosyrk(const Flow& flow, const Tableau& tableau, KIndex index, const Matrix& W0,
                     double h, long steps);

}  // namespace isosyrk::testing
