#include "plugin/host/view_camera.h"

#include <meshlab/glarea.h>

#include <map>

namespace pcm::host {

namespace {

std::map<const QObject*, Camera>& cameras()
{
    static auto* const cameras = new std::map<const QObject*, Camera>;
    return *cameras;
}

}  // namespace

std::optional<Camera> camera_of(const GLArea& area)
{
    const auto found = cameras().find(&area);
    if (found == cameras().end()) return std::nullopt;
    return found->second;
}

void keep_camera(GLArea& area, const Camera& camera)
{
    if (cameras().insert_or_assign(&area, camera).second)
        QObject::connect(&area, &QObject::destroyed,
                         [key = static_cast<const QObject*>(&area)] { cameras().erase(key); });
}

}  // namespace pcm::host
