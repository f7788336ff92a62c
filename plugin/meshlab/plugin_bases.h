// What the plugins derive from, in the generation of MeshLab that this is compiled for.
#pragma once

#if PCM_MESHLAB_GENERATION == 2020
#include "plugin/meshlab/2020/plugin_bases.h"
#else
#include "plugin/meshlab/2021/plugin_bases.h"
#endif
