#include "isosyrk/fast/start_choice.h"

#include "isosyrk/solver/tuning.h"

namespace isosyrk {

void StartChoice::record_past(double error) {
  prefers_past_ = error <= tuning.predicted_error * of_explicit_;  // false for NaN
  steps_since_trial_ = 0;
}

}  // namespace isosyrk
