#include "plugin/meshlab/2020/io/stock.h"

#include "plugin/meshlab/2020/meshlab.h"

#include <QDir>
#include <QLibrary>
#include <QPluginLoader>

namespace pcm::host {

namespace {

template <class Formats>
MeshIOInterface* find_plugin(const QString& extension, const MeshIOInterface* ours, const Formats& formats)
{
    const QDir folder(PluginManager::getDefaultPluginDirPath());
    for (const QFileInfo& file : folder.entryInfoList(QDir::Files)) {  // sorted by name, as MeshLab does
        if (!QLibrary::isLibrary(file.fileName())) continue;
        // Gives the instance that MeshLab has.
        auto* plugin = qobject_cast<MeshIOInterface*>(QPluginLoader(file.absoluteFilePath()).instance());
        if (!plugin || plugin == ours) continue;
        for (const MeshIOInterface::Format& format : formats(*plugin))
            if (format.extensions.contains(extension, Qt::CaseInsensitive)) return plugin;
    }
    return nullptr;
}

}  // namespace

MeshIOInterface* stock_importer(const QString& extension, const MeshIOInterface* ours)
{
    return find_plugin(extension, ours, [](const MeshIOInterface& plugin) { return plugin.importFormats(); });
}

MeshIOInterface* stock_exporter(const QString& extension, const MeshIOInterface* ours)
{
    return find_plugin(extension, ours, [](const MeshIOInterface& plugin) { return plugin.exportFormats(); });
}

}  // namespace pcm::host
