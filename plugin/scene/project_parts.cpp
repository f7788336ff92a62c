#include "plugin/scene/project_parts.h"

#include "plugin/scene/text.h"

#include <QDomDocument>
#include <QVariant>

#include <utility>

namespace pcm::host {

namespace {

const QByteArray end_of_project = "</MeshLabProject>";

std::vector<ProjectPart>& parts()
{
    static auto* const parts = new std::vector<ProjectPart>;
    return *parts;
}

// The text of a part that could not be read is kept with the scene, so that saving does not lose it.
QByteArray unread_key(const ProjectPart& part) { return "pcm_unread_" + part.name.toUtf8(); }

void warn(Scene& scene, const ProjectPart& part, const QString& what)
{
    scene.log(LogLevel::warning, QString("Point Cloud: the element <%1> of the project %2: %3")
                                     .arg(part.name, what, QString::fromStdString(current_error())));
}

QString text_of(const ProjectPart& part, Scene& scene)
{
    QString text;
    try {
        text = part.text(scene);
    } catch (...) {
        warn(scene, part, "cannot be saved");
    }
    return text.isEmpty() ? scene.property(unread_key(part)).toString() : text;
}

void remove_element(QByteArray& project, const QByteArray& name)
{
    const QByteArray end_tag = "</" + name + ">\n";
    const int begin = project.indexOf("<" + name + ">");
    const int end = begin < 0 ? -1 : project.indexOf(end_tag, begin);
    if (end >= 0) project.remove(begin, end + end_tag.size() - begin);
}

}  // namespace

void add_project_part(ProjectPart part) { parts().push_back(std::move(part)); }

const std::vector<ProjectPart>& project_parts() { return parts(); }

QByteArray with_parts(const QByteArray& project, Scene& scene)
{
    QByteArray changed = project;
    for (const ProjectPart& part : parts()) {
        const int end = changed.lastIndexOf(end_of_project);
        if (end < 0) return project;
        const QString text = text_of(part, scene);
        if (!text.isEmpty()) {
            QDomDocument xml;
            QDomElement element = xml.createElement(part.name);
            element.appendChild(xml.createTextNode(text));
            xml.appendChild(element);
            changed.insert(end, xml.toByteArray(1));
        }
        // The new one stands last.
        const QByteArray name = part.name.toUtf8();
        if (changed.count("<" + name + ">") > (text.isEmpty() ? 0 : 1)) remove_element(changed, name);
    }
    return changed;
}

void take_parts(const QByteArray& project, Scene& scene)
{
    QDomDocument xml;
    if (!xml.setContent(project)) return;
    for (const ProjectPart& part : parts()) {
        const QDomElement element = xml.documentElement().firstChildElement(part.name);
        if (element.isNull()) continue;
        try {
            part.take(scene, element.text());
        } catch (...) {
            warn(scene, part, "cannot be read; it is kept when the project is saved");
            scene.setProperty(unread_key(part).constData(), element.text());
        }
    }
}

}  // namespace pcm::host
