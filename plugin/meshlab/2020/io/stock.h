// MeshLab's own importers and exporters of the file extensions that this plugin has taken over.
//
// MeshLab assigns an extension to the first plugin by file name, for all files with that extension. Ours is the first,
// and delegates what is not a cloud: a PLY with faces, a layer with faces.
#pragma once

#include <QString>

class MeshIOInterface;

namespace pcm::host {

// The plugin, other than `ours`, that MeshLab would use to read or write files with this extension; null if there is
// none. MeshLab has loaded it and owns it.
MeshIOInterface* stock_importer(const QString& extension, const MeshIOInterface* ours);
MeshIOInterface* stock_exporter(const QString& extension, const MeshIOInterface* ours);

}  // namespace pcm::host
