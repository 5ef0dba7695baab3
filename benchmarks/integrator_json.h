// What raw files say of an integrator.
#pragma once

#include <nlohmann/json.hpp>

#include "core/integrator_list.h"

namespace isosyrk {

nlohmann::ordered_json integrator_json(const IntegratorEntry& entry);

}  // namespace isosyrk
