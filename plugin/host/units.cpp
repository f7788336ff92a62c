#include "plugin/host/units.h"

#include "pcm/io/crs/coordinate_system.h"

namespace pcm::host {

std::string height_unit(const std::vector<Metadata>& metadata)
{
    const auto system = coordinate_system_of(metadata);
    if (!system) return "source units";
    // Heights without a unit of their own have that of a projected system.
    const bool is_length = system->kind != CrsKind::geographic && system->kind != CrsKind::unknown;
    const CrsUnit& unit =
        system->vertical.unit.is_known() || !is_length ? system->vertical.unit : system->horizontal.unit;
    if (!unit.is_known()) return "source units";
    if (unit.name == "metre") return "m";
    if (unit.name == "foot") return "ft";
    return unit.name;
}

std::string attribute_unit(const std::string& name)
{
    if (name == "gps_time") return "s";
    if (name == "scan_angle" || name == "scan_angle_rank") return "\u00b0";
    return {};
}

}  // namespace pcm::host
