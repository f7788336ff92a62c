// MeshLab's own importers and exporters of file extensions that we have taken over.
//
// MeshLab gives an extension to the first plugin by file name, for all files of that extension. Ours comes first, and
// hands on what is not a cloud: a PLY with faces, a layer with faces.
#pragma once

#include <common/interfaces.h>

namespace pcm::host {

// The plugin, other than `ours`, that MeshLab would ask to read or write files of this extension; null when there is
// none. It has been loaded by MeshLab, which owns it.
MeshIOInterface* stock_importer(const QString& extension, const MeshIOInterface* ours);
MeshIOInterface* stock_exporter(const QString& extension, const MeshIOInterface* ours);

}  // namespace pcm::host
