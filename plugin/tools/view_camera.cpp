#include "plugin/tools/view_camera.h"

#include <QVariantMap>
#include <QWidget>

namespace pcm::host {

void publish_camera(SceneView& view)
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
    state["size"] = QVariantList{view.size().width(), view.size().height()};
    view.widget().setProperty("pcm_camera", state);
}

std::optional<ViewMap> map_of(const SceneView& view)
{
    std::optional<Camera> camera = view.camera();
    if (!camera) return std::nullopt;
    if (const auto origin = view.scene().origin()) camera->origin = *origin;
    return ViewMap(*camera, view.pixel_ratio());
}

}  // namespace pcm::host
