// The model of a sixth kind of shape: its row compiles with all columns, and with none of them left out.
#include "pcm/fit/models/shape_models.h"
#include "tests/shapes/row_columns.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

// Only the types of the functions are looked at.
struct Sixth {
    static bool like(const SurfaceBend&, Shape&);
    static Significance significance(const Shape&, const ShapeErrors&);
    static std::size_t solve(const SampledPoint*, Shape*);
    static void distances(const Shape&, const double*, const double*, const double*, std::size_t, double*);
    static SurfacePatch patch_at(const Shape&, const Vec3d&);
    static Shape shape_of(const SurfacePatch&);
    static void differentiate(const SurfacePatch&, const double*, const double*, const double*, std::size_t,
                              PatchBlock&);
    static SurfacePatch moved(const SurfacePatch&, const double*);
};

using Columns = std::tuple<const ShapeTraits&, std::size_t, bool, int, unsigned, std::array<int, most_parameters>,
                           const PclForm*, decltype(&Sixth::like), decltype((Sixth::significance)),
                           decltype((Sixth::solve)), decltype((Sixth::distances)), decltype((Sixth::patch_at)),
                           decltype((Sixth::shape_of)), decltype((Sixth::differentiate)), decltype((Sixth::moved))>;
static_assert(rows::Table<ShapeModel, Columns>::is_whole, "a column of the row is not in this list");
static_assert(rows::Table<ShapeModel, Columns>::optional == 0, "a row compiles without one of its columns");

TEST(SixthModel, EveryKindOfTheListHasAModelOfItsOwn)
{
    for (const ShapeTraits& row : shape_kinds()) {
        EXPECT_EQ(&model_of(row.kind).traits, &row) << row.name;
        EXPECT_LE(model_of(row.kind).parameters(), most_parameters) << row.name;
    }
}

}  // namespace
}  // namespace pcm
