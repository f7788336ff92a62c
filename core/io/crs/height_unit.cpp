#include "pcm/io/crs/height_unit.h"

#include "pcm/io/crs/coordinate_system.h"

namespace pcm {

namespace {

std::string short_name(const CrsUnit& unit)
{
    if (!unit.is_known()) return "source units";
    if (unit.name == "metre") return "m";
    if (unit.name == "foot") return "ft";
    return unit.name;
}

}  // namespace

std::string height_unit(const std::vector<Metadata>& metadata)
{
    const auto system = coordinate_system_of(metadata);
    if (!system) return "source units";
    // Heights without a unit of their own have that of a system whose coordinates are lengths.
    const bool is_length = system->kind != CrsKind::geographic && system->kind != CrsKind::unknown;
    return short_name(system->vertical.unit.is_known() || !is_length ? system->vertical.unit : system->horizontal.unit);
}

std::string plan_unit(const std::vector<Metadata>& metadata)
{
    const auto system = coordinate_system_of(metadata);
    return system ? short_name(system->horizontal.unit) : "source units";
}

}  // namespace pcm
