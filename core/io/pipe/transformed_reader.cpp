#include "pcm/io/pipe/transformed_reader.h"

#include "pcm/cloud/attribute_length.h"
#include "pcm/cloud/vector.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

template <class T>
void turn(Column& column, const std::array<Vec3d, 3>& by)
{
    T* values = column.as<T>();
    for (std::size_t i = 0; i < column.size(); ++i, values += 3) {
        const Vec3d n{static_cast<double>(values[0]), static_cast<double>(values[1]), static_cast<double>(values[2])};
        Vec3d turned;
        for (std::size_t a = 0; a < 3; ++a) turned[a] = dot(by[a], n);
        const double before = length(n), now = length(turned);
        if (!(now > 0)) continue;  // no direction to keep
        for (std::size_t a = 0; a < 3; ++a) values[a] = static_cast<T>(turned[a] * (before / now));
    }
}

template <class T>
void stretch(Column& column, std::size_t components, double by)
{
    T* const values = column.as<T>();
    const std::size_t count = column.size() * components;
    for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<T>(static_cast<double>(values[i]) * by);
}

}  // namespace

TransformedReader::TransformedReader(std::unique_ptr<PointReader> cloud, const Affine& map)
    : cloud_(std::move(cloud)), map_(map)
{
    const auto& m = map_.linear;
    bool finite = true, stretches = true;
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        finite = finite && std::isfinite(map_.pivot[i]) && std::isfinite(map_.target[i]);
        for (std::size_t j = 0; j < 3; ++j) {
            finite = finite && std::isfinite(m[i][j]);
            most = std::max(most, std::fabs(m[i][j]));
            stretches = stretches && (i == j ? m[i][j] > 0 : m[i][j] == 0);
        }
    }
    if (!finite) throw Error(ErrorCode::invalid_argument, {}, "a transformation has NaN or infinite numbers");
    take_turn(most > 0 ? std::exp2(std::floor(std::log2(most))) : 1);
    const FileInfo& info = cloud_->info();
    if (const auto system = coordinate_system_of(info.metadata))
        system_note_ = "the coordinate system stated is still " + describe(*system) +
                       ": it no longer fits, unless the transformation was within it";
    if (info.grid && stretches) {
        grid_ = *info.grid;
        for (std::size_t a = 0; a < 3; ++a) {
            grid_->scale[a] = info.grid->scale[a] * m[a][a];
            grid_->offset[a] = m[a][a] * (info.grid->offset[a] - map_.pivot[a]) + map_.target[a];
        }
    }
}

// `unit` is of the size of the largest element, so that the determinant of a scale of 1e-200 is not 0, nor that of
// 1e200 infinite.
void TransformedReader::take_turn(double unit)
{
    std::array<Vec3d, 3> m;
    double volume = 1;  // volume of a box with the rows' lengths
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) m[i][j] = map_.linear[i][j] / unit;
        volume *= length(m[i]);
    }
    const double determinant = dot(m[0], cross(m[1], m[2]));
    if (std::fabs(determinant) <= 1e-12 * volume)
        throw Error(ErrorCode::invalid_argument, {},
                    "a transformation flattens the cloud: its determinant is " + exact(map_.determinant()),
                    "give one with a determinant other than 0");
    // Cofactors over the determinant are the inverse transpose; the normal keeps its length.
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t r1 = (i + 1) % 3, r2 = (i + 2) % 3, c1 = (j + 1) % 3, c2 = (j + 2) % 3;
            of_normals_[i][j] = (m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]) / determinant;
        }
    of_lengths_ = std::cbrt(std::fabs(determinant)) * unit;
}

// Numbers that are stored as they are shown are multiplied; all others keep their raw values, exactly.
TransformedReader::Growth TransformedReader::growth_of(const Attribute& attribute) const
{
    Growth growth;
    const int power = length_power(attribute);
    if (power != 0) growth.factor = std::pow(of_lengths_, power);
    const bool floats = attribute.type == ScalarType::f32 || attribute.type == ScalarType::f64;
    growth.by_scale = !floats || attribute.offset != 0;
    return growth;
}

const FileInfo& TransformedReader::info() const
{
    info_ = cloud_->info();
    info_.grid = grid_;
    info_.near_grid.reset();
    info_.promised_box.reset();
    if (!grid_) info_.position_type = ScalarType::f64;
    Schema schema;
    for (Attribute attribute : info_.schema) {
        const Growth growth = growth_of(attribute);
        if (growth.by_scale && growth.factor != 1) {
            attribute.scale *= growth.factor;
            attribute.offset *= growth.factor;
        }
        schema.add(std::move(attribute));
    }
    info_.schema = std::move(schema);
    if (!system_note_.empty()) info_.notes.push_back(system_note_);
    return info_;
}

bool TransformedReader::read(PointBatch& batch, std::size_t max_points)
{
    const FileInfo& info = cloud_->info();
    const std::optional<Grid> grid = info.grid;
    const Schema schema = info.schema;
    if (grid_) {
        if (!cloud_->read(batch, max_points)) return false;
    } else {
        const bool more = cloud_->read(from_, max_points);
        shape_batch(batch, schema, false, from_.size);
        if (!more) return false;
        for (std::size_t i = 0; i < from_.size; ++i) {
            Vec3d p;
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = from_.gridded ? grid->to_source(from_.grid_xyz[a][i], a) : from_.xyz[a][i];
            p = map_(p);
            for (std::size_t a = 0; a < 3; ++a) batch.xyz[a][i] = p[a];
        }
        std::swap(batch.attributes, from_.attributes);
    }
    for (std::size_t k = 0; k < schema.size(); ++k) {
        const Attribute& attribute = schema[k];
        const bool floats = attribute.type == ScalarType::f32, doubles = attribute.type == ScalarType::f64;
        if (attribute.name == attribute_name::normal && attribute.components == 3) {
            if (floats) turn<float>(batch.attributes[k], of_normals_);
            if (doubles) turn<double>(batch.attributes[k], of_normals_);
        }
        const Growth growth = growth_of(attribute);
        if (growth.by_scale || growth.factor == 1) continue;
        if (floats) stretch<float>(batch.attributes[k], attribute.components, growth.factor);
        if (doubles) stretch<double>(batch.attributes[k], attribute.components, growth.factor);
    }
    return true;
}

}  // namespace pcm
