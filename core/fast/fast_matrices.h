// What a fast form holds.
#pragma once

namespace isosyrk {

/// Numbers of n x n matrices of a fast form: unknowns, workspace in double and in single precision.
struct FastMatrices {
  double unknowns;
  double doubles;
  double singles;
};

}  // namespace isosyrk
