// MeshLab 2020.09 as newer generations have it. The folder of each generation has the same functions.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

#include <optional>
#include <vector>

using FileFormat = MeshIOInterface::Format;
using FormatList = QList<FileFormat>;
using ActionList = QList<QAction*>;
using PluginAction = QAction;  // as MeshLab passes it
using StockPlugin = MeshIOInterface;

namespace pcm::host {

// Newer ones have no settings of importers: those are the decorator's.
inline constexpr bool importers_have_settings = true;
// The class of the dialog that asks what is to be saved.
inline constexpr const char* save_dialog = "SaveMaskExporterDialog";

// A layer's document. Newer layers do not know it, and only documents that were met are found.
inline MeshDocument& document_of(const MeshModel& model) { return *model.parent; }
inline void meet(MeshDocument&) {}

// This one loads the plugins of one folder.
inline void refuse_second(const QString&) {}

inline std::vector<MeshModel*> models_of(const MeshDocument& document)
{
    std::vector<MeshModel*> models;
    for (MeshModel* model : document.meshList)
        if (model) models.push_back(model);
    return models;
}
inline void remove_model(MeshDocument& document, MeshModel& model) { document.delMesh(&model); }

inline bool is_shown(const MeshModel& model) { return model.visible; }
inline void set_shown(MeshModel& model, bool on) { model.visible = on; }
inline void reset_state(MeshModel& model) { model.Clear(); }

inline void write_log(GLLogStream& log, int level, const QString& text) { log.Log(level, qPrintable(text)); }
inline void show_line(GLLogStream& log, const QString& title, const QString& text) { log.RealTimeLog(title, "", text); }

// The number of a choice, where values know that they are one.
inline std::optional<int> choice_of(const Value& value)
{
    return value.isEnum() ? std::optional(value.getEnum()) : std::nullopt;
}
inline RichParameter* read_parameter(const QDomElement& element)
{
    RichParameter* read = nullptr;
    return RichParameterAdapter::create(element, &read) ? read : nullptr;
}
// Names of parameters as scripts have them: our own.
inline QString script_name_of(const QString& name) { return name; }
inline QString name_of_script(const QString& name) { return name; }

}  // namespace pcm::host
