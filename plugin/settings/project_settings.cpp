#include "plugin/settings/project_settings.h"

#include "plugin/scene/project_parts.h"
#include "plugin/settings/settings.h"

#include <QAction>
#include <QDomDocument>
#include <QFileInfo>
#include <QMainWindow>
#include <QSaveFile>

namespace pcm::host {

namespace {

const QString element_name = "PointCloudSettings";
const QByteArray end_of_project = "</MeshLabProject>";

QByteArray content_of(const QString& path)
{
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
}

// The memory to use belongs to the computer, not to the project.
Parameters kept_settings()
{
    Parameters all, kept;
    add_settings(all);
    for (const Parameter& setting : all)
        if (!is_memory(setting.name)) kept.add(setting);
    return kept;
}

}  // namespace

QByteArray with_settings(const QByteArray& file, const SettingStore& settings)
{
    QByteArray project = file;
    const int old_begin = project.indexOf("<" + element_name.toUtf8() + ">");
    const QByteArray old_end = "</" + element_name.toUtf8() + ">\n";
    if (old_begin >= 0 && project.indexOf(old_end, old_begin) >= 0)
        project.remove(old_begin, project.indexOf(old_end, old_begin) + old_end.size() - old_begin);
    const int end = project.lastIndexOf(end_of_project);
    if (end < 0) return file;
    QDomDocument document;
    QDomElement element = document.createElement(element_name);
    document.appendChild(element);
    for (const Parameter& setting : kept_settings())
        if (settings.value(setting.name)) element.appendChild(settings.element_of(setting.name, document));
    return project.insert(end, document.toByteArray(1));
}

bool take_settings(const QByteArray& file, SettingStore& settings)
{
    QDomDocument document;
    if (!document.setContent(file)) return false;
    const QDomElement element = document.documentElement().firstChildElement(element_name);
    const Parameters kept = kept_settings();
    for (QDomElement e = element.firstChildElement(); !e.isNull(); e = e.nextSiblingElement()) {
        const auto read = settings.parameter_of(e);
        const Parameter* const mine = read ? kept.find(read->name) : nullptr;
        if (mine && mine->value.userType() == read->value.userType() &&
            mine->choices.isEmpty() == read->choices.isEmpty())
            settings.set(read->name, read->value);
    }
    return !element.isNull();
}

void ProjectSettings::follow(const SceneView& view)
{
    QMainWindow* const window = view.window();
    if (!window) return;
    auto* settings = window->findChild<ProjectSettings*>(QString(), Qt::FindDirectChildrenOnly);
    if (!settings) settings = new ProjectSettings(window);
    settings->read(view);
}

ProjectSettings::ProjectSettings(QObject* window) : QObject(window)
{
    // Connected after MeshLab, so called when the file has been written.
    for (QAction* action : window->findChildren<QAction*>(QString(), Qt::FindDirectChildrenOnly))
        if (action->text().remove('&') == "Save Project As...")
            connect(action, &QAction::triggered, this, &ProjectSettings::saved);
}

void ProjectSettings::read(const SceneView& view)
{
    Scene& scene = view.scene();
    if (known_.emplace(&scene, State()).second)
        connect(&scene, &QObject::destroyed, this, [this, key = &scene] { known_.erase(key); });
    const QString file = scene.project_file();
    State& state = known_[&scene];
    if (file.isEmpty() || state.file == file) return;
    state = {file, QFileInfo(file).lastModified()};
    const QByteArray project = content_of(file);
    take_parts(project, scene);
    if (take_settings(project, *view.settings()))
        scene.log(LogLevel::system, "Point Cloud: the settings of the view are those of " + file);
}

// MeshLab does not say whether the user cancelled its dialog: then no file has changed.
void ProjectSettings::saved()
{
    for (auto& [scene, state] : known_) {
        const auto views = scene->views();
        const QString file = scene->project_file();
        if (views.empty() || file.isEmpty()) continue;
        if (state.file == file && state.changed == QFileInfo(file).lastModified()) continue;
        const QByteArray before = content_of(file);
        const QByteArray after = with_parts(with_settings(before, *views.front()->settings()), *scene);
        QSaveFile out(file);
        if (after != before && (!out.open(QIODevice::WriteOnly) || out.write(after) != after.size() || !out.commit()))
            scene->log(LogLevel::warning,
                       "Point Cloud: " + file +
                           ": the settings of the view, measures and the like cannot be added to the project: " +
                           out.errorString());
        state = {file, QFileInfo(file).lastModified()};
    }
}

}  // namespace pcm::host
