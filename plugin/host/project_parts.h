// What a document has beside MeshLab's layers and is kept in project files: measures, bookmarks, the clip box.
//
// A part registers itself once; the render plugin, which watches projects being opened and saved
// (render/project_settings.h), calls it. The text of a part is an element of MeshLab's project that MeshLab ignores.
#pragma once

#include <common/interfaces.h>

#include <QString>

#include <functional>
#include <vector>

namespace pcm::host {

struct ProjectPart {
    QString name;  // of the element, such as "PointCloudMeasures"
    // The text to keep; empty: nothing. Any characters that XML can hold.
    std::function<QString(MeshDocument& document)> text;
    // A project with this part was opened. Whatever is wrong with the text is thrown as an Error; the document keeps
    // what it has.
    std::function<void(MeshDocument& document, const QString& text)> take;
};

void add_project_part(ProjectPart part);
const std::vector<ProjectPart>& project_parts();

}  // namespace pcm::host
