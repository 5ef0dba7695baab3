#include "isosyrk/tableaux/composition_schemes.h"

#include <cmath>

namespace isosyrk {

CompositionScheme yoshida4() {
  const double outer = 1.0 / (2.0 - std::cbrt(2.0));
  return {"yoshida4", 4, {outer, 1.0 - 2.0 * outer, outer}};
}

CompositionScheme suzuki4() {
  const double outer = 1.0 / (4.0 - std::cbrt(4.0));
  return {"suzuki4", 4, {outer, outer, 1.0 - 4.0 * outer, outer, outer}};
}

CompositionScheme kahan_li6() {
  const double a = 0.39216144400731413928;
  const double b = 0.33259913678935943860;
  const double c = -0.70624617255763935981;
  const double d = 0.082213596293550800230;
  const double e = 0.79854399093482996340;
  return {"kahan_li6", 6, {a, b, c, d, e, d, c, b, a}};
}

}  // namespace isosyrk
