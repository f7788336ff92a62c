#include "plugin/host/vertex_attributes.h"

#include <map>
#include <utility>
#include <vector>

namespace pcm::host {

namespace {

using Layer = std::pair<const MeshDocument*, int>;

// Never destroyed: meshes may outlive every order of static destruction.
std::multimap<Layer, vcg::SimpleTempDataBase*>& living()
{
    static auto* const attributes = new std::multimap<Layer, vcg::SimpleTempDataBase*>;
    return *attributes;
}

}  // namespace

void detail::attribute_born(const MeshModel& layer, vcg::SimpleTempDataBase* attribute)
{
    living().insert({{layer.parent, layer.id()}, attribute});
}

void detail::attribute_died(vcg::SimpleTempDataBase* attribute)
{
    for (auto it = living().begin(); it != living().end(); ++it)
        if (it->second == attribute) {
            living().erase(it);
            return;
        }
}

void clear_vertex_attributes(MeshModel& layer)
{
    for (const vcg::PointerToAttribute& entry : layer.cm.vert_attr)
        delete static_cast<vcg::SimpleTempDataBase*>(entry._handle);
    layer.cm.vert_attr.clear();
}

namespace {

// Attributes take themselves off the list as they die.
template <class Wanted>
void free_those(const Wanted& wanted)
{
    std::vector<vcg::SimpleTempDataBase*> left;
    for (const auto& [layer, attribute] : living())
        if (wanted(layer)) left.push_back(attribute);
    for (vcg::SimpleTempDataBase* attribute : left) delete attribute;
}

}  // namespace

void free_vertex_attributes(const MeshDocument& document, int mesh_id)
{
    free_those([&](const Layer& layer) { return layer == Layer(&document, mesh_id); });
}

void free_vertex_attributes(const MeshDocument& document)
{
    free_those([&](const Layer& layer) { return layer.first == &document; });
}

}  // namespace pcm::host
