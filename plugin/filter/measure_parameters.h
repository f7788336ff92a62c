// Parameters that the filters which measure have in common, and what they write.
#pragma once

#include "pcm/measure/measure_export.h"
#include "pcm/point_cloud.h"
#include "plugin/filter/filter.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// "x y z x y z ...", `size` coordinates a point (2: z is `z`), separated by blanks, commas or semicolons. Throws
// Error(invalid_argument), naming the label; empty text gives no points.
std::vector<Vec3d> points_parameter(const RichParameterList& parameters, const char* name, const char* label,
                                    std::size_t size, double z = 0);

// "OutputFile" and "Overwrite". `formats`: the extensions and what they are, for the tooltip.
void add_output_file_parameters(RichParameterList& parameters, const QString& formats);
// Empty where no file is wanted.
std::filesystem::path output_file_of(const RichParameterList& parameters);
bool overwrite_of(const RichParameterList& parameters);

// "Level" and "Where".
void add_part_parameters(RichParameterList& parameters);
// Throws Error(invalid_argument) for a level that the cloud does not have.
std::optional<std::uint16_t> level_of(const RichParameterList& parameters, const PointCloud& cloud);
std::vector<Condition> where_of(const RichParameterList& parameters);

// Name, kind and values of a measure.
void log_measure(const FilterRun& run, const Measure& measure, const std::string& length_unit);

}  // namespace pcm::host
