// MeshLab's own importers and exporters of the file extensions that our plugin has taken over.
//
// MeshLab assigns an extension to one plugin, for all files with that extension. Ours comes first, and delegates what
// is not a cloud: a PLY with faces, a layer with faces.
#pragma once

#include "plugin/meshlab/meshlab.h"

namespace pcm::host {

// The plugin, other than `ours`, that MeshLab would use to read or write files with this extension; null if there is
// none. MeshLab has loaded it and owns it.
StockPlugin* stock_importer(const QString& extension, const StockPlugin* ours);
StockPlugin* stock_exporter(const QString& extension, const StockPlugin* ours);

RichParameterList stock_open_parameters(StockPlugin& stock, const QString& format, const QString& file_name);
RichParameterList stock_save_parameters(StockPlugin& stock, const QString& format, const MeshModel& layer);
void stock_mask(StockPlugin& stock, const QString& format, int& capability, int& defaults);

// What a user does with a file: as MeshLab would do it without our plugin. Return a warning about what was done all the
// same; throw Failure (plugin_bases.h).
struct StockCall {
    const QString& format;
    const QString& file_name;
    const RichParameterList& parameters;
    vcg::CallBackPos* callback;
    QWidget* window;  // null: none
};
QString stock_open(StockPlugin& stock, const StockCall& call, MeshModel& layer, int& mask);
QString stock_save(StockPlugin& stock, const StockCall& call, MeshModel& layer, int mask);

}  // namespace pcm::host
