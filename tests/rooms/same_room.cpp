#include <isosyrk/linalg/matrix.h>
