// Reference solutions: W(T) of a scene to near rounding, recorded in results/recorded/references.
#pragma once

#include <string>

#include "isosyrk/scenes/modes.h"
#include "isosyrk/scenes/scene.h"

namespace isosyrk {

/// W(T) from two integrators of different kinds.
struct Reference {
  Matrix W;                  ///< from the first
  double uncertainty = 0.0;  ///< ‖W - W of the second‖_F / ‖W‖_F
};

/// ‖W - reference‖_F / ‖reference‖_F
double relative_error(const Matrix& W, const Matrix& reference);

/// Reads the reference of this scene, of its size, from a folder with references.json and the .npy
/// files that it lists.  Throws BadArgument, naming `option` and the file, for what is missing,
/// broken or of another scene.
Reference read_reference(const std::string& option, const std::string& folder, const Scene& scene,
                         HbarConvention hbar, const std::vector<Mode>& modes);

}  // namespace isosyrk
