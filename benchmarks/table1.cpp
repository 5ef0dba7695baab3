// Table 1 of the paper: CPU time of 50 steps of each formulation as published, over n and s.
#include "benchmarks/table_program.h"

int main(int argc, char** argv) {
  return isosyrk::table_main(isosyrk::published_table(), {}, argc, argv);
}
