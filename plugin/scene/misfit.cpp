#include "plugin/scene/misfit.h"

#include "pcm/cloud/vector.h"
#include "pcm/io/crs/coordinate_system.h"
#include "plugin/scene/origin.h"
#include "plugin/scene/scene_view.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

}  // namespace

bool rounds_visibly(const Box3d& box, const Vec3d& origin)
{
    // A screen resolves some thousand steps of a cloud, and a user comes ten times closer.
    constexpr double fewest_steps = 65536;
    const double rounding = float_rounding(box, origin);
    return rounding * fewest_steps > box.diagonal() && rounding > 8 * float_rounding(box, choose_origin(box));
}

std::vector<Misfit> misfits(const SceneLayer& layer, const std::vector<Metadata>& metadata,
                            const std::optional<Box3d>& box)
{
    std::vector<Misfit> found;
    const auto system = coordinate_system_of(metadata);
    bool others = false;
    for (const SceneLayer* other : layer.scene().layers()) {
        const std::vector<Metadata>* const known = other == &layer ? nullptr : other->metadata();
        if (!known) continue;
        others = true;
        const auto other_system = system && found.empty() ? coordinate_system_of(*known) : std::nullopt;
        if (!other_system || compare(*system, *other_system) != CrsRelation::different) continue;
        found.push_back({Misfit::Kind::system, "Its coordinate system is " + describe(*system) +
                                                   "; that of the layer '" + other->label().toStdString() + "' is " +
                                                   describe(*other_system) +
                                                   ". Both are shown with their own numbers, so they do not lie where "
                                                   "they belong."});
    }
    const auto origin = layer.scene().origin();
    if (others && origin && box && !box->empty() && rounds_visibly(*box, *origin)) {
        const Vec3d centre = box->centre();
        const double distance =
            length(Vec3d{centre[0] - (*origin)[0], centre[1] - (*origin)[1], centre[2] - (*origin)[2]});
        found.push_back({Misfit::Kind::distance,
                         "It lies " + brief(distance) + " units from the origin of the other clouds, " +
                             exact(*origin) + ". MeshLab's coordinates are float: its positions are rounded to " +
                             brief(float_rounding(*box, *origin)) +
                             " units, and a view of everything shows hardly anything. In a new project it is sharp."});
    }
    return found;
}

}  // namespace pcm::host
