#include "core/scene.h"

namespace isosyrk {

Scene smooth_scene(Index n, HbarConvention convention, const std::vector<Mode>& modes) {
  return {"smooth", std::make_shared<EulerZeitlin>(n, convention), vorticity_from_modes(modes, n),
          5.0};
}

}  // namespace isosyrk
