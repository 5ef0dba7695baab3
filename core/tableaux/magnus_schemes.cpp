#include "isosyrk/tableaux/magnus_schemes.h"

namespace isosyrk {

const MagnusScheme& magnus4() {
  enum : std::size_t { m0, m1, C1 };
  static const MagnusScheme scheme{
      .name = "magnus4",
      .order = 4,
      .order_of_sum = 4,
      .nodes = (RealVector(2) << 0.0, 1.0).finished(),
      .moments = {{1, {{0, 1, 2}, {1, 1, 2}}, {{0, 1, 12}, {1, -1, 12}}},
                  {1, {{1, 1, 10}, {0, -1, 10}}, {{0, -1, 120}, {1, -1, 120}}}},
      .sums = {},
      .brackets = {{{{m0, 1}}, {{m1, 1}}}},
      .Omega = {{m0, 1}, {C1, -1}}};
  return scheme;
}

const MagnusScheme& magnus5() {
  enum : std::size_t { m0, m1, m2, alpha2, alpha3, alpha1, C1, C2, C3 };
  static const MagnusScheme scheme{
      .name = "magnus5",
      .order = 5,
      .order_of_sum = 6,
      .nodes = (RealVector(3) << 0.0, 0.5, 1.0).finished(),
      .moments = {{60, {{0, 14}, {1, 32}, {2, 14}}, {{0, 1}, {2, -1}}},
                  {840, {{2, 60}, {0, -60}}, {{0, -3}, {1, 16}, {2, -3}}},
                  {1680, {{0, 54}, {1, 32}, {2, 54}}, {{0, 3}, {2, -3}}}},
      .sums = {{{m1, 12}}, {{m2, 180}, {m0, -15}}, {{m0, 1}, {alpha3, -1, 12}}},
      .brackets = {{{{alpha1, 1}}, {{alpha2, 1}}},
                   {{{alpha1, 1}}, {{alpha3, 2}, {C1, 1}}, -1.0 / 60.0},
                   {{{C1, 1}, {alpha1, -20}, {alpha3, -1}}, {{alpha2, 1}, {C2, 1}}, 1.0 / 240.0}},
      .Omega = {{alpha1, 1}, {alpha3, 1, 12}, {C3, 1}}};
  return scheme;
}

}  // namespace isosyrk
