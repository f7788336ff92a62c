// What MeshLab since 2021.05 calls by other names than 2020.09. The folder of each generation has the same functions.
#pragma once

#include "plugin/meshlab/2021/meshlab.h"

#include <memory>
#include <optional>
#include <vector>

using FormatList = std::list<FileFormat>;
using ActionList = std::list<QAction*>;
using PluginAction = const QAction;  // as MeshLab passes it
using StockPlugin = IOPlugin;

namespace pcm::host {

inline constexpr bool importers_have_settings = false;
// The class of the dialog that asks what is to be saved.
inline constexpr const char* save_dialog = "SaveMeshAttributesDialog";

// A layer does not know its document: it is found among those that were met, and those of MeshLab's views. A layer of a
// document that was never met (PyMeshLab: one that is saved before any filter of ours was applied) gets an empty one.
MeshDocument& document_of(const MeshModel& model);
void meet(MeshDocument& document);

// Throws MLException if MeshLab has a plugin of this name: that of another file of ours, such as the system's package.
void refuse_second(const QString& plugin_name);

inline std::vector<MeshModel*> models_of(const MeshDocument& document)
{
    std::vector<MeshModel*> models;
    for (MeshModel& model : const_cast<MeshDocument&>(document).meshIterator()) models.push_back(&model);
    return models;
}
inline void remove_model(MeshDocument& document, MeshModel& model) { document.delMesh(unsigned(model.id())); }

inline bool is_shown(const MeshModel& model) { return model.isVisible(); }
inline void set_shown(MeshModel& model, bool on) { model.setVisible(on); }
inline void reset_state(MeshModel& model) { model.clear(); }

inline void write_log(GLLogStream& log, int level, const QString& text) { log.log(level, text); }
inline void show_line(GLLogStream& log, const QString& title, const QString& text) { log.realTimeLog(title, "", text); }

inline std::optional<int> choice_of(const Value&) { return std::nullopt; }
inline RichParameter* read_parameter(const QDomElement& element)
{
    RichParameter* read = nullptr;
    return RichParameterAdapter::create(element, read) ? read : nullptr;
}
// Python has the names of parameters in lower case: NotPlaces is not_places, in MeshLab's scripts too. Names of
// settings are the same in all generations.
QString script_name_of(const QString& name);
QString name_of_script(const QString& name);  // the name that script_name_of() was given in this process

}  // namespace pcm::host
