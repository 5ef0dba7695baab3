#include <isosyrk/scenes/scene.h>
