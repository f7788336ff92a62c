#include "plugin/scene/length_unit.h"

#include "plugin/scene/project_unit.h"
#include "plugin/scene/scene_view.h"

#include <cmath>
#include <vector>

namespace pcm::host {

namespace {

bool same_unit(const CrsUnit& a, const CrsUnit& b)
{
    return std::abs(a.per_unit - b.per_unit) <= 1e-9 * std::abs(a.per_unit);
}

std::string symbol_of(const CrsUnit& unit)
{
    constexpr double foot = 0.3048, survey_foot = 1200.0 / 3937.0;
    if (!unit.is_known()) return {};
    if (same_unit(unit, {{}, 1})) return "m";
    if (same_unit(unit, {{}, foot})) return "ft";
    if (same_unit(unit, {{}, survey_foot})) return "ftUS";
    return unit.name;
}

}  // namespace

LengthUnit common_unit(const std::vector<CoordinateSystem>& systems)
{
    LengthUnit found;
    if (systems.empty()) return found;
    const CoordinateSystem& first = systems.front();
    for (const CoordinateSystem& other : systems)
        if (compare(first, other) == CrsRelation::different) {
            found.warning =
                "The layers state different coordinate systems: a measure between two of them means nothing.";
            return found;
        }
    found.system = first;
    if (first.kind == CrsKind::geographic) {
        found.warning = "The coordinates are degrees: lengths, areas and angles of them mean nothing.";
        return found;
    }
    found.symbol = symbol_of(first.horizontal.unit);
    const CrsUnit &plan = first.horizontal.unit, &up = first.vertical.unit;
    if (plan.is_known() && up.is_known() && !same_unit(plan, up)) {
        found.symbol.clear();
        found.warning = QString(
                            "Heights are in %1, but x and y in %2: only measures in plan or along the height mean "
                            "what they say.")
                            .arg(QString::fromStdString(up.name), QString::fromStdString(plan.name));
    }
    return found;
}

LengthUnit length_unit_of(const Scene& scene)
{
    std::vector<CoordinateSystem> systems;
    for (const SceneLayer* layer : scene.layers()) {
        const std::vector<Metadata>* const stated = layer->metadata();
        const auto system = stated ? coordinate_system_of(*stated) : std::nullopt;
        if (system) systems.push_back(*system);
    }
    LengthUnit unit = common_unit(systems);
    unit.is_stated = !unit.symbol.empty() || !unit.warning.isEmpty();
    if (!unit.is_stated) unit.symbol = chosen_unit(scene).value_or("");
    return unit;
}

}  // namespace pcm::host
