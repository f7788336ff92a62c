#include "plugin/filter/proposed_spacing.h"

#include "pcm/system/round_number.h"

namespace pcm::host {

void propose_spacing(Parameters& parameters, const Scene& scene)
{
    const SceneLayer* const layer = scene.current();
    const auto tree = layer ? layer->tree() : std::nullopt;
    if (!tree) return;
    double finest = 0;  // spacings descend; 0 is all points
    for (const double spacing : tree->cloud->info().spacings)
        if (spacing > 0) finest = spacing;
    if (!(finest > 0)) return;
    for (const Parameter& parameter : parameters)
        if (parameter.is_spacing) parameters.set(parameter.name, static_cast<float>(round_number(finest)));
}

}  // namespace pcm::host
