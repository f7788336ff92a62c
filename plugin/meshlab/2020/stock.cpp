#include "plugin/meshlab/stock.h"

#include "plugin/meshlab/2020/plugin_bases.h"

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

RichParameterList stock_open_parameters(StockPlugin& stock, const QString& format, const QString& file_name)
{
    RichParameterList parameters;
    stock.initPreOpenParameter(format, file_name, parameters);
    return parameters;
}

RichParameterList stock_save_parameters(StockPlugin& stock, const QString& format, const MeshModel& layer)
{
    RichParameterList parameters;
    stock.initSaveParameter(format, const_cast<MeshModel&>(layer), parameters);
    return parameters;
}

void stock_mask(StockPlugin& stock, const QString& format, int& capability, int& defaults)
{
    QString name = format;
    stock.GetExportMaskCapability(name, capability, defaults);
}

QString stock_open(StockPlugin& stock, const StockCall& call, MeshModel& layer, int& mask)
{
    if (layer.parent) stock.setLog(&layer.parent->Log);
    stock.clearErrorString();
    const bool opened =
        stock.open(call.format, call.file_name, layer, mask, call.parameters, call.callback, call.window);
    const QString message = stock.errorMsg();
    stock.clearErrorString();
    if (!opened) throw Failure(message);
    return message;
}

QString stock_save(StockPlugin& stock, const StockCall& call, MeshModel& layer, int mask)
{
    stock.setLog(&layer.parent->Log);
    stock.clearErrorString();
    const bool saved =
        stock.save(call.format, call.file_name, layer, mask, call.parameters, call.callback, call.window);
    const QString message = stock.errorMsg();
    stock.clearErrorString();
    if (!saved) throw Failure(message);
    return message;
}

}  // namespace pcm::host
