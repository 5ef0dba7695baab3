#include <isosyrk/linalg/matrix.h>

#include <isosyrk/flows/flow.h>
