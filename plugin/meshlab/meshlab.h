// MeshLab, in the generation that this is compiled for. Its folder has all of MeshLab's and VCG's headers that the
// plugins use (nothing else includes one), and what its interface calls by other names (seams.h).
#pragma once

#if PCM_MESHLAB_GENERATION == 2020
#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/meshlab/2020/seams.h"
#else
#include "plugin/meshlab/2021/meshlab.h"
#include "plugin/meshlab/2021/seams.h"
#endif
