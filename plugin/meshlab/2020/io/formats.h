// The formats of point clouds as MeshLab lists them: those of the table in pcm/io/formats.h, and trees.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

namespace pcm::host {

QList<MeshIOInterface::Format> import_formats();
QList<MeshIOInterface::Format> export_formats();

}  // namespace pcm::host
