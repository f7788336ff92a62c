// Applies the filters as MeshLab has them: through the plugin, with documents of MeshLab but without its window.
#pragma once

#include "plugin/meshlab/plugin_bases.h"
#include "tests/plugin/choice.h"
#include "tests/plugin/met_document.h"

#include <QCoreApplication>
#include <QPluginLoader>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace pcm::host {

namespace fs = std::filesystem;

inline FilterBase& plugin()
{
    static FilterBase* const loaded = [] {
        QPluginLoader loader(QCoreApplication::applicationDirPath() + "/../plugins/libpcm_filter.so");
        auto* filters = dynamic_cast<FilterBase*>(loader.instance());
        if (!filters) throw std::runtime_error(loader.errorString().toStdString());
        return filters;
    }();
    return *loaded;
}

// As MeshLab does it; false: the filter has failed.
inline bool apply(QAction* action, MeshDocument& document, const RichParameterList& parameters)
{
    plugin().setLog(&document.Log);
    try {
        plugin().run(action, document, parameters, nullptr);
        return true;
    } catch (const Failure&) {
        return false;
    }
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
        parameters_ = plugin().parameters_for(action_, document);
    }
    FilterCall& set(const char* name, const Value& value)
    {
        parameters_.setValue(script_name_of(name), value);
        return *this;
    }
    FilterCall& choose(const char* name, int number)
    {
        test::choose(parameters_, *test::find_choice(parameters_, script_name_of(name)), number);
        return *this;
    }
    FilterCall& set(const char* name, int value) { return set(name, IntValue(value)); }
    FilterCall& set(const char* name, bool value) { return set(name, BoolValue(value)); }
    FilterCall& set(const char* name, const fs::path& value)
    {
        return set(name, StringValue(QString::fromStdString(value.string())));
    }
    const RichParameterList& parameters() const { return parameters_; }
    bool apply() { return host::apply(action_, document, parameters_); }
    std::string log() const
    {
        std::string text;
        for (const auto& line : document.Log.logStringList()) text += line.second.toStdString() + "\n";
        return text;
    }

    MetDocument document;

private:
    QAction* action_;
    RichParameterList parameters_;
};

}  // namespace pcm::host
