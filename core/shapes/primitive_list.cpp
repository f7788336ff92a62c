#include "pcm/shapes/primitive_list.h"

#include <algorithm>
#include <array>
#include <unordered_set>
#include <utility>

namespace pcm {

std::size_t PrimitiveList::add(Primitive primitive)
{
    std::vector<Primitive> one;
    one.push_back(std::move(primitive));
    add_all(std::move(one));
    return size() - 1;
}

void PrimitiveList::add_all(std::vector<Primitive> primitives)
{
    if (primitives.empty()) return;
    std::unordered_set<std::string> names;
    for (std::size_t i = 0; i < size(); ++i) names.insert((*this)[i].name);
    for (const Primitive& primitive : primitives) names.insert(primitive.name);
    std::vector<std::size_t> next(shape_kinds().size(), 1);  // the first number of each kind that may be free
    for (Primitive& primitive : primitives) {
        const ShapeKind kind = primitive.fit.shape.kind;
        while (primitive.name.empty()) {
            const std::string number = std::to_string(next[static_cast<std::size_t>(kind)]++);
            const std::string name = std::string(traits_of(kind).label) + " " + number;
            if (names.insert(name).second) primitive.name = name;
        }
    }
    append(std::move(primitives));
}

std::vector<Primitive> PrimitiveList::all() const
{
    std::vector<Primitive> primitives;
    primitives.reserve(size());
    for (std::size_t i = 0; i < size(); ++i) primitives.push_back((*this)[i]);
    return primitives;
}

namespace {

constexpr std::array<std::array<std::uint8_t, 3>, 8> palette{{{255, 200, 0},
                                                              {80, 200, 255},
                                                              {255, 110, 80},
                                                              {120, 220, 90},
                                                              {220, 130, 255},
                                                              {255, 255, 140},
                                                              {70, 230, 200},
                                                              {255, 150, 200}}};

}  // namespace

std::array<std::uint8_t, 3> colour_in_turn(std::size_t number) { return palette[number % palette.size()]; }

std::array<std::uint8_t, 3> next_colour(const PrimitiveList& list)
{
    std::array<std::size_t, palette.size()> used{};
    for (std::size_t i = 0; i < list.size(); ++i)
        for (std::size_t k = 0; k < palette.size(); ++k) used[k] += list[i].colour == palette[k];
    return palette[static_cast<std::size_t>(std::min_element(used.begin(), used.end()) - used.begin())];
}

}  // namespace pcm
