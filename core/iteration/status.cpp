#include "isosyrk/iteration/status.h"

namespace isosyrk {

std::string_view name(Status status) {
  switch (status) {
    case Status::converged:
      return "converged";
    case Status::diverged:
      return "diverged";
    case Status::stagnated:
      return "stagnated";
    case Status::sweep_cap:
      return "sweep cap";
  }
  return "unknown";
}

}  // namespace isosyrk
