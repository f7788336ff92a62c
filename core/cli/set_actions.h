// What commands do with a set of points: save, extract, classify or delete it.
#pragma once

#include "pcm/cli/attribute_options.h"
#include "pcm/cli/common.h"
#include "pcm/filter/set_points.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm::cli {

// What was done with the points.
struct SetDone {
    std::string what;  // "saved", ...; empty: nothing
    std::string output;
    std::uint64_t changed = 0;
    Outcome outcome;
    std::vector<std::string> notes;
    std::optional<std::int64_t> number = {};  // the class, of what was classified
    std::string subject = {};                 // "class 7 'low point (noise)' given to 2,167 points"
};

// --save-attribute, --extract, --overwrite, --delete, --classify, --class-attribute, -o and --in-place.
class SetActions {
public:
    void add_to(Options& options, const char* group);
    // Throws UsageError for options that do not go together.
    void check(const std::string& tree) const;
    // Throws what filter/set_changes.h and filter/set_points.h throw, and Error(invalid_argument) for a class that is
    // neither an integer nor the name of one.
    SetDone run(const PointSet& set, const Common& common, std::uint64_t memory, unsigned threads) const;

private:
    SetDone change(const PointSet& set, const Common& common, std::uint64_t memory, unsigned threads) const;

    std::string attribute_, extract_;
    bool erase_ = false;
    std::string classify_;
    std::string classes_ = "classification";
    TargetOptions target_;
};

// done, output and points_changed; as JSON and as text.
void put_done(Json& json, const SetDone& done);
void print_done(const SetDone& done);

}  // namespace pcm::cli
