#include "plugin/host/project_camera.h"

#include "plugin/host/bookmarks.h"
#include "plugin/host/project_parts.h"
#include "plugin/host/registry.h"

#include <meshlab/glarea.h>

#include <QPointer>
#include <QTimer>

namespace pcm::host {

namespace {

constexpr int camera_wait_ms = 20;

QString camera_text(MeshDocument& document)
{
    const auto origin = Registry::instance().origin_of(document);
    const std::vector<GLArea*> views = views_of(document);
    if (!origin || views.empty()) return {};
    GLArea* view = views.front();
    for (GLArea* each : views)
        if (each->isCurrent()) view = each;
    CameraPath path;
    path.name = "view";
    path.frames.push_back(frame_of(*view, *origin));
    path.frames.front().name = "view";
    return QString::fromStdString(path.text());
}

// MeshLab resets the trackball when it has opened a project, and is busy until then.
void look_when_idle(MeshDocument& document, const CameraFrame& frame)
{
    QTimer::singleShot(camera_wait_ms, &document, [alive = QPointer<MeshDocument>(&document), frame] {
        if (!alive) return;
        if (alive->isBusy()) return look_when_idle(*alive, frame);
        const auto origin = Registry::instance().origin_of(*alive);
        if (!origin) return;
        for (GLArea* view : views_of(*alive)) look_from(*view, frame, *origin);
    });
}

void take_camera(MeshDocument& document, const QString& text)
{
    const CameraPath path = CameraPath::of_text(text.toStdString(), "camera of the project");
    if (!path.frames.empty()) look_when_idle(document, path.frames.front());
}

}  // namespace

void keep_camera_in_projects() { add_project_part({"PointCloudCamera", camera_text, take_camera}); }

}  // namespace pcm::host
