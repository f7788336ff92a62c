// The settings of the view in MeshLab's project files. MeshLab keeps the layers there and their own look, but no
// settings of decorators. Ours are an element <PointCloudSettings> that MeshLab ignores, so the file stays a project
// for a MeshLab without these plugins. So are what else belongs to a document (scene/project_parts.h).
#pragma once

#include "plugin/scene/scene_view.h"

#include <QByteArray>
#include <QDateTime>
#include <QObject>
#include <QString>

#include <map>

namespace pcm::host {

// The project `file`, as MeshLab has written it, with `settings` in place of those that it has.
// Returns it unchanged if it is not a project.
QByteArray with_settings(const QByteArray& file, const SettingStore& settings);
// Gives `settings` the values in the project `file`. Returns whether it has any.
bool take_settings(const QByteArray& file, SettingStore& settings);

class ProjectSettings : public QObject {
    Q_OBJECT

public:
    // A tree is being shown in `view`: if it comes from a project, the settings of the project apply from now on and
    // the scene gets its parts, and when the user saves a project, both are saved with it. Called as often as one
    // likes.
    static void follow(const SceneView& view);

private:
    explicit ProjectSettings(QObject* window);
    void read(const SceneView& view);
    void saved();

    struct State {
        QString file;
        QDateTime changed;
    };
    std::map<Scene*, State> known_;  // as it was read or written
};

}  // namespace pcm::host
