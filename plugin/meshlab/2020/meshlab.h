// MeshLab's and VCG's headers for MeshLab 2020.09.
#pragma once

#include <common/interfaces.h>
#include <common/ml_mesh_type.h>
#include <common/ml_selection_buffers.h>
#include <common/mlexception.h>
#include <common/pluginmanager.h>
#include <meshlab/glarea.h>
#include <meshlab/ml_default_decorators.h>
#include <vcg/math/similarity.h>
#include <wrap/io_trimesh/io_mask.h>
