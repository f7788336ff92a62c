#include "plugin/host/annotations.h"

#include "plugin/host/registry.h"

#include <meshlab/glarea.h>

#include <utility>

namespace pcm::host {

Annotations::Annotations(MeshDocument& document) : QObject(&document), document_(document) {}

Annotations& Annotations::of(MeshDocument& document)
{
    auto* found = document.findChild<Annotations*>(QString(), Qt::FindDirectChildrenOnly);
    return found ? *found : *new Annotations(document);
}

void Annotations::set(const QString& owner, std::vector<Annotation> annotations)
{
    if (annotations.empty())
        all_.erase(owner);
    else
        all_[owner] = std::move(annotations);
    repaint_views(document_);
    emit changed();
}

void repaint_views(const MeshDocument& document)
{
    for (GLArea* view : views_of(document)) view->update();
}

}  // namespace pcm::host
