// Applies the filters as MeshLab has them: through the plugin, with documents of MeshLab but without its window.
#pragma once

#include <common/interfaces.h>

#include <QCoreApplication>
#include <QPluginLoader>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace pcm::host {

namespace fs = std::filesystem;

inline MeshFilterInterface& plugin()
{
    static MeshFilterInterface* const loaded = [] {
        QPluginLoader loader(QCoreApplication::applicationDirPath() + "/../plugins/libpcm_filter.so");
        auto* filters = qobject_cast<MeshFilterInterface*>(loader.instance());
        if (!filters) throw std::runtime_error(loader.errorString().toStdString());
        return filters;
    }();
    return *loaded;
}

inline QAction* action_of(const QString& name)
{
    for (QAction* action : plugin().actions())
        if (action->text() == name) return action;
    throw std::runtime_error("no filter " + name.toStdString());
}

// A filter with the default values of its parameters, some of which a test changes.
class FilterCall {
public:
    explicit FilterCall(const QString& name) : action_(action_of(name))
    {
        plugin().initParameterSet(action_, document, parameters_);
    }
    FilterCall& set(const char* name, const Value& value)
    {
        parameters_.setValue(name, value);
        return *this;
    }
    FilterCall& set(const char* name, int value) { return set(name, IntValue(value)); }
    FilterCall& set(const char* name, bool value) { return set(name, BoolValue(value)); }
    FilterCall& set(const char* name, const fs::path& value)
    {
        return set(name, StringValue(QString::fromStdString(value.string())));
    }
    const RichParameterList& parameters() const { return parameters_; }
    bool apply()
    {
        plugin().setLog(&document.Log);
        return plugin().applyFilter(action_, document, parameters_, nullptr);
    }
    std::string log() const
    {
        std::string text;
        for (const auto& line : document.Log.logStringList()) text += line.second.toStdString() + "\n";
        return text;
    }

    MeshDocument document;

private:
    QAction* action_;
    RichParameterList parameters_;
};

}  // namespace pcm::host
