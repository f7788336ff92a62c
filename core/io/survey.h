// What one pass over a cloud found of its values. Writers choose types, scales and point formats by it, before they
// write a header: whether 8 bits hold all colours, from where to where intensities go, whether floats hold the
// positions.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace pcm {

struct FileInfo;

// What a writer has to know of the values of an attribute.
enum class Question : std::uint8_t {
    none,
    range,         // the minimum and the maximum value: answered at the end of the cloud
    colour_steps,  // whether 8 bits hold them: answered by the first value that they do not hold
    doubles,       // whether doubles hold 64-bit integers: answered by the first that they do not hold
};

struct SurveyQuestions {
    std::vector<Question> attributes;  // in the order of the schema; may be shorter
    bool box = false;                  // asks for the box of the positions
    bool floats = false;               // whether floats hold the positions

    bool any() const;
};

// Raw values of all components of an attribute.
struct ValueSurvey {
    double least = std::numeric_limits<double>::infinity();  // minimum finite value; more than `most` without any
    double most = -std::numeric_limits<double>::infinity();
    bool whole = true;         // all are finite integers
    unsigned colour_step = 0;  // every value is n * colour_step with n = 0..255: 257, 256 or 1; 0: 8 bits hold them not
    bool doubles_hold = false;  // no integer beyond +-2^53

    bool any() const { return least <= most; }
    bool within(double low, double high) const { return !any() || (least >= low && most <= high); }
};

struct Survey {
    std::vector<std::optional<ValueSurvey>> attributes;  // one per attribute; unset where nothing was asked
    Box3d box;                                           // box of the finite positions, if asked
    // Doubles are floats, or a float names the point of the grid (float_names_grid_point), for every coordinate.
    bool floats_hold_positions = false;

    // Null where nothing was asked, or nothing is known.
    const ValueSurvey* of(std::size_t attribute) const
    {
        return attribute < attributes.size() && attributes[attribute] ? &*attributes[attribute] : nullptr;
    }
};

// Whether readers find the point `q` of the grid again from its coordinate, less `shift`, in single precision.
bool float_names_grid_point(const Grid& grid, std::size_t axis, std::int32_t q, double shift);

// The coordinate that was stored as `stored`, a float, less `shift`: that of a point of the grid if the float is the
// one nearest to such a point, else the float's.
double coordinate_of_float(const std::optional<Grid>& grid, std::size_t axis, float stored, double shift);

// Watches batches of the cloud `info`, then answers. One thread.
class Surveyor {
public:
    Surveyor(const FileInfo& info, SurveyQuestions questions);

    void watch(const PointBatch& batch);
    // Whether further points can change an answer.
    bool open() const;
    Survey answers() const;

private:
    struct Watched {
        ValueSurvey values;
        bool steps_of_257 = true, steps_of_256 = true, bytes = true, doubles_hold = true;
    };
    template <class T>
    static void watch(Watched& watched, const T* values, std::size_t count);
    void watch_positions(const PointBatch& batch);

    SurveyQuestions questions_;
    std::optional<Grid> grid_;
    std::vector<std::optional<Watched>> attributes_;
    Box3d box_;
    bool floats_hold_ = true;
};

}  // namespace pcm
