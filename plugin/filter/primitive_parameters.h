// What the filters that fit, detect and export primitives have in common.
#pragma once

#include "pcm/cad/primitive_files.h"
#include "pcm/cloud/selection.h"
#include "pcm/io/crs/coordinate_system.h"
#include "plugin/filter/filter.h"
#include "plugin/meshlab/2020/registry.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// A number, 0 of which stands for what is not set. Throws Error(invalid_argument), naming the label, below 0.
double number_of(const RichParameterList& parameters, const char* name, const char* label);

// The cloud of the parameter "Tree" (parameters.h).
struct PrimitiveCloud {
    std::shared_ptr<PointCloud> cloud;
    const MeshModel* layer = nullptr;  // the current one, where it is the one that shows the cloud
    std::string unit;                  // of lengths; empty: not known
};
std::string length_unit(const PointCloud& cloud);  // that it states; empty: not known
PrimitiveCloud primitive_cloud_of(const FilterRun& run);

// "Where" and "InClip": which points are looked at.
void add_limit_parameters(RichParameterList& parameters);
Selection limit_of(const FilterRun& run, const PrimitiveCloud& cloud);

// "OutputFile", "Overwrite", "Unit" and "Chord": a drawing or list.
void add_drawing_parameters(RichParameterList& parameters, bool needed);
std::filesystem::path drawing_of(const RichParameterList& parameters);  // empty: none is wanted
// Before anything takes long: that the file may be written. Throws what check_output() throws, and
// Error(invalid_argument) for an extension that is none of a drawing.
void check_drawing(const FilterRun& run);
// Nothing is written where no file is wanted. `unit` is the one that the cloud states, or empty.
void write_drawing(const FilterRun& run, const std::vector<Primitive>& primitives, const std::string& unit);
// After write_drawing(): says so where the cloud's layer has a matrix, which moves nothing in the file.
void note_matrix(const FilterRun& run, const PrimitiveCloud& cloud);

// All that is known of it.
void log_primitive(const FilterRun& run, const Primitive& primitive, const std::string& unit);

}  // namespace pcm::host
