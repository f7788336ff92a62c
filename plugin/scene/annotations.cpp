#include "plugin/scene/annotations.h"

#include <utility>

namespace pcm::host {

Annotations::Annotations(Scene& scene) : QObject(&scene), scene_(scene) {}

void Annotations::set(const QString& owner, std::vector<Annotation> annotations)
{
    if (annotations.empty())
        all_.erase(owner);
    else
        all_[owner] = std::move(annotations);
    scene_.repaint();
    emit changed();
}

}  // namespace pcm::host
