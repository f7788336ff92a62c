#include "pcm/io/survey.h"

#include "pcm/cloud/nearest_float.h"
#include "pcm/cloud/with_type.h"
#include "pcm/io/pipe/grid_choice.h"
#include "pcm/io/reader.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace pcm {

bool SurveyQuestions::any() const
{
    return box || floats ||
           std::any_of(attributes.begin(), attributes.end(), [](Question q) { return q != Question::none; });
}

bool float_names_grid_point(const Grid& grid, std::size_t axis, std::int32_t q, double shift)
{
    const double v = grid.to_source(q, axis);
    const double stored = nearest_float(v - shift);
    // A quarter of a step: readers that know no grid must not take one point for the next either.
    return std::fabs(stored + shift - v) <= grid.scale[axis] / 4 && nearest_on_grid(grid, axis, stored + shift) == q;
}

double coordinate_of_float(const std::optional<Grid>& grid, std::size_t axis, float stored, double shift)
{
    const double plain = static_cast<double>(stored) + shift;
    if (!grid || !std::isfinite(plain)) return plain;
    const double v = grid->to_source(nearest_on_grid(*grid, axis, plain), axis);
    return nearest_float(v - shift) == static_cast<double>(stored) ? v : plain;
}

Surveyor::Surveyor(const FileInfo& info, SurveyQuestions questions) : questions_(std::move(questions)), grid_(info.grid)
{
    questions_.attributes.resize(info.schema.size(), Question::none);
    for (const Question question : questions_.attributes) {
        attributes_.emplace_back();
        if (question != Question::none) attributes_.back().emplace();
    }
}

template <class T>
void Surveyor::watch(Watched& watched, const T* values, std::size_t count)
{
    ValueSurvey& found = watched.values;
    double least = found.least, most = found.most;
    for (std::size_t i = 0; i < count; ++i) {
        const auto v = static_cast<double>(values[i]);
        if constexpr (std::is_floating_point_v<T>) {
            found.whole = found.whole && v == std::nearbyint(v) && std::isfinite(v);
            if (!std::isfinite(v)) continue;
        }
        least = v < least ? v : least;
        most = v > most ? v : most;
    }
    found.least = least;
    found.most = most;
    if constexpr (!std::is_floating_point_v<T> && sizeof(T) == 8) {
        constexpr double limit = 9007199254740992.0;  // 2^53; numbers beyond may be rounded to it
        watched.doubles_hold = watched.doubles_hold && !(least <= -limit) && !(most >= limit);
    }
    if constexpr (std::is_same_v<T, std::uint16_t>) {
        unsigned low = 0, high = 0, unlike = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const unsigned v = values[i];
            low |= v & 255u;
            high |= v >> 8;
            unlike |= (v & 255u) ^ (v >> 8);
        }
        watched.steps_of_257 = watched.steps_of_257 && unlike == 0;
        watched.steps_of_256 = watched.steps_of_256 && low == 0;
        watched.bytes = watched.bytes && high == 0;
    }
}

void Surveyor::watch_positions(const PointBatch& batch)
{
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t i = 0; i < batch.size; ++i) {
            const double v = batch.gridded ? grid_->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i];
            if (!std::isfinite(v)) continue;
            box_.min[a] = std::min(box_.min[a], v);
            box_.max[a] = std::max(box_.max[a], v);
            if (!questions_.floats || !floats_hold_) continue;
            floats_hold_ =
                batch.gridded ? float_names_grid_point(*grid_, a, batch.grid_xyz[a][i], 0) : nearest_float(v) == v;
            if (!floats_hold_ && !questions_.box) return;
        }
}

void Surveyor::watch(const PointBatch& batch)
{
    for (std::size_t k = 0; k < attributes_.size(); ++k) {
        if (!attributes_[k]) continue;
        const Column& column = batch.attributes[k];
        with_type(column.type(), [&](auto zero) {
            watch(*attributes_[k], column.as<decltype(zero)>(), batch.size * column.components());
        });
    }
    if (questions_.box || (questions_.floats && floats_hold_)) watch_positions(batch);
}

bool Surveyor::open() const
{
    if (questions_.box || (questions_.floats && floats_hold_)) return true;
    for (std::size_t k = 0; k < attributes_.size(); ++k) {
        if (!attributes_[k]) continue;
        const Watched& watched = *attributes_[k];
        if (questions_.attributes[k] == Question::range) return true;
        if (questions_.attributes[k] == Question::doubles && watched.doubles_hold) return true;
        if (questions_.attributes[k] == Question::colour_steps &&
            (watched.steps_of_257 || watched.steps_of_256 || watched.bytes))
            return true;
    }
    return false;
}

Survey Surveyor::answers() const
{
    Survey survey;
    survey.box = box_;
    survey.floats_hold_positions = questions_.floats && floats_hold_;
    for (const auto& watched : attributes_) {
        survey.attributes.emplace_back();
        if (!watched) continue;
        survey.attributes.back() = watched->values;
        survey.attributes.back()->doubles_hold = watched->doubles_hold;
        survey.attributes.back()->colour_step = watched->steps_of_257   ? 257
                                                : watched->steps_of_256 ? 256
                                                : watched->bytes        ? 1
                                                                        : 0;
    }
    return survey;
}

}  // namespace pcm
