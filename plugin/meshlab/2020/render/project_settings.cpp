#include "plugin/meshlab/2020/render/project_settings.h"

#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/meshlab/2020/registry.h"
#include "plugin/meshlab/2020/render/settings.h"
#include "plugin/scene/project_parts.h"

#include <QAction>
#include <QDomDocument>
#include <QFileInfo>
#include <QMainWindow>
#include <QSaveFile>

#include <memory>

namespace pcm::host {

namespace {

const QString element_name = "PointCloudSettings";
const QByteArray end_of_project = "</MeshLabProject>";

// MeshLab's name of a project that was opened or saved is its path.
QString file_of(const MeshDocument& document)
{
    const QFileInfo file(document.docLabel());
    const QString type = file.suffix().toLower();
    return (type == "mlp" || type == "mlb") && file.isFile() ? file.absoluteFilePath() : QString();
}

QByteArray content_of(const QString& path)
{
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
}

// The memory to use belongs to the computer, not to the project.
RichParameterList kept_settings()
{
    RichParameterList all, kept;
    add_settings(all);
    for (const RichParameter& setting : all)
        if (!is_memory(setting.name())) kept.addParam(setting);
    return kept;
}

}  // namespace

QByteArray with_settings(const QByteArray& file, const RichParameterList& parameters)
{
    QByteArray project = file;
    const int old_begin = project.indexOf("<" + element_name.toUtf8() + ">");
    const QByteArray old_end = "</" + element_name.toUtf8() + ">\n";
    if (old_begin >= 0 && project.indexOf(old_end, old_begin) >= 0)
        project.remove(old_begin, project.indexOf(old_end, old_begin) + old_end.size() - old_begin);
    const int end = project.lastIndexOf(end_of_project);
    if (end < 0) return file;
    QDomDocument document;
    QDomElement settings = document.createElement(element_name);
    document.appendChild(settings);
    for (const RichParameter& setting : kept_settings())
        if (parameters.hasParameter(setting.name()))
            settings.appendChild(parameters.getParameterByName(setting.name()).fillToXMLDocument(document, false));
    return project.insert(end, document.toByteArray(1));
}

bool take_settings(const QByteArray& file, RichParameterList& parameters)
{
    QDomDocument document;
    if (!document.setContent(file)) return false;
    const QDomElement settings = document.documentElement().firstChildElement(element_name);
    const RichParameterList kept = kept_settings();
    for (QDomElement e = settings.firstChildElement(); !e.isNull(); e = e.nextSiblingElement()) {
        RichParameter* read = nullptr;
        if (!RichParameterAdapter::create(e, &read)) continue;
        const std::unique_ptr<RichParameter> setting(read);
        if (!kept.hasParameter(setting->name()) || !parameters.hasParameter(setting->name())) continue;
        RichParameter& mine = parameters.getParameterByName(setting->name());
        if (mine.stringType() == setting->stringType()) mine.setValue(setting->value());
    }
    return !settings.isNull();
}

void ProjectSettings::follow(GLArea& area)
{
    QMainWindow* const window = window_of(area);
    if (!window || !area.md()) return;
    auto* settings = window->findChild<ProjectSettings*>(QString(), Qt::FindDirectChildrenOnly);
    if (!settings) settings = new ProjectSettings(window);
    settings->read(*area.md(), const_cast<RichParameterList&>(*area.glas.currentGlobalParamSet));
}

ProjectSettings::ProjectSettings(QObject* window) : QObject(window)
{
    // Connected after MeshLab, so called when the file has been written.
    for (QAction* action : window->findChildren<QAction*>(QString(), Qt::FindDirectChildrenOnly))
        if (action->text().remove('&') == "Save Project As...")
            connect(action, &QAction::triggered, this, &ProjectSettings::saved);
}

void ProjectSettings::read(MeshDocument& document, RichParameterList& parameters)
{
    if (known_.emplace(&document, State()).second)
        connect(&document, &QObject::destroyed, this, [this, key = &document] { known_.erase(key); });
    const QString file = file_of(document);
    State& state = known_[&document];
    if (file.isEmpty() || state.file == file) return;
    state = {file, QFileInfo(file).lastModified()};
    const QByteArray project = content_of(file);
    take_parts(project, scene_of(document));
    if (take_settings(project, parameters))
        document.Log.Log(GLLogStream::SYSTEM, qPrintable("Point Cloud: the settings of the view are those of " + file));
}

// MeshLab does not say whether the user cancelled its dialog: then no file has changed.
void ProjectSettings::saved()
{
    for (auto& [key, state] : known_) {
        const auto views = views_of(*key);
        const QString file = file_of(*key);
        if (views.empty() || file.isEmpty()) continue;
        if (state.file == file && state.changed == QFileInfo(file).lastModified()) continue;
        const QByteArray before = content_of(file);
        MeshDocument& document = *views.front()->md();
        const QByteArray after =
            with_parts(with_settings(before, *views.front()->glas.currentGlobalParamSet), scene_of(document));
        QSaveFile out(file);
        if (after != before && (!out.open(QIODevice::WriteOnly) || out.write(after) != after.size() || !out.commit()))
            document.Log.Log(GLLogStream::WARNING,
                             qPrintable("Point Cloud: " + file +
                                        ": the settings of the view, measures and the like cannot be added to the "
                                        "project: " +
                                        out.errorString()));
        state = {file, QFileInfo(file).lastModified()};
    }
}

}  // namespace pcm::host
