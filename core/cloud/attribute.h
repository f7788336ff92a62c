// Attributes of points: what a cloud carries in addition to its positions.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

enum class ScalarType : std::uint8_t { i8 = 1, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

std::size_t size_of(ScalarType type);
std::string_view name_of(ScalarType type);  // "u16", "f32", ...
bool is_valid(ScalarType type);             // false for a byte read from a file that names no type

// Names with a meaning to the library; any other name is carried through untouched. Types are the source's own.
namespace attribute_name {
inline constexpr std::string_view rgb = "rgb";              // 3 components: u16 (LAS), u8 (PLY), or float 0..1
inline constexpr std::string_view normal = "normal";        // 3 components
inline constexpr std::string_view intensity = "intensity";  // 1 component
inline constexpr std::string_view radius = "radius";        // 1 component, source units
inline constexpr std::string_view classification = "classification";
inline constexpr std::string_view gps_time = "gps_time";
}  // namespace attribute_name

// One attribute: `components` scalars of `type` per point, interleaved. The value a user sees is raw * scale + offset.
struct Attribute {
    std::string name;
    ScalarType type = ScalarType::u8;
    std::uint32_t components = 1;
    double scale = 1.0;
    double offset = 0.0;
    std::string description;

    std::size_t bytes() const { return size_of(type) * components; }
    bool operator==(const Attribute& other) const;
};

inline constexpr std::size_t max_attributes = 256;

// The attributes of a cloud in order; names are unique.
class Schema {
public:
    // Throws Error(invalid_argument) for a repeated or empty name, no components, or more than max_attributes.
    void add(Attribute attribute);

    std::size_t size() const { return attributes_.size(); }
    bool empty() const { return attributes_.empty(); }
    const Attribute& operator[](std::size_t i) const { return attributes_[i]; }
    auto begin() const { return attributes_.begin(); }
    auto end() const { return attributes_.end(); }
    std::optional<std::size_t> find(std::string_view name) const;

    // Bytes of all attributes of one point, without its position.
    std::size_t point_bytes() const;
    bool operator==(const Schema& other) const { return attributes_ == other.attributes_; }
    // Whether its attributes are the first attributes of `other`, or all of them.
    bool is_beginning_of(const Schema& other) const;

private:
    std::vector<Attribute> attributes_;
};

// Which columns of a chunk are needed; the others are neither read nor decoded.
struct ColumnSet {
    bool positions = true;
    bool sizes = false;                      // point sizes (tree/point_size.h); only chunks of trees have them
    std::bitset<max_attributes> attributes;  // one bit per attribute of the schema

    static ColumnSet only_positions() { return {}; }
    // Positions and all attributes.
    static ColumnSet all(const Schema& schema);
    // These and the sizes: what a chunk that is written again needs.
    static ColumnSet whole(const Schema& schema);
    // Positions and the named attributes; names that the schema lacks are ignored.
    static ColumnSet named(const Schema& schema, const std::vector<std::string>& names);

    bool contains(const ColumnSet& other) const
    {
        return (positions || !other.positions) && (sizes || !other.sizes) && (other.attributes & ~attributes).none();
    }
    ColumnSet& operator|=(const ColumnSet& other)
    {
        positions = positions || other.positions;
        sizes = sizes || other.sizes;
        attributes |= other.attributes;
        return *this;
    }
    bool operator==(const ColumnSet& other) const
    {
        return positions == other.positions && sizes == other.sizes && attributes == other.attributes;
    }
};

}  // namespace pcm
