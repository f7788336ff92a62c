#include "pcm/io/e57/e57_fields.h"

#include "pcm/io/file_text.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <bitset>
#include <limits>
#include <map>
#include <string_view>

namespace pcm {
namespace {

using Trio = std::array<std::size_t, 3>;

std::string snake_case(std::string_view name)
{
    std::string text;
    for (const char c : name) {
        const bool upper = c >= 'A' && c <= 'Z';
        if (upper && !text.empty()) text += '_';
        text += upper ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return text;
}

// Facts found so far about the values of an attribute.
struct Kind {
    enum class Number { integer, f32, f64 } number = Number::f64;
    std::int64_t min = 0, max = 0;  // range of integers
    double scale = 1, offset = 0;   // scaling of integers
};

Kind kind_of(const E57Field& field)
{
    if (field.kind == E57Field::Kind::f32) return {Kind::Number::f32};
    if (field.kind == E57Field::Kind::f64) return {Kind::Number::f64};
    // The bits of a value may hold more than the declared maximum.
    constexpr std::int64_t highest = std::numeric_limits<std::int64_t>::max();
    const unsigned bits = field.bits();
    const std::uint64_t span = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    const std::uint64_t room = static_cast<std::uint64_t>(highest) - static_cast<std::uint64_t>(field.min);
    const std::int64_t max =
        span > room ? highest : static_cast<std::int64_t>(static_cast<std::uint64_t>(field.min) + span);
    return {Kind::Number::integer, field.min, max, field.scale, field.offset};
}

Kind both(const Kind& a, const Kind& b)
{
    using Number = Kind::Number;
    if (a.number == Number::f32 && b.number == Number::f32) return a;
    if (a.number != Number::integer || b.number != Number::integer || a.scale != b.scale || a.offset != b.offset)
        return {Number::f64};
    return {Number::integer, std::min(a.min, b.min), std::max(a.max, b.max), a.scale, a.offset};
}

ScalarType type_of(const Kind& kind)
{
    if (kind.number == Kind::Number::f32) return ScalarType::f32;
    if (kind.number == Kind::Number::f64) return ScalarType::f64;
    const auto holds = [&](std::int64_t low, std::int64_t high) { return kind.min >= low && kind.max <= high; };
    return holds(0, 255)                    ? ScalarType::u8
           : holds(-128, 127)               ? ScalarType::i8
           : holds(0, 65535)                ? ScalarType::u16
           : holds(-32768, 32767)           ? ScalarType::i16
           : holds(0, 4294967295)           ? ScalarType::u32
           : holds(-2147483648, 2147483647) ? ScalarType::i32
                                            : ScalarType::i64;
}

// How the colours of a scan are encoded.
struct Colours {
    enum class Number { u8, u16, f32, f64 } number = Number::u8;
    double largest = 255;  // the value of white
};

Colours colours_of(const E57Scan& scan, const Trio& rgb)
{
    using Number = Colours::Number;
    bool integers = true, single = true;
    std::int64_t max = 0;
    for (const std::size_t i : rgb) {
        const E57Field& field = scan.fields[i];
        integers = integers && field.kind == E57Field::Kind::integer && !field.scaled();
        single = single && field.kind == E57Field::Kind::f32;
        max = std::max(max, field.max);
    }
    const double limit = scan.colour_limit.value_or(0);
    if (integers) {
        const bool wide = limit > 0 ? limit > 255 : max > 255;
        if (limit > 65535 || (limit <= 0 && max > 65535 && max < std::numeric_limits<std::int64_t>::max()))
            return {Number::f64, limit > 0 ? limit : static_cast<double>(max)};
        return {wide ? Number::u16 : Number::u8, wide ? 65535.0 : 255.0};
    }
    const double largest = limit <= 1 ? 1 : limit <= 255 ? 255 : limit <= 65535 ? 65535 : limit;
    return {single ? Number::f32 : Number::f64, largest};
}

// The name of the attribute for a field.
std::string name_of(const E57Field& field)
{
    if (field.space.empty()) {
        if (field.name == "returnCount") return "number_of_returns";
        static constexpr const char* standard[] = {
            "intensity",          "isIntensityInvalid",    "colorRed",       "colorGreen",
            "colorBlue",          "isColorInvalid",        "rowIndex",       "columnIndex",
            "timeStamp",          "isTimeStampInvalid",    "cartesianX",     "cartesianY",
            "cartesianZ",         "cartesianInvalidState", "sphericalRange", "sphericalAzimuth",
            "sphericalElevation", "sphericalInvalidState", "returnIndex"};
        for (const char* name : standard)
            if (field.name == name) return snake_case(field.name);
    }
    const std::string name = printable_name(field.space.empty() ? field.name : field.space + ":" + field.name);
    if (field.space == "las") return snake_case(printable_name(field.name));
    return name.empty() ? "unnamed" : name;
}

class Planner {
public:
    Planner(const std::filesystem::path& path, const std::vector<E57Scan>& scans) : path_(path), scans_(scans) {}
    E57Plan plan();

private:
    struct Member {  // one scan's field of an attribute
        std::size_t scan, field;
        std::uint32_t component;
    };
    struct Merged {
        std::string name;
        std::uint32_t components = 1;
        std::vector<Member> members;
    };

    static std::optional<Trio> trio(const E57Scan& scan, const std::array<const char*, 3>& names,
                                    bool extension = false);
    void find_positions(std::size_t scan);
    void add_fields(std::size_t scan);
    void add_member(const std::string& name, std::uint32_t components, const Member& member);
    void make_attribute(const Merged& merged);
    void make_colours();
    void add_attribute(Attribute attribute);

    const std::filesystem::path& path_;
    const std::vector<E57Scan>& scans_;
    E57Plan plan_;
    std::vector<Merged> merged_;
    std::map<std::string, std::size_t> merged_of_;       // keyed by name
    std::map<std::string, int> component_numbers_;       // for the current scan: the next number to try for a free name
    std::vector<std::pair<std::size_t, Trio>> colours_;  // scan and fields
    std::size_t rgb_place_ = 0;                          // position among the attributes
};

std::optional<Trio> Planner::trio(const E57Scan& scan, const std::array<const char*, 3>& names, bool extension)
{
    Trio found{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto field = std::find_if(scan.fields.begin(), scan.fields.end(), [&](const E57Field& f) {
            return f.space.empty() != extension && f.name == names[k];
        });
        if (field == scan.fields.end()) return std::nullopt;
        found[k] = static_cast<std::size_t>(field - scan.fields.begin());
    }
    return found;
}

void Planner::find_positions(std::size_t index)
{
    const E57Scan& scan = scans_[index];
    E57ScanPlan& plan = plan_.scans[index];
    plan.cartesian = trio(scan, {"cartesianX", "cartesianY", "cartesianZ"});
    plan.spherical = trio(scan, {"sphericalRange", "sphericalAzimuth", "sphericalElevation"});
    if (plan.cartesian) plan.cartesian_state = scan.find("cartesianInvalidState");
    if (plan.spherical) plan.spherical_state = scan.find("sphericalInvalidState");
    if (scan.records && !plan.cartesian && !plan.spherical)
        throw Error(ErrorCode::bad_format, path_,
                    scan.called(index) + " has " + std::to_string(scan.records) +
                        " points without three cartesian or three spherical coordinates");
}

void Planner::add_member(const std::string& name, std::uint32_t components, const Member& member)
{
    // A name that exists with another number of components, or twice in one scan, gets a number. The last number tried
    // in this scan is kept, because a file may have thousands of fields of one name.
    int& number = component_numbers_[name + '/' + std::to_string(member.component)];
    for (;; ++number) {
        const std::string candidate = number == 0 ? name : name + "_" + std::to_string(number + 1);
        const auto same = merged_of_.find(candidate);
        if (same == merged_of_.end()) {
            if (merged_.size() >= max_attributes)
                throw Error(ErrorCode::unsupported, path_,
                            "the points have more than " + std::to_string(max_attributes) + " attributes");
            merged_of_.emplace(candidate, merged_.size());
            merged_.push_back({candidate, components, {member}});
            return;
        }
        Merged& merged = merged_[same->second];
        bool taken = false;  // members are in the order of their scans
        for (auto m = merged.members.rbegin(); m != merged.members.rend() && m->scan == member.scan; ++m)
            taken = taken || m->component == member.component;
        if (merged.components == components && !taken) {
            merged.members.push_back(member);
            return;
        }
    }
}

void Planner::add_fields(std::size_t index)
{
    const E57Scan& scan = scans_[index];
    const E57ScanPlan& plan = plan_.scans[index];
    component_numbers_.clear();
    std::vector<bool> done(scan.fields.size());
    const auto take = [&](const std::optional<Trio>& fields) {
        if (fields)
            for (const std::size_t i : *fields) done[i] = true;
    };
    // Where there are cartesian coordinates, spherical ones are attributes.
    take(plan.cartesian ? plan.cartesian : plan.spherical);
    if (plan.cartesian_state) done[*plan.cartesian_state] = true;
    if (plan.spherical_state && !plan.cartesian) done[*plan.spherical_state] = true;

    const auto rgb = trio(scan, {"colorRed", "colorGreen", "colorBlue"});
    if (rgb) colours_.emplace_back(index, *rgb);
    take(rgb);
    if (const auto normal = trio(scan, {"normalX", "normalY", "normalZ"}, true)) {
        for (std::uint32_t k = 0; k < 3; ++k)
            add_member(std::string(attribute_name::normal), 3, {index, (*normal)[k], k});
        take(normal);
    }
    for (std::size_t i = 0; i < scan.fields.size(); ++i) {
        if (rgb && colours_.size() == 1 && i == (*rgb)[0]) rgb_place_ = merged_.size();
        if (done[i]) continue;
        std::string name = name_of(scan.fields[i]);
        if (name == attribute_name::rgb || name == attribute_name::normal || name == "scan")
            name += "_scalar";  // these names have another meaning here
        add_member(name, 1, {index, i, 0});
    }
}

void Planner::add_attribute(Attribute attribute)
{
    if (plan_.schema.size() == max_attributes)
        throw Error(ErrorCode::unsupported, path_,
                    "the points have more than " + std::to_string(max_attributes) + " attributes");
    plan_.schema.add(std::move(attribute));
}

void Planner::make_attribute(const Merged& merged)
{
    const auto field_of = [&](const Member& member) -> const E57Field& {
        return scans_[member.scan].fields[member.field];
    };
    Kind kind = kind_of(field_of(merged.members[0]));
    bool differ = false;
    for (const Member& member : merged.members) {
        const Kind other = kind_of(field_of(member));
        differ = differ || other.number != kind.number || other.scale != kind.scale || other.offset != kind.offset;
        kind = both(kind, other);
    }
    if (differ && merged.components == 1)
        plan_.notes.push_back("'" + merged.name +
                              "' has different number types or scales in the scans: read as doubles");
    const ScalarType type = type_of(kind);
    for (const Member& member : merged.members) {
        E57Target target;
        target.field = member.field;
        target.attribute = plan_.schema.size();
        target.component = member.component;
        plan_.scans[member.scan].targets.push_back(target);
    }
    add_attribute({merged.name, type, merged.components, kind.scale, kind.offset, {}});
}

void Planner::make_colours()
{
    using Number = Colours::Number;
    Number number = Number::u8;
    bool differ = false;
    for (const auto& [scan, fields] : colours_) {
        const Number other = colours_of(scans_[scan], fields).number;
        differ = differ || other != colours_of(scans_[colours_[0].first], colours_[0].second).number;
        // After a division a float could not distinguish all 16-bit values.
        number = (number == Number::u16 && other == Number::f32) || (number == Number::f32 && other == Number::u16)
                     ? Number::f64
                     : std::max(number, other);
    }
    if (differ)
        plan_.notes.push_back(number == Number::u16
                                  ? "the scans have 8-bit and 16-bit colours: all were converted to 16 bits"
                                  : "the scans have colours of different types: all were converted to 0..1");
    std::vector<double> odd;
    for (const auto& [scan, fields] : colours_) {
        const Colours colours = colours_of(scans_[scan], fields);
        for (std::uint32_t k = 0; k < 3; ++k) {
            E57Target target;
            target.field = fields[k];
            target.attribute = plan_.schema.size();
            target.component = k;
            target.widened = number == Number::u16 && colours.number == Number::u8;
            target.factor = 1 / colours.largest;
            plan_.scans[scan].targets.push_back(target);
        }
        const bool divided = number == Number::f32 || number == Number::f64;
        if (divided && colours.largest != 1 && std::find(odd.begin(), odd.end(), colours.largest) == odd.end()) {
            odd.push_back(colours.largest);
            plan_.notes.push_back("colours were divided by their maximum, " + exact(colours.largest));
        }
    }
    const ScalarType type = number == Number::u8    ? ScalarType::u8
                            : number == Number::u16 ? ScalarType::u16
                            : number == Number::f32 ? ScalarType::f32
                                                    : ScalarType::f64;
    add_attribute({std::string(attribute_name::rgb), type, 3, 1, 0, {}});
}

E57Plan Planner::plan()
{
    plan_.scans.resize(scans_.size());
    std::size_t read = 0;
    for (std::size_t i = 0; i < scans_.size(); ++i) {
        find_positions(i);
        add_fields(i);
        read += scans_[i].records > 0;
    }
    for (std::size_t i = 0; i < merged_.size(); ++i) {
        if (!colours_.empty() && i == rgb_place_) make_colours();
        make_attribute(merged_[i]);
    }
    if (!colours_.empty() && rgb_place_ >= merged_.size()) make_colours();
    std::vector<std::size_t> scans_with(plan_.schema.size());
    for (std::size_t i = 0; i < scans_.size(); ++i) {
        std::bitset<max_attributes> has;
        for (const E57Target& target : plan_.scans[i].targets) has.set(target.attribute);
        for (std::size_t a = 0; scans_[i].records && a < plan_.schema.size(); ++a) scans_with[a] += has[a];
    }
    for (std::size_t a = 0; a < plan_.schema.size(); ++a)
        if (scans_with[a] < read)
            plan_.notes.push_back(grouped(read - scans_with[a]) + " of " + grouped(read) + " scans have no '" +
                                  plan_.schema[a].name + "': it is 0 for their points");
    if (scans_.size() > 1) {
        plan_.scan_number = plan_.schema.size();
        add_attribute({"scan", ScalarType::u32, 1, 1, 0, "number of the scan in the file, from 1"});
    }
    return std::move(plan_);
}

}  // namespace

E57Plan plan_e57(const std::filesystem::path& path, const std::vector<E57Scan>& scans)
{
    return Planner(path, scans).plan();
}

}  // namespace pcm
