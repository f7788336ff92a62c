#include "plugin/meshlab/2021/seams.h"

#include <QApplication>
#include <QHash>

#include <algorithm>

namespace pcm::host {

namespace {

std::vector<MeshDocument*>& met()
{
    static auto* const documents = new std::vector<MeshDocument*>;
    return *documents;
}

bool has(const MeshDocument& document, const MeshModel& model)
{
    return std::any_of(document.meshBegin(), document.meshEnd(),
                       [&](const MeshModel& other) { return &other == &model; });
}

// The name in scripts -> the name.
QHash<QString, QString>& names()
{
    static auto* const table = new QHash<QString, QString>;
    return *table;
}

}  // namespace

void meet(MeshDocument& document)
{
    if (std::find(met().begin(), met().end(), &document) != met().end()) return;
    met().push_back(&document);
    MeshDocument* const key = &document;
    QObject::connect(key, &QObject::destroyed,
                     [key] { met().erase(std::remove(met().begin(), met().end(), key), met().end()); });
}

MeshDocument& document_of(const MeshModel& model)
{
    for (MeshDocument* document : met())
        if (has(*document, model)) return *document;
    for (QWidget* widget : QApplication::allWidgets()) {
        if (!widget->inherits("GLArea")) continue;
        MeshDocument* const document = static_cast<GLArea*>(widget)->md();
        if (!document || !has(*document, model)) continue;
        meet(*document);
        return *document;
    }
    static auto* const unknown = new MeshDocument;
    return *unknown;
}

void refuse_second(const QString& plugin_name)
{
    const PluginManager& manager = meshlab::pluginManagerInstance();
    const auto refuse = [&](auto plugins) {
        for (const auto* other : plugins)
            if (other->pluginName() == plugin_name)
                throw MLException("PCM for MeshLab is loaded already, from another file. Keep one of them.");
    };
    refuse(manager.ioPluginIterator(true));
    refuse(manager.filterPluginIterator(true));
    refuse(manager.decoratePluginIterator(true));
    refuse(manager.editPluginFactoryIterator(true));
}

QString script_name_of(const QString& name)
{
    if (name.contains(':') || name.mid(1) == name.mid(1).toLower()) return name;  // a setting; one word
    QString script;
    bool was_upper = true;
    for (const QChar letter : name) {
        if (letter.isUpper() && !was_upper) script += '_';
        was_upper = letter.isUpper();
        script += letter.toLower();
    }
    names().insert(script, name);
    return script;
}

QString name_of_script(const QString& name) { return names().value(name, name); }

}  // namespace pcm::host
