#include <isosyrk/split/split_matrix.h>

int main() {}
