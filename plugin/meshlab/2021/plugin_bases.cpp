#include "plugin/meshlab/2021/plugin_bases.h"

#include <QApplication>
#include <QDir>
#include <QTimer>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace {

// MeshLab's plugins keep the log to themselves, and a layer does not know its document: that of an import is the one
// whose log the importer was given. An explicit instantiation may name a private member.
template <GLLogStream* MeshLabPluginLogger::*member>
struct LogOf {
    friend GLLogStream* log_of(const MeshLabPluginLogger& plugin) { return plugin.*member; }
};
template struct LogOf<&MeshLabPluginLogger::logstream>;
GLLogStream* log_of(const MeshLabPluginLogger& plugin);

template <IOPluginContainer PluginManager::*member>
struct ListOf {
    friend IOPluginContainer& io_plugins_of(PluginManager& manager) { return manager.*member; }
};
template struct ListOf<&PluginManager::ioPlugins>;
IOPluginContainer& io_plugins_of(PluginManager& manager);

// Null: the importer has no log.
MeshDocument* document_of_log(const MeshLabPluginLogger& plugin)
{
    static const std::ptrdiff_t place = [] {
        MeshDocument any;
        return reinterpret_cast<char*>(&any.Log) - reinterpret_cast<char*>(&any);
    }();
    GLLogStream* const log = log_of(plugin);
    return log ? reinterpret_cast<MeshDocument*>(reinterpret_cast<char*>(log) - place) : nullptr;
}

}  // namespace

namespace pcm::host {

RichParameterList* window_settings()
{
    if (!qobject_cast<QApplication*>(QCoreApplication::instance())) return nullptr;
    for (QWidget* widget : QApplication::allWidgets())
        if (widget->inherits("GLArea"))
            return const_cast<RichParameterList*>(static_cast<GLArea*>(widget)->glas.currentGlobalParamSet);
    return nullptr;
}

unsigned int IoBase::numberMeshesContainedInFile(const QString&, const QString&, const RichParameterList&) const
{
    folder_ = QDir::currentPath();
    return 1;
}

void IoBase::open(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
                  const RichParameterList& parameters, vcg::CallBackPos* callback)
{
    if (MeshDocument* document = document_of_log(*this)) meet(*document);
    const QString before = std::exchange(folder_, QString());
    RichParameterList with_settings = parameters;
    if (const RichParameterList* settings = window_settings()) with_settings.join(*settings);
    try {
        open_layer(format, file_name, layer, mask, with_settings, callback);
    } catch (...) {
        if (!before.isEmpty()) QDir::setCurrent(before);
        throw;
    }
    if (!QCoreApplication::instance()) return;
    // After that MeshLab decides how to draw the layer, before it handles events again.
    MeshDocument* const document = &document_of(layer);
    QTimer::singleShot(0, document, [this, document, mesh_id = layer.id()] {
        if (MeshModel* shown = document->getMesh(unsigned(mesh_id))) opened(*shown);
    });
}

// MeshLab gives an extension to the plugin that it has listed first. Ours comes first by its name where MeshLab loads
// all, and last where a user or a script loads it: MeshLab's plugins for our extensions are then listed again, after
// ours.
FormatList IoBase::exportProjectFormats() const
{
    if (std::exchange(is_listed_, true)) return {};
    list_first();
    is_settled_ = true;
    was_listed();
    return {};
}

void IoBase::list_first() const
{
    PluginManager& manager = meshlab::pluginManagerInstance();
    std::vector<IOPlugin*> before;
    for (const auto& formats : {importFormats(), exportFormats()})
        for (const FileFormat& format : formats)
            for (const QString& extension : format.extensions)
                for (IOPlugin* plugin : {manager.inputMeshPlugin(extension), manager.outputMeshPlugin(extension)})
                    if (plugin && plugin != this && std::find(before.begin(), before.end(), plugin) == before.end())
                        before.push_back(plugin);
    if (before.empty()) return;
    IOPluginContainer& list = io_plugins_of(manager);
    auto* const ours = const_cast<IoBase*>(this);
    list.eraseIOPlugin(ours);
    for (IOPlugin* plugin : before) list.eraseIOPlugin(plugin);
    list.pushIOPlugin(ours);
    for (IOPlugin* plugin : before) list.pushIOPlugin(plugin);
}

RichParameterList IoBase::initPreOpenParameter(const QString& format) const
{
    RichParameterList parameters = parameters_before_open(format, QString());
    RichParameterList* const settings = window_settings();
    if (!settings) return parameters;
    // MeshLab's dialog shows what was typed for the last file, and stores the values as settings, which it has made for
    // the plugin that lists the extension. What fits one file need not fit another: the dialog begins anew, and what is
    // remembered is for files that are opened without it.
    const QString prefix = "MeshLab::IO::" + format.toUpper() + "::", asks = prefix + "showPreOpenParameterDialog";
    const bool is_asked = !settings->hasParameter(asks) || settings->getBool(asks);
    for (const RichParameter& parameter : parameters) {
        const QString name = prefix + parameter.name();
        if (settings->hasParameter(name)) {
            if (is_asked) settings->setValue(name, parameter.value());
            continue;
        }
        const std::unique_ptr<RichParameter> setting(parameter.clone());
        setting->setName(name);
        settings->addParam(*setting);
    }
    return parameters;
}

FormatList IoBase::importFormats() const
{
    FormatList formats = all_import_formats();
    if (!is_settled_) return formats;
    QStringList others;
    for (const IOPlugin* plugin : meshlab::pluginManagerInstance().ioPluginIterator())
        if (plugin != this)
            for (const FileFormat& format : plugin->importFormats()) others << format.extensions;
    formats.remove_if(
        [&](const FileFormat& format) { return others.contains(format.extensions.front(), Qt::CaseInsensitive); });
    return formats;
}

}  // namespace pcm::host
