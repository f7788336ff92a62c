// The settings of the view in MeshLab's project files. MeshLab keeps the layers there and their own look, but no
// settings of decorators. Ours are an element <PointCloudSettings> that MeshLab ignores, so the file stays a project
// for a MeshLab without these plugins. So are what else belongs to a document (scene/project_parts.h).
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

#include <QByteArray>
#include <QDateTime>
#include <QObject>
#include <QString>

#include <map>

class GLArea;

namespace pcm::host {

// The project `file`, as MeshLab has written it, with the settings of `parameters` in place of those that it has.
// Returns it unchanged if it is no project.
QByteArray with_settings(const QByteArray& file, const RichParameterList& parameters);
// Gives `parameters` the values in the project `file`. Returns whether it has any.
bool take_settings(const QByteArray& file, RichParameterList& parameters);

class ProjectSettings : public QObject {
    Q_OBJECT

public:
    // A tree is being shown in `area`: if it comes from a project, the settings of the project apply from now on and
    // the document gets its parts, and when the user saves a project, both are saved with it. Called as often as one
    // likes.
    static void follow(GLArea& area);

private:
    explicit ProjectSettings(QObject* window);
    void read(MeshDocument& document, RichParameterList& parameters);
    void saved();

    struct State {
        QString file;
        QDateTime changed;
    };
    std::map<const MeshDocument*, State> known_;  // as it was read or written
};

}  // namespace pcm::host
