#include "plugin/scene/project_camera.h"

#include "plugin/scene/bookmarks.h"
#include "plugin/scene/project_parts.h"
#include "plugin/scene/scene_view.h"

#include <QPointer>
#include <QTimer>

namespace pcm::host {

namespace {

constexpr int camera_wait_ms = 20;

QString camera_text(Scene& scene)
{
    const auto origin = scene.origin();
    const std::vector<SceneView*> views = scene.views();
    if (!origin || views.empty()) return {};
    SceneView* view = views.front();
    for (SceneView* each : views)
        if (each->is_current()) view = each;
    CameraPath path;
    path.name = "view";
    path.frames.push_back(frame_of(*view, *origin));
    path.frames.front().name = "view";
    return QString::fromStdString(path.text());
}

// MeshLab resets the trackball when it has opened a project, and is busy until then.
void look_when_idle(Scene& scene, const CameraFrame& frame)
{
    QTimer::singleShot(camera_wait_ms, &scene, [alive = QPointer<Scene>(&scene), frame] {
        if (!alive) return;
        if (alive->is_busy()) return look_when_idle(*alive, frame);
        const auto origin = alive->origin();
        if (!origin) return;
        for (SceneView* view : alive->views()) look_from(*view, frame, *origin);
    });
}

void take_camera(Scene& scene, const QString& text)
{
    const CameraPath path = CameraPath::of_text(text.toStdString(), "camera of the project");
    if (!path.frames.empty()) look_when_idle(scene, path.frames.front());
}

}  // namespace

void keep_camera_in_projects() { add_project_part({"PointCloudCamera", camera_text, take_camera}); }

}  // namespace pcm::host
