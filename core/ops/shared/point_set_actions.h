// What operations do with a set of points: save, extract, classify or delete it.
#pragma once

#include "pcm/filter/set_changes.h"
#include "pcm/filter/set_points.h"
#include "pcm/ops/operation.h"
#include "pcm/ops/shared/target_arguments.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm::ops {

// What was done with the points.
struct SetDone {
    std::string what;  // "saved", ...; empty: nothing
    std::string output;
    std::uint64_t changed = 0;
    Outcome outcome;
    std::vector<std::string> notes;
    Makes makes = Makes::nothing;
    std::optional<std::int64_t> number = {};  // the class, of what was classified
    std::string subject = {};                 // "class 7 'low point (noise)' given to 2,167 points"
};

// Each throws what filter/set_changes.h and filter/set_points.h throw.
SetDone save_set(const PointSet& set, const std::string& attribute, const SetChangeOptions& options);
SetDone classify_set(const PointSet& set, std::int64_t number, const std::string& attribute,
                     const SetChangeOptions& options);
SetDone delete_set(const PointSet& set, const SetChangeOptions& options);
SetDone extract_set(const PointSet& set, const std::string& output, const ExtractOptions& options);

// save_attribute, extract, overwrite, delete, classify, class_attribute, output and in_place. Dialogs have `extract`
// and `overwrite` alone: the points become the selection there, on which the filters Selected Points work.
class PointSetActions {
public:
    void declare(Arguments& arguments, const std::string& group);
    bool overwrite() const { return target_.overwrite; }
    // Throws ArgumentError for options that do not go together. `needs_action`: --overwrite is of no use without one.
    void check(const std::string& tree, bool needs_action) const;
    // Throws what the functions above throw, and Error(invalid_argument) for a class that is neither an integer nor the
    // name of one.
    SetDone run(const PointSet& set, const Context& context, std::uint64_t memory, unsigned threads) const;

private:
    std::string attribute_, extract_;
    bool erase_ = false;
    std::string classify_;
    std::string classes_ = "classification";
    TargetArguments target_;
};

// done, points_changed and class; the head's output; lines and notes.
void put_done(Result& result, const SetDone& done);
std::vector<ResultKey> with_done_keys(std::vector<ResultKey> keys);

}  // namespace pcm::ops
