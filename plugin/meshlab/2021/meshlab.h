// MeshLab's and VCG's headers since MeshLab 2021.05.
#pragma once

#include <common/globals.h>
#include <common/ml_document/mesh_document.h>
#include <common/ml_selection_buffers.h>
#include <common/mlexception.h>
#include <common/parameters/rich_parameter_list.h>
#include <common/plugins/interfaces/decorate_plugin.h>
#include <common/plugins/interfaces/edit_plugin.h>
#include <common/plugins/interfaces/filter_plugin.h>
#include <common/plugins/interfaces/io_plugin.h>
#include <common/plugins/plugin_manager.h>
#include <common/python/function_set.h>
#include <meshlab/glarea.h>
#include <meshlab/ml_default_decorators.h>
#include <vcg/math/similarity.h>
#include <wrap/io_trimesh/io_mask.h>
// Later versions have the parameters in a file each.
#if __has_include(<common/parameters/rich_parameters.h>)
#include <common/parameters/rich_parameters.h>
#else
#include <common/parameters/rich_parameter.h>
#endif
