// What a document has in addition to MeshLab's layers and is kept in project files: measures, bookmarks, the clip box.
//
// A part registers itself once; the render plugin, which watches projects being opened and saved
// (meshlab/render/project_settings.h), calls it. The text of a part is an element of MeshLab's project that
// MeshLab ignores.
#pragma once

#include "plugin/scene/scene.h"

#include <QByteArray>
#include <QString>

#include <functional>
#include <vector>

namespace pcm::host {

struct ProjectPart {
    QString name;  // name of the element, such as "PointCloudMeasures"
    // The text to keep; empty: nothing. Any characters that XML can hold.
    std::function<QString(Scene& scene)> text;
    // A project with this part was opened. Whatever is wrong with the text is thrown as an Error; the document keeps
    // what it has.
    std::function<void(Scene& scene, const QString& text)> take;
};

void add_project_part(ProjectPart part);
const std::vector<ProjectPart>& project_parts();

// The project file `project`, as MeshLab has written it, with the parts of the document instead of its own.
// Returns it unchanged if there are none, or if it is not a project. A part that has nothing to keep, and whose text in
// the opened project could not be read, keeps that text. Errors are logged.
QByteArray with_parts(const QByteArray& project, Scene& scene);
// Gives the document the parts in the project file `project`. Errors are logged.
void take_parts(const QByteArray& project, Scene& scene);

}  // namespace pcm::host
