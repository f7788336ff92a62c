#include "plugin/meshlab/stock.h"

#include "plugin/meshlab/2021/plugin_bases.h"

namespace pcm::host {

namespace {

template <class Formats>
StockPlugin* find_plugin(const QString& extension, const StockPlugin* ours, const Formats& formats)
{
    for (StockPlugin* plugin : meshlab::pluginManagerInstance().ioPluginIterator()) {
        if (plugin == ours) continue;
        for (const FileFormat& format : formats(*plugin))
            if (format.extensions.contains(extension, Qt::CaseInsensitive)) return plugin;
    }
    return nullptr;
}

template <class Work>
QString done_by(StockPlugin& stock, const MeshModel& layer, const Work& work)
{
    stock.setLog(&document_of(layer).Log);
    try {
        work();
    } catch (const MLException& error) {
        throw Failure(QString::fromLocal8Bit(error.what()));
    }
    return stock.warningMessageString();
}

}  // namespace

StockPlugin* stock_importer(const QString& extension, const StockPlugin* ours)
{
    return find_plugin(extension, ours, [](const StockPlugin& plugin) { return plugin.importFormats(); });
}

StockPlugin* stock_exporter(const QString& extension, const StockPlugin* ours)
{
    return find_plugin(extension, ours, [](const StockPlugin& plugin) { return plugin.exportFormats(); });
}

RichParameterList stock_open_parameters(StockPlugin& stock, const QString& format, const QString&)
{
    return stock.initPreOpenParameter(format);
}

RichParameterList stock_save_parameters(StockPlugin& stock, const QString& format, const MeshModel& layer)
{
    return stock.initSaveParameter(format, layer);
}

void stock_mask(StockPlugin& stock, const QString& format, int& capability, int& defaults)
{
    stock.exportMaskCapability(format, capability, defaults);
}

QString stock_open(StockPlugin& stock, const StockCall& call, MeshModel& layer, int& mask)
{
    // MeshLab has asked ours for parameters, before it gave the file's name: the stock plugin's own have their
    // defaults.
    const RichParameterList parameters = stock.initPreOpenParameter(call.format);
    return done_by(stock, layer,
                   [&] { stock.open(call.format, call.file_name, layer, mask, parameters, call.callback); });
}

QString stock_save(StockPlugin& stock, const StockCall& call, MeshModel& layer, int mask)
{
    return done_by(stock, layer,
                   [&] { stock.save(call.format, call.file_name, layer, mask, call.parameters, call.callback); });
}

}  // namespace pcm::host
