#include "plugin/edit/view_events.h"

#include "plugin/host/registry.h"
#include "plugin/host/view_camera.h"

#include <meshlab/glarea.h>

#include <QCoreApplication>
#include <QMouseEvent>
#include <QTimer>
#include <QVariantMap>
#include <QWheelEvent>

namespace pcm::host {

namespace {

// Events reach MeshLab's camera while the tool counts as suspended.
class Suspended {
public:
    explicit Suspended(GLArea& view) : view_(view), before_(view.suspendedEditor) { view.suspendedEditor = true; }
    ~Suspended() { view_.suspendedEditor = before_; }
    Suspended(const Suspended&) = delete;
    Suspended& operator=(const Suspended&) = delete;

private:
    GLArea& view_;
    bool before_;
};

}  // namespace

void publish_camera(GLArea& view)
{
    const auto map = map_of(view);
    if (!map) return;
    const Camera& camera = map->camera();
    const auto list = [](const auto& numbers) {
        QVariantList values;
        for (const double number : numbers) values << number;
        return values;
    };
    QVariantMap state;
    state["modelview"] = list(camera.modelview);
    state["projection"] = list(camera.projection);
    state["origin"] = list(camera.origin);
    state["size"] = QVariantList{view.width(), view.height()};
    view.setProperty("pcm_camera", state);
}

std::optional<ViewMap> map_of(const GLArea& view)
{
    auto camera = camera_of(view);
    if (!camera || !const_cast<GLArea&>(view).md()) return std::nullopt;
    if (const auto origin = Registry::instance().origin_of(*const_cast<GLArea&>(view).md())) camera->origin = *origin;
    return ViewMap(*camera, view.devicePixelRatioF());
}

void give_to_camera(GLArea& view, const QEvent& event)
{
    const QCursor cursor = view.cursor();  // MeshLab sets one of its own for the trackball
    {
        const Suspended suspended(view);
        if (event.type() == QEvent::Wheel) {
            QWheelEvent copy(static_cast<const QWheelEvent&>(event));
            QCoreApplication::sendEvent(&view, &copy);
        } else {
            QMouseEvent copy(static_cast<const QMouseEvent&>(event));
            QCoreApplication::sendEvent(&view, &copy);
        }
    }
    view.setCursor(cursor);
}

void keep_unmodified(MeshDocument& document)
{
    if (MeshModel* layer = document.mm())
        QTimer::singleShot(0, &document, [document = &document, id = layer->id(), changed = layer->meshModified()] {
            if (MeshModel* shown = document->getMesh(id)) shown->setMeshModified(changed);
        });
}

}  // namespace pcm::host
