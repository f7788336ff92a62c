#include "pcm/io/crs/crs_units.h"

#include "pcm/cloud/numbers.h"
#include "pcm/io/file_text.h"

#include <cmath>

namespace pcm {
namespace {

struct KnownUnit {
    unsigned code;
    const char* name;
    double per_unit;
    bool angular;
};

// The EPSG register's units that surveys use.
constexpr KnownUnit known_units[] = {
    {9001, "metre", 1, false},
    {9002, "foot", 0.3048, false},
    {9003, "US survey foot", 1200.0 / 3937.0, false},
    {9005, "Clarke's foot", 0.3047972654, false},
    {9014, "fathom", 1.8288, false},
    {9030, "nautical mile", 1852, false},
    {9036, "kilometre", 1000, false},
    {9037, "Clarke's yard", 0.9143917962, false},
    {9041, "British foot (Sears 1922)", 0.3047994715386762, false},
    {9080, "Indian foot", 0.3047995102481469, false},
    {9084, "Indian yard", 0.9143985307444408, false},
    {9093, "statute mile", 1609.344, false},
    {9095, "British foot (1936)", 0.3048007491, false},
    {9096, "yard", 0.9144, false},
    {1025, "millimetre", 0.001, false},
    {1033, "centimetre", 0.01, false},
    {9101, "radian", 1, true},
    {9102, "degree", degree, true},
    {9103, "arc-minute", degree / 60, true},
    {9104, "arc-second", degree / 3600, true},
    {9105, "grad", 0.015707963267948967, true},
    {9106, "gon", 0.015707963267948967, true},
    {9122, "degree", degree, true},
};

// Decimal text has six digits or more; the two feet differ by two millionths.
bool equal(double a, double b) { return std::fabs(a - b) <= 2e-7 * std::fabs(a); }

CrsUnit unit_of(std::string_view name, double per_unit, bool angular)
{
    if (!std::isfinite(per_unit) || per_unit <= 0) return {};
    for (const KnownUnit& known : known_units)
        if (known.angular == angular && equal(known.per_unit, per_unit)) return {known.name, known.per_unit};
    return {printable_name(name), per_unit};
}

}  // namespace

CrsUnit unit_of_code(unsigned code)
{
    for (const KnownUnit& known : known_units)
        if (known.code == code) return {known.name, known.per_unit};
    return {};
}

CrsUnit linear_unit(std::string_view name, double metres) { return unit_of(name, metres, false); }

CrsUnit angular_unit(std::string_view name, double radians) { return unit_of(name, radians, true); }

bool differ(const CrsUnit& a, const CrsUnit& b)
{
    return a.is_known() && b.is_known() && !equal(a.per_unit, b.per_unit);
}

}  // namespace pcm
