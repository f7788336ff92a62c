#include "plugin/host/view_camera.h"

#include <meshlab/glarea.h>

#include <map>
#include <utility>

namespace pcm::host {

namespace {

struct Picture {
    std::optional<Camera> camera;
    std::optional<ShownClouds> shown;
};

std::map<const QObject*, Picture>& pictures()
{
    static auto* const pictures = new std::map<const QObject*, Picture>;
    return *pictures;
}

const Picture* picture_of(const GLArea& area)
{
    const auto found = pictures().find(&area);
    return found == pictures().end() ? nullptr : &found->second;
}

Picture& kept(GLArea& area)
{
    const auto [place, is_new] = pictures().try_emplace(&area);
    if (is_new)
        QObject::connect(&area, &QObject::destroyed,
                         [key = static_cast<const QObject*>(&area)] { pictures().erase(key); });
    return place->second;
}

}  // namespace

std::optional<Camera> camera_of(const GLArea& area)
{
    const Picture* picture = picture_of(area);
    return picture ? picture->camera : std::nullopt;
}

void keep_camera(GLArea& area, const Camera& camera) { kept(area).camera = camera; }

std::optional<ShownClouds> shown_in(const GLArea& area)
{
    const Picture* picture = picture_of(area);
    return picture ? picture->shown : std::nullopt;
}

void keep_shown(GLArea& area, ShownClouds shown) { kept(area).shown = std::move(shown); }

}  // namespace pcm::host
