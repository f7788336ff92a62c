// What operations that measure share: points in arguments, values as text and JSON, files of measures.
#pragma once

#include "pcm/measure/measure_export.h"
#include "pcm/ops/operation.h"
#include "pcm/point_cloud.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm::ops {

// "x0 y0 z0 x1 y1 z1": throws ArgumentError, naming the argument, unless the numbers are whole points.
std::vector<Vec3d> points_of(const std::vector<double>& numbers, const std::string& called);
// "x0 y0 x1 y1", for what is in plan; the points get this z.
std::vector<Vec3d> plan_points_of(const std::vector<double>& numbers, const std::string& called, double z);

std::optional<CoordinateSystem> system_of(const PointCloud& cloud);
// {"kind", "name", "values": {NAME: {"value", "uncertainty", "unit"}}}; "error" where there are none.
Json json_of(const Measure& measure, const std::string& length_unit);
// Accuracy of its most important number, the one of its label.
Accuracy accuracy_of(const Measure& measure, const std::string& length_unit);
void put_lines(Result& result, const Measure& measure, const std::string& length_unit);

// output, overwrite: files that the measures are written to.
struct MeasureFiles {
    std::vector<std::string> outputs;
    bool overwrite = false;
    void declare(Arguments& arguments);
    // Throws before anything is computed what the names would be refused for.
    void check() const;
    void write(const MeasureList& list, const std::optional<CoordinateSystem>& system) const;
    // What was written: the head's output, `files`, and a line for each.
    void describe(Result& result, const std::string& content = {}) const;
};

}  // namespace pcm::ops
